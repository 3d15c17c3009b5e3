"""Figures of a diagnosis: features by session, rate errors against other quantities, over time, and as spectra."""

from collections.abc import Sequence
from typing import Any, TypeVar

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator

from gyrodrift.diagnose.predictive_checks.binned_medians import Medians
from gyrodrift.diagnose.predictive_checks.feature_comparison import Band, FeatureComparison
from gyrodrift.diagnose.predictive_checks.residual_checks import Dependence
from gyrodrift.diagnose.predictive_checks.residual_series import ResidualSeries, Spectra
from gyrodrift.html.svg import (
    INK,
    PLAIN,
    QUIET,
    ROLES,
    TUNED,
    TWO,
    as_svg,
    canvas,
    label_factors,
    label_steps,
    styled,
    switched,
    thinned,
)
from gyrodrift.values.arrays import Floats

T = TypeVar("T")

BEFORE, AFTER, RESIDUAL = PLAIN, TUNED, TWO
DOTS = 350
"""Largest number of dots in a scatter plot; a dot takes about 70 bytes of the file."""

SHOWN = (2.0, 98.0)
"""Percentiles of the values of a scatter plot that its scale includes."""

LEAST_DPS = 0.01
"""Least range of a scale on either side of 0, deg/s: smaller errors should look small."""

UNITS = {
    "times its middle": "variance, over that of 4- to 8-sample means at rest",
    "times as by chance": "share of the variance, over that by chance",
    "times as at rest": "scatter, over that at rest",
    "times its neighbors": "power, over that of neighboring frequencies",
    "times as usual": "variance of the noisiest seconds, over the median",
    "of the encoder's": "largest rate, over that of the encoder",
    "standard errors": "largest step, in standard errors",
    "jumps": "jumps of the angle",
    "samples": "samples missing in a row",
}
"""Titles of axes, by the unit of a feature, for units that say too little."""

ZERO = "zero"
"""Key of the zero line, which moves with the scale and which no name of the legend hides."""

SMOOTH_SECONDS = 5
"""Length of the running medians of rate errors over time."""

WIDE_IN = 3.1
"""Width of a panel, in."""

WIDE_BAR, NARROW_BAR = 0.64, 0.36
"""Widths of the bars of the simulator as it is and corrected, in sessions."""

LONGEST_LABEL = 40
"""Most letters of the label of an axis. A longer label is replaced by its unit, as the panel has the name."""

ERRORS = 2.0
"""Standard errors of a median that its band spans on either side."""

MARGIN = 0.05
"""Margin of a scale, as a share of its range."""

FEW = 4
"""Least number of medians that are joined by a line: a line through fewer looks like a slope."""

DECADE = 10.0
"""Least ratio of the ends of the scale of a spectrum: white noise should look level in spite of its scatter."""


def feature_svgs(compared: Sequence[FeatureComparison], *, has_causes: bool) -> list[str]:
    """A panel for each feature, session by session: recordings as dots, expected values of the simulator as bars."""
    with styled():
        return [_feature_svg(comparison, f"feature-{index}", has_causes) for index, comparison in enumerate(compared)]


def _feature_svg(compared: FeatureComparison, name: str, has_causes: bool) -> str:  # noqa: FBT001 - handed on
    figure = canvas(WIDE_IN, 1.6, inset=0.15, bottom=0.2, top=0.88, right=0.98)
    axes = figure.add_subplot()
    sessions = np.arange(1.0, len(compared.real) + 1.0)
    _draw_band(axes, sessions, compared.before, BEFORE, WIDE_BAR)
    if has_causes:
        _draw_band(axes, sessions, compared.after, AFTER, NARROW_BAR)
    axes.plot(sessions, compared.real, "o", color=INK, markersize=3.6, markeredgewidth=0)
    axes.set_xlim(0.4, len(sessions) + 0.6)
    axes.set_title(UNITS.get(compared.unit, compared.unit), loc="left", fontsize=8.0, color=QUIET, pad=3.0)
    axes.grid(visible=False, axis="x")
    axes.xaxis.set_major_locator(_whole_numbers(len(sessions)))
    axes.set_xlabel("session", labelpad=1.0)
    label_steps(axes.yaxis, 4)
    return as_svg(figure, name, "A feature by session, real and simulated")


def _whole_numbers(count: int) -> FixedLocator:
    return FixedLocator(list(range(1, count + 1, max(1, -(-count // 10)))))


def _draw_band(axes: Axes, x: Floats, band: Band, color: str, width: float) -> None:
    axes.bar(x, band.high - band.low, width, band.low, color=color, alpha=0.25, linewidth=0.0)
    axes.hlines(band.middle, x - width / 2.0, x + width / 2.0, color=color, linewidth=1.8)


def dependence_svgs(every: Sequence[Dependence], *, has_causes: bool, name: str = "against") -> list[str]:
    """A panel for each regressor: above, the rate errors against it; below, the residual against it."""
    with styled():
        return [_dependence_svg(dependence, f"{name}-{index}", has_causes) for index, dependence in enumerate(every)]


def _dependence_svg(dependence: Dependence, name: str, has_causes: bool) -> str:  # noqa: FBT001 - handed on
    figure = canvas(WIDE_IN, 2.5, inset=0.22, bottom=0.15, top=0.97, right=0.97)
    above, below = _two(figure)
    lines = _lines(dependence.real, dependence.before, dependence.after, has_causes)
    _draw_cloud(above, dependence.x, dependence.real_dps, [line.y for line, _ in lines])
    _draw_cloud(below, dependence.x, dependence.unexplained_dps, [dependence.unexplained.y])
    _draw_errors(below, dependence.unexplained, dependence.slack)
    for line, color in lines:
        _draw_medians(above, line, color)
    _draw_medians(below, dependence.unexplained, RESIDUAL)
    label = f"{dependence.name}, {dependence.unit}"
    _label_two(figure, label if len(label) <= LONGEST_LABEL else dependence.unit)
    return as_svg(figure, name, f"Rate error against {dependence.name}")


def _two(figure: Figure) -> tuple[Axes, Axes]:
    """Two axes: the error above, the residual below."""
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(5, 4))
    below.axhline(0.0, color=QUIET, linewidth=0.6)
    return above, below


def _label_two(figure: Figure, x_label: str) -> None:
    """Label the two axes of a figure."""
    above, below = figure.axes
    for axes, label in ((above, "error, deg/s"), (below, "residual, deg/s")):
        label_steps(axes.yaxis, 4)
        axes.set_ylabel(label)
    figure.align_ylabels([above, below])
    label_steps(below.xaxis, 6)
    below.set_xlabel(x_label, labelpad=1.0)


def _lines(real: T, before: T, after: T, has_causes: bool) -> list[tuple[T, str]]:  # noqa: FBT001 - handed on
    """Curves with their colors, the recordings lowest; without causes there is no corrected curve."""
    return [(real, INK), (before, BEFORE), *([(after, AFTER)] if has_causes else [])]


def _stroke(color: str) -> dict[str, Any]:
    """Style of a curve; recordings are wide, so that they show under a simulator that agrees with them."""
    return {"linewidth": 3.2, "alpha": 0.55} if color == INK else {"linewidth": 1.2}


def _draw_cloud(axes: Axes, x: Floats, y: Floats, lines: Sequence[Floats]) -> None:
    """Draw at most DOTS points, on a scale that includes SHOWN of them and all of the lines."""
    shown = np.unique(np.linspace(0, len(x) - 1, min(len(x), DOTS)).round().astype(int))
    ends = np.concatenate([np.percentile(y, SHOWN), *lines, [-LEAST_DPS, LEAST_DPS]])
    low, high = float(ends.min()), float(ends.max())
    limited = np.where((y >= low) & (y <= high), y, np.nan)
    axes.plot(x[shown], limited[shown], ".", color=QUIET, markersize=2.6, markeredgewidth=0, alpha=0.55)
    axes.set_ylim(low - MARGIN * (high - low), high + MARGIN * (high - low))


def _draw_errors(axes: Axes, line: Medians, slack: float) -> None:
    """Draw the standard errors of medians as a band, or as bars if there are few medians."""
    wide = ERRORS * line.error + slack * np.abs(line.x)
    if len(line.x) < FEW:
        axes.vlines(line.x, line.y - wide, line.y + wide, color=RESIDUAL, linewidth=1.4)
    else:
        axes.fill_between(line.x, line.y - wide, line.y + wide, color=RESIDUAL, alpha=0.22, linewidth=0.0)


def _draw_medians(axes: Axes, line: Medians, color: str) -> None:
    if len(line.x) < FEW:
        axes.plot(line.x, line.y, "o", color=color, markersize=4.0, markeredgewidth=0)
    else:
        axes.plot(line.x, line.y, color=color, **_stroke(color))


def over_time_svgs(sessions: Sequence[ResidualSeries], *, has_causes: bool) -> list[str]:
    """A panel for each session: running medians of the recorded and simulated rate errors, and of the residual."""
    with styled():
        return [_over_time_svg(session, has_causes) for session in sessions]


def _over_time_svg(session: ResidualSeries, has_causes: bool) -> str:  # noqa: FBT001 - handed on
    figure = canvas(WIDE_IN, 2.5, inset=0.22, bottom=0.15, top=0.97, right=0.97)
    above, below = _two(figure)
    switched(below.lines[0], ZERO)
    for values, color in _lines(session.real_dps, session.before_dps, session.after_dps, has_causes):
        (line,) = above.plot(*thinned(session.minutes, _smooth(values)), color=color, **_stroke(color))
        switched(line, ROLES[color])
    (line,) = below.plot(*thinned(session.minutes, _smooth(session.unexplained_dps)), color=RESIDUAL, linewidth=1.1)
    switched(line, ROLES[RESIDUAL])
    for axes in (above, below):
        low, high = axes.get_ylim()
        axes.set_ylim(min(low, -LEAST_DPS), max(high, LEAST_DPS))
    for change_point in session.change_points:
        line = below.axvline(float(session.minutes[change_point.second]), color=RESIDUAL, linestyle=":", linewidth=1.0)
        switched(line, ROLES[RESIDUAL])
    _label_two(figure, "time, min")
    return as_svg(figure, f"over-time-{session.number}", f"Rate error of session {session.number} over time")


def _smooth(values: Floats) -> Floats:
    """Running medians, which keep steps sharp."""
    half = SMOOTH_SECONDS // 2
    padded = np.pad(values, half, mode="edge")
    smooth: Floats = np.median(np.lib.stride_tricks.sliding_window_view(padded, SMOOTH_SECONDS), axis=1)
    return smooth


def spectrum_svgs(parts: Sequence[Spectra], *, has_causes: bool) -> list[str]:
    """A panel for each range of frequencies: recorded and simulated amplitude spectral densities, on a common scale."""
    with styled():
        figures = [_spectrum(spectra, has_causes) for spectra in parts]
        ends = np.array([axes.get_ylim() for figure in figures for axes in figure.axes])
        low, high = float(ends[:, 0].min(initial=np.inf)), float(ends[:, 1].max(initial=0.0))
        for figure in figures:
            figure.axes[0].set_ylim(low, max(high, DECADE * low))
            label_factors(figure.axes[0].yaxis, *figure.axes[0].get_ylim(), 5)
        names = [f"spectrum-{index}" for index in range(len(parts))]
        return [as_svg(figure, name, "Spectrum of the rate error") for figure, name in zip(figures, names, strict=True)]


def _spectrum(spectra: Spectra, has_causes: bool) -> Figure:  # noqa: FBT001 - handed on
    figure = canvas(WIDE_IN, 2.2, inset=0.22, bottom=0.16, top=0.97, right=0.97)
    axes = figure.add_subplot(xscale="log", yscale="log")
    for values, color in _lines(spectra.real, spectra.before, spectra.after, has_causes):
        (line,) = axes.plot(spectra.hz, np.where(values > 0.0, values, np.nan), color=color, **_stroke(color))
        switched(line, ROLES[color])
    axes.set_xlim(spectra.hz[0], spectra.hz[-1])
    label_factors(axes.xaxis, *axes.get_xlim(), 5)
    axes.set_xlabel("frequency, Hz", labelpad=1.0)
    axes.set_ylabel("rate error, deg/s/√Hz")
    return figure
