"""Parts that all panels of a session share: marks, scales, and noisy lines in parts. matplotlib comes with `[lab]`."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from gyrodrift.describe.yaw import YawHistory
from gyrodrift.facts.session_facts import SessionFacts
from gyrodrift.html.svg import FIVE, INK, PLAIN, QUIET, STEPS, THREE, TUNED, label_steps, switched, thinned
from gyrodrift.session.session import Session
from gyrodrift.values.arrays import Floats

PARTS = 400
"""A noisy line is drawn as its mean within its range, in at most this many parts, so that spikes stay visible."""

MINUTES_FROM_S = 300.0
"""Time axes of longer sessions are in minutes."""

COLORS = {"plain": PLAIN, "tuned": TUNED, "ink": INK, "three": THREE, "five": FIVE, "quiet": QUIET}

Mark = tuple[str, str, str, str]
"""Legend entry of a curve: key of its switch, color and shape as classes of the style sheet, and text."""


class Panel(NamedTuple):
    """A chart: its name, its legend, and the function that draws it."""

    name: str
    marks: tuple[Mark, ...]
    draw: Callable[[Axes], None]


class DescribedSession(NamedTuple):
    """A session with everything that panels are drawn from."""

    session: Session
    description: SessionFacts
    yaw: YawHistory | None


class LineParts(NamedTuple):
    """A line in m parts, each array of shape (m,): start, range and mean of each part."""

    x: Floats
    low: Floats
    mean: Floats
    high: Floats


def line_parts(x: Floats, y: Floats) -> LineParts:
    """Cut a line into at most `PARTS` parts of equally many samples; values that are not finite are skipped."""
    starts = np.arange(0, len(y), max(1, -(-len(y) // PARTS)))
    y = np.where(np.isfinite(y), y, np.nan)
    if len(starts) == len(y):
        return LineParts(x, y, y, y)
    counts = np.add.reduceat(np.isfinite(y), starts, dtype=np.float64)
    sums = np.add.reduceat(np.nan_to_num(y), starts)
    means = np.where(counts > 0.0, sums / np.maximum(counts, 1.0), np.nan)
    return LineParts(x[starts], np.fmin.reduceat(y, starts), means, np.fmax.reduceat(y, starts))


def draw_parts(axes: Axes, x: Floats, y: Floats, color: str) -> None:
    """Draw a noisy line as its mean within its range."""
    parts = line_parts(x, y)
    if len(parts.x) < len(x):
        axes.fill_between(parts.x, parts.low, parts.high, color=color, alpha=0.35, linewidth=0.6)
    marker = "." if len(x) < 2 else ""  # a line through one point is invisible
    axes.plot(parts.x, parts.mean, color=color, linewidth=1.0, marker=marker)


def draw_curve(axes: Axes, mark: Mark, x: Floats, y: Floats) -> None:
    """Draw a curve that its legend entry switches; values that are not finite are left out."""
    key, color, shape, _ = mark
    style = ":" if "dotted" in shape else "-"
    width = 0.7 if "thin" in shape else 1.3
    (line,) = axes.plot(*thinned(x, y), color=COLORS[color], linestyle=style, linewidth=width)
    switched(line, key)


def time_axis(t_s: Floats, duration_s: float) -> tuple[Floats, str]:
    """Times in s, or in minutes for a long session, and the label of their axis."""
    if duration_s > MINUTES_FROM_S:
        return t_s / 60.0, "device time, min"
    return t_s, "device time, s"


def seconds_of(session: Session) -> Floats:
    """Device time after the first sample, s, shape (n,)."""
    finite_s = session.t_device_s[np.isfinite(session.t_device_s)]
    return session.t_device_s - (finite_s[0] if len(finite_s) else 0.0)


def session_times(described: DescribedSession) -> tuple[Floats, str]:
    """Times of all samples for the axis, and its label."""
    return time_axis(seconds_of(described.session), described.description.duration_s)


def finish_axes(axes: Axes, x_label: str, y_label: str, least_span: float) -> None:
    """Label both axes, and widen the vertical scale to at least `least_span`."""
    low, high = axes.get_ylim()
    if high - low < least_span:
        middle = 0.5 * (low + high)
        axes.set_ylim(middle - 0.5 * least_span, middle + 0.5 * least_span)
    label_steps(axes.yaxis, 5)
    label_times(axes, x_label)
    axes.set_ylabel(y_label)


def label_times(axes: Axes, x_label: str) -> None:
    """Label the horizontal axis in plain steps."""
    axes.xaxis.set_major_locator(MaxNLocator(6, steps=STEPS))
    axes.set_xlabel(x_label, labelpad=1.0)
