"""Parts that all charts of a session share: marks, times, noisy lines in parts, and curves with a legend entry."""

from typing import NamedTuple

import numpy as np

from gyrodrift.describe.yaw import YawHistory
from gyrodrift.facts.session_facts import SessionFacts
from gyrodrift.report.chart import AxisScale, Chart, ChartSeries, Mark, Part, Shape, scale_of, thinned
from gyrodrift.session.session import Session
from gyrodrift.values.arrays import Floats

PARTS = 400
"""A noisy line is drawn as its mean within its range, in at most this many parts, so that spikes stay visible."""

MINUTES_FROM_S = 300.0
"""Time axes of longer sessions are in minutes."""


class Panel(NamedTuple):
    """A chart with its name and its legend."""

    name: str
    marks: tuple[Mark, ...]
    chart: Chart


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


def noisy_line(x: Floats, y: Floats, color: str, name: str) -> list[ChartSeries]:
    """A noisy line as its mean within its range."""
    parts = line_parts(x, y)
    mean = ChartSeries(parts.x, parts.mean, color, name=name, width=1.3)
    if len(parts.x) < len(x):
        return [ChartSeries(parts.x, parts.low, color, Shape.BAND, y_end=parts.high, opacity=0.35), mean]
    return [
        mean,
        *[ChartSeries(x, y, color, Shape.DOTS, width=5.0)] * (len(x) < 2),
    ]  # a line through one point is invisible


def curve(mark: Mark, x: Floats, y: Floats, name: str) -> ChartSeries:
    """A curve that its legend entry switches; values that are not finite are left out."""
    dash, width = ("dotted" if "dotted" in mark.shape else ""), (0.9 if "thin" in mark.shape else 1.7)
    return ChartSeries(*thinned(x, y), mark.color, key=mark.key, name=name, dash=dash, width=width)


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


def chart_over_time(
    name: str, times: tuple[Floats, str], y: AxisScale, series: list[ChartSeries], height_px: int = 200
) -> Chart:
    """A chart over all times, which come with the label of their axis."""
    t, label = times
    return Chart(name, scale_of(label, [t], margin=0.0), [Part(y, series)], height_px)
