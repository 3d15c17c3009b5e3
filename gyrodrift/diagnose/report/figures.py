"""The figures of a diagnosis: features by session, and rate errors against all sorts of things."""

from collections.abc import Sequence
from typing import TypeVar

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.predictive_checks.binned_medians import Medians
from gyrodrift.diagnose.predictive_checks.dependences import Dependence
from gyrodrift.diagnose.predictive_checks.feature_comparison import Band, FeatureComparison
from gyrodrift.diagnose.predictive_checks.residual_series import ResidualSeries
from gyrodrift.diagnose.predictive_checks.spectra import Spectra
from gyrodrift.html.svg import (
    INK,
    PLAIN,
    QUIET,
    TUNED,
    TWO,
    as_svg,
    canvas,
    label_factors,
    label_steps,
    styled,
    thinned,
)

T = TypeVar("T")

BEFORE, AFTER, LEFT = PLAIN, TUNED, TWO
DOTS = 350
"""Points of a cloud that are drawn: some 70 bytes each."""

SHOWN = (2.0, 98.0)
"""Percentiles of a cloud that a scale holds."""

LEAST_DPS = 0.01
"""A scale reaches so far at least: what is smaller should look small."""

SMOOTH_SECONDS = 5
WIDE_IN = 3.1
ERRORS = 2.0
MARGIN = 0.05
FEW = 4
DECADE = 10.0
"""A spectrum spans so much at least: the scatter of noise should look level."""


def feature_svgs(compared: Sequence[FeatureComparison], *, has_causes: bool) -> list[str]:
    """Of each a panel: the recordings as dots, and what the simulator expects as bars, session by session."""
    with styled():
        return [_feature_svg(one, f"feature-{at}", has_causes) for at, one in enumerate(compared)]


def _feature_svg(compared: FeatureComparison, name: str, has_causes: bool) -> str:  # noqa: FBT001 - handed on
    figure = canvas(WIDE_IN, 1.45, left=0.22, bottom=0.2, top=0.96, right=0.98)
    axes = figure.add_subplot()
    sessions = np.arange(1.0, len(compared.real) + 1.0)
    aside = 0.2 if has_causes else 0.0
    _draw_band(axes, sessions - aside, compared.before, BEFORE)
    if has_causes:
        _draw_band(axes, sessions + aside, compared.after, AFTER)
    axes.plot(sessions, compared.real, "o", color=INK, markersize=3.6, markeredgewidth=0)
    axes.set(xlim=(0.4, len(sessions) + 0.6), ylabel=compared.unit)
    axes.grid(visible=False, axis="x")
    axes.xaxis.set_major_locator(_whole_numbers(len(sessions)))
    axes.set_xlabel("session", labelpad=1.0)
    label_steps(axes.yaxis, 4)
    return as_svg(figure, name, "A feature by session, real and simulated")


def _whole_numbers(count: int) -> FixedLocator:
    return FixedLocator(list(range(1, count + 1, max(1, -(-count // 10)))))


def _draw_band(axes: Axes, x: Floats, band: Band, colour: str) -> None:
    width = 0.34
    axes.bar(x, band.high - band.low, width, band.low, color=colour, alpha=0.25, linewidth=0.0)
    axes.hlines(band.middle, x - width / 2.0, x + width / 2.0, color=colour, linewidth=1.8)


def dependence_svgs(every: Sequence[Dependence], *, has_causes: bool) -> list[str]:
    """Rate errors against each regressor: above as they are, below what the simulator leaves of them."""
    with styled():
        return [_dependence_svg(one, f"against-{at}", has_causes) for at, one in enumerate(every)]


def _dependence_svg(one: Dependence, name: str, has_causes: bool) -> str:  # noqa: FBT001 - handed on
    figure = canvas(WIDE_IN, 2.5, left=0.22, bottom=0.15, top=0.97, right=0.97)
    above, below = _two(figure)
    lines = _lines(one.real, one.before, one.after, has_causes)
    _draw_cloud(above, one.x, one.real_dps, [line.y for line, _ in lines])
    _draw_cloud(below, one.x, one.left_dps, [one.left.y])
    _draw_errors(below, one.left, one.slack)
    for line, colour in lines:
        _draw_medians(above, line, colour)
    _draw_medians(below, one.left, LEFT)
    _label_two(figure, one.unit)
    return as_svg(figure, name, f"Rate error against {one.name}")


def _two(figure: Figure) -> tuple[Axes, Axes]:
    """What is seen above, and what is left of it below."""
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(5, 4))
    below.axhline(0.0, color=QUIET, linewidth=0.6)
    return above, below


def _label_two(figure: Figure, x_label: str) -> None:
    above, below = figure.axes
    for axes, label in ((above, "error, deg/s"), (below, "unexplained")):
        label_steps(axes.yaxis, 4)
        axes.set_ylabel(label)
    figure.align_ylabels([above, below])
    label_steps(below.xaxis, 6)
    below.set_xlabel(x_label, labelpad=1.0)


def _lines(real: T, before: T, after: T, has_causes: bool) -> list[tuple[T, str]]:  # noqa: FBT001 - handed on
    """What is drawn with its colours, the most important last; without causes after is before."""
    return [(before, BEFORE), *([(after, AFTER)] if has_causes else []), (real, INK)]


def _draw_cloud(axes: Axes, x: Floats, y: Floats, lines: Sequence[Floats]) -> None:
    """Some of the points, on a scale that holds most of them and all of the lines."""
    shown = np.unique(np.linspace(0, len(x) - 1, min(len(x), DOTS)).round().astype(int))
    ends = np.concatenate([np.percentile(y, SHOWN), *lines, [-LEAST_DPS, LEAST_DPS]])
    low, high = float(ends.min()), float(ends.max())
    held = np.where((y >= low) & (y <= high), y, np.nan)
    axes.plot(x[shown], held[shown], ".", color=QUIET, markersize=2.6, markeredgewidth=0, alpha=0.55)
    axes.set_ylim(low - MARGIN * (high - low), high + MARGIN * (high - low))


def _draw_errors(axes: Axes, line: Medians, slack: float) -> None:
    wide = ERRORS * line.error + slack * np.abs(line.x)
    if len(line.x) < FEW:
        axes.vlines(line.x, line.y - wide, line.y + wide, color=LEFT, linewidth=1.4)
    else:
        axes.fill_between(line.x, line.y - wide, line.y + wide, color=LEFT, alpha=0.22, linewidth=0.0)


def _draw_medians(axes: Axes, line: Medians, colour: str) -> None:
    if len(line.x) < FEW:  # a line through few points looks like a slope
        axes.plot(line.x, line.y, "o", color=colour, markersize=4.0, markeredgewidth=0)
    else:
        axes.plot(line.x, line.y, color=colour, linewidth=1.4)


def over_time_svgs(sessions: Sequence[ResidualSeries], *, has_causes: bool) -> list[str]:
    """Of each session a panel: medians of some seconds, real and simulated, and what the simulator leaves of them."""
    with styled():
        return [_over_time_svg(session, has_causes) for session in sessions]


def _over_time_svg(session: ResidualSeries, has_causes: bool) -> str:  # noqa: FBT001 - handed on
    figure = canvas(WIDE_IN, 2.5, left=0.22, bottom=0.15, top=0.97, right=0.97)
    above, below = _two(figure)
    for values, colour in _lines(session.real_dps, session.before_dps, session.after_dps, has_causes):
        above.plot(*thinned(session.minutes, _smooth(values)), color=colour, linewidth=1.1)
    below.plot(*thinned(session.minutes, _smooth(session.left_dps)), color=LEFT, linewidth=1.1)
    for axes in (above, below):
        low, high = axes.get_ylim()
        axes.set_ylim(min(low, -LEAST_DPS), max(high, LEAST_DPS))
    for one in session.change_points:
        below.axvline(float(session.minutes[one.second]), color=LEFT, linestyle=":", linewidth=1.0)
    _label_two(figure, "minutes")
    return as_svg(figure, f"over-time-{session.number}", f"Rate error of session {session.number} over time")


def _smooth(values: Floats) -> Floats:
    """Running medians, which leave steps as sharp as they are."""
    half = SMOOTH_SECONDS // 2
    padded = np.pad(values, half, mode="edge")
    smooth: Floats = np.median(np.lib.stride_tricks.sliding_window_view(padded, SMOOTH_SECONDS), axis=1)
    return smooth


def spectrum_svg(parts: Sequence[Spectra], *, has_causes: bool) -> str:
    """Amplitude densities of the rate error, real and simulated, in ranges of frequency that do not overlap."""
    with styled():
        figure = canvas(9.6, 3.2, left=0.07, bottom=0.14, top=0.97)
        axes = figure.add_subplot(xscale="log", yscale="log")
        for one in parts:
            for values, colour in _lines(one.real, one.before, one.after, has_causes):
                axes.plot(one.hz, np.where(values > 0.0, values, np.nan), color=colour, linewidth=1.4)
        axes.set_xlim(parts[0].hz[0], parts[-1].hz[-1])
        label_factors(axes.xaxis, *axes.get_xlim(), 8)
        low, high = axes.get_ylim()
        axes.set_ylim(low, max(high, DECADE * low))
        label_factors(axes.yaxis, *axes.get_ylim(), 5)
        axes.set(xlabel="frequency, Hz", ylabel="rate error, deg/s/√Hz")
        return as_svg(figure, "spectrum", "Spectrum of the rate error, real and simulated")
