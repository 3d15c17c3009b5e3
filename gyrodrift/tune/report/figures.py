"""Figures of a tuning: cost by iteration, density of each parameter, slices, yaw error over time."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, MaxNLocator

from gyrodrift.evaluation.curves import YawCurves
from gyrodrift.evaluation.dataset import Split
from gyrodrift.evaluation.space import Axis
from gyrodrift.html.numbers import factor_label
from gyrodrift.html.svg import (
    INK,
    PLAIN,
    QUIET,
    ROLES,
    STEPS,
    TUNED,
    TWO,
    as_svg,
    canvas,
    follows,
    label_factors,
    label_steps,
    styled,
    switched,
    thinned,
)
from gyrodrift.tune.result import Run, Tuning
from gyrodrift.tune.warnings import slice_values
from gyrodrift.values.arrays import Floats

DOTS = 4000
"""Most dots of a search, some 100 bytes each."""

SLICE_DOTS = 500
"""Most dots in the figure of a slice."""

LARGEST_RISE = float(np.log(1000.0))
"""A cost that is 1000 times the least counts like any larger one: chosen."""

BARS = 40
"""Bars of a histogram over the range of a parameter."""

ZOOM_TYPICAL = 4.0
"""Range of the enlarged scale, in largest errors of the median session: chosen."""

WORTH_A_ZOOM = 0.5
"""Share of the full scale above which the errors of the tuned filter are not enlarged: chosen."""


def search_svg(tuning: Tuning) -> str:
    """The cost by iteration: every evaluation, the best so far of every seed, and two reference levels."""
    with styled():
        figure = canvas(5.4, 3.0, inset=0.11, bottom=0.135, top=0.98, right=0.97)
        axes = figure.add_subplot()
        axes.set_yscale("log")
        _draw_costs(axes, tuning)
        axes.set_xlim(0.0, len(tuning.run.history) + 1.0)
        _limit_costs(axes, tuning)
        axes.xaxis.set_major_locator(MaxNLocator(8, steps=STEPS, integer=True))
        axes.set_xlabel("iteration (evaluation of the cost)", labelpad=1.0)
        axes.set_ylabel("PI, deg²")
        return as_svg(figure, "search", "Cost by iteration on a logarithmic scale")


def _draw_costs(axes: Axes, tuning: Tuning) -> None:
    first, costs = dots(tuning.run)
    axes.plot(first, costs, ".", color=QUIET, markersize=2.6, markeredgewidth=0, alpha=0.55)
    for run in tuning.other_runs:
        axes.plot(*best_so_far(run), color=TUNED, linewidth=0.8, alpha=0.45, drawstyle="steps-post")
    for pi, color, dash in ((tuning.euler.train, PLAIN, "--"), (tuning.reduced.train, TWO, ":")):
        axes.axhline(_drawable(np.array([pi]))[0], color=color, linestyle=dash, linewidth=1.5)
    marker = "o" if len(tuning.run.history) == 1 else ""  # a line through one point is invisible
    axes.plot(*best_so_far(tuning.run), color=TUNED, linewidth=1.8, marker=marker, drawstyle="steps-post")


def dots(run: Run, most: int = DOTS) -> tuple[Floats, Floats]:
    """Iterations, from 1, and costs that can be drawn, evenly chosen, at most `most`."""
    costs = _drawable(run.history)
    finite = np.flatnonzero(np.isfinite(costs))
    shown = finite[:: max(1, -(-len(finite) // most))]
    return shown.astype(np.float64) + 1.0, costs[shown]


def best_so_far(run: Run) -> tuple[Floats, Floats]:
    """Iterations, from 1, at which the best cost falls, and the last iteration, with their best costs."""
    best = np.fmin.accumulate(_drawable(run.history))
    falls = 1 + np.flatnonzero((best[1:] < best[:-1]) | (np.isfinite(best[1:]) & np.isnan(best[:-1])))
    rows = np.unique([0, *falls, len(best) - 1])
    return rows.astype(np.float64) + 1.0, best[rows]


def _drawable(costs: Floats) -> Floats:
    """Costs that a logarithmic scale can show; NaN for the others."""
    return np.where(np.isfinite(costs) & (costs > 0.0), costs, np.nan)


def highest_drawn(tuning: Tuning) -> float:
    """Top of the search figure: above plain integration and nine in ten evaluations."""
    costs = _drawable(tuning.run.history)
    high = [tuning.euler.train, tuning.reduced.train]
    high += [float(np.percentile(costs[np.isfinite(costs)], 90))] if np.isfinite(costs).any() else []
    finite = [value for value in high if np.isfinite(value) and value > 0.0]
    return 2.0 * max(finite, default=1.0)


def _limit_costs(axes: Axes, tuning: Tuning) -> None:
    levels = _drawable(np.concatenate([tuning.run.history, [tuning.euler.train, tuning.reduced.train]]))
    lowest = float(np.nanmin(levels)) if np.isfinite(levels).any() else 0.1
    highest = highest_drawn(tuning)
    axes.set_ylim(lowest / 1.6, max(highest, 10.0 * lowest))
    label_factors(axes.yaxis, lowest / 1.6, max(highest, 10.0 * lowest), 6)


def density_svgs(tuning: Tuning) -> list[str]:
    """Density of each parameter at the end of the search, 1 for no preference, with the value found."""
    with styled():
        return [_density_svg(tuning, number, axis) for number, axis in enumerate(tuning.axes)]


def _density_svg(tuning: Tuning, number: int, axis: Axis) -> str:
    figure = canvas(3.1, 1.9, inset=0.09, bottom=0.17, top=0.97, right=0.95)
    axes = figure.add_subplot()
    x, height = preference(tuning.run, number, axis)
    axes.fill_between(x, height, color=TUNED, alpha=0.22, linewidth=0.0)
    axes.plot(x, height, color=TUNED, linewidth=1.1)
    axes.axhline(1.0, color=QUIET, linestyle=":", linewidth=0.8)
    axes.axvline(float(getattr(tuning.run.params, axis.name)), color=INK, linewidth=1.3, clip_on=False)
    axes.set(xlim=(axis.low, axis.high), ylim=(0.0, 1.08 * max(float(height.max()), 1.3)))
    axes.grid(visible=False)
    axes.yaxis.set_major_locator(MaxNLocator(3, integer=True))
    _scale_values(axes, axis)
    return as_svg(figure, f"density-{axis.name}", f"Density of {axis.name} in the search")


def _scale_values(axes: Axes, axis: Axis) -> None:
    """Scale a parameter axis as its search: logarithmic or linear."""
    if axis.is_log:
        axes.set_xscale("log")
        axes.set_xlim(axis.low, axis.high)
        label_factors(axes.xaxis, axis.low, axis.high, 4)
    else:
        axes.xaxis.set_major_locator(MaxNLocator(4, steps=STEPS))
        axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: factor_label(value)))


def importances(slices: Floats) -> Floats:
    """Share of each parameter in how much the cost rises along the slices, shape (axes,), sum 1.

    The rise is the mean of ln(PI / least PI) over a slice, each value limited to ln 1000.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        rises = np.log(slices / slices.min(axis=1, keepdims=True))
    rises = np.minimum(np.nan_to_num(rises, nan=0.0, posinf=LARGEST_RISE), LARGEST_RISE).mean(axis=1)
    return rises / rises.sum() if rises.sum() > 0.0 else np.zeros(len(rises))


def slice_svgs(tuning: Tuning) -> list[str]:
    """The cost against each parameter: every evaluation, and the slice through the parameters found."""
    if not tuning.slices.size:
        return []
    with styled():
        return [_slice_svg(tuning, number, axis) for number, axis in enumerate(tuning.axes)]


def slice_curve(tuning: Tuning, number: int) -> tuple[Floats, Floats]:
    """Values of a parameter and the costs of its slice, deg²; NaN for a cost that cannot be drawn."""
    return slice_values(tuning.slice_axes[number]), _drawable(tuning.slices[number])


def _slice_svg(tuning: Tuning, number: int, axis: Axis) -> str:
    figure = canvas(3.1, 2.0, inset=0.16, bottom=0.17, top=0.97, right=0.95)
    axes = figure.add_subplot()
    axes.set_yscale("log")
    evaluations, costs = dots(tuning.run, SLICE_DOTS)
    indices = evaluations.astype(int) - 1
    values = axis.values(tuning.run.cube[indices, number])
    late = indices >= len(tuning.run.history) // 2
    for is_part, opacity in ((~late, 0.3), (late, 0.75)):
        axes.plot(values[is_part], costs[is_part], ".", color=QUIET, markersize=2.6, markeredgewidth=0, alpha=opacity)
    axes.plot(*slice_curve(tuning, number), color=TUNED, linewidth=1.4)
    axes.axvline(float(getattr(tuning.run.params, axis.name)), color=INK, linewidth=1.0)
    axes.set_xlim(axis.low, axis.high)
    _limit_costs(axes, tuning)
    _scale_values(axes, tuning.slice_axes[number])
    axes.set_ylabel("PI, deg²")
    return as_svg(figure, f"slice-{axis.name}", f"Cost against {axis.name}")


def preference(run: Run, number: int, axis: Axis) -> tuple[Floats, Floats]:
    """Values of a parameter and their density at the end of the search, 1 for no preference.

    From the density of the automaton, or else from a histogram of the last third of the search, as steps.
    """
    if run.densities is not None:
        density = run.densities[number]
        return axis.values(np.linspace(0.0, 1.0, len(density))), density
    late = run.cube[-max(1, len(run.cube) // 3) :, number]
    counts, edges = np.histogram(late, BARS, (0.0, 1.0))
    return axis.values(np.repeat(edges, 2)[1:-1]), np.repeat(counts * BARS / max(1, len(late)), 2)


@dataclass(frozen=True, slots=True)
class Heights:
    """Scales of the yaw error panels, deg: full, and enlarged or None."""

    full: tuple[float, float]
    zoom_deg: float | None


def error_scales(curves: Sequence[YawCurves]) -> Heights:
    """Scales for these curves; the tuned filter is the last."""
    everything = np.concatenate([[0.0], *(curve.errors_deg.ravel() for curve in curves)])
    finite = everything[np.isfinite(everything)]
    low, high = float(finite.min()), float(finite.max())
    margin = 0.05 * (high - low) or 1.0
    largest = [_largest_deg(curve.errors_deg[-1]) for curve in curves]
    zoom_deg = min(max(largest, default=0.0), ZOOM_TYPICAL * float(np.median(largest or [0.0])))
    is_worth_it = 0.0 < zoom_deg < WORTH_A_ZOOM * max(abs(low), abs(high))
    return Heights((low - margin, high + margin), 1.1 * zoom_deg if is_worth_it else None)


def _largest_deg(errors_deg: Floats) -> float:
    return float(np.abs(errors_deg[np.isfinite(errors_deg)]).max(initial=0.0))


def drift_svgs(curves: Sequence[YawCurves], split: Split, scales: Heights) -> list[str]:
    """Yaw error over time, a panel for each session: full scale above, enlarged for the tuned filter below."""
    with styled():
        return [_drift_svg(curve, scales, f"drift-{split.value}-{number}") for number, curve in enumerate(curves)]


def _drift_svg(curve: YawCurves, scales: Heights, name: str) -> str:
    figure = canvas(3.1, 2.1 if scales.zoom_deg else 1.5, inset=0.15, bottom=0.16, top=0.97, right=0.97)
    ratios = (5, 4) if scales.zoom_deg else (1,)
    grid = figure.subplots(len(ratios), 1, sharex=True, squeeze=False, height_ratios=ratios)
    panels = list(grid[:, 0])
    if scales.zoom_deg:
        panels[1].set_ylim(-scales.zoom_deg, scales.zoom_deg)
    panels[0].set_ylim(*scales.full)
    for panel, label in zip(panels, ("error, deg", "enlarged"), strict=False):
        _draw_errors(panel, curve)
        panel.set_ylabel(label)
    figure.align_ylabels(panels)
    panels[-1].xaxis.set_major_locator(MaxNLocator(6, steps=STEPS))
    panels[-1].set_xlabel("minutes", labelpad=1.0)
    panels[-1].set_xlim(0.0, max(float(curve.minutes[-1]) if len(curve.minutes) else 0.0, 1e-3))
    return as_svg(figure, name, "Yaw error over time, plain integration and tuned filter")


def _draw_errors(panel: Axes, curve: YawCurves) -> None:
    follows(panel.axhline(0.0, color=QUIET, linewidth=0.6))
    for error_deg, color in zip(curve.errors_deg, (PLAIN, TUNED), strict=True):
        (line,) = panel.plot(*thinned(curve.minutes, error_deg), color=color, linewidth=1.1)
        switched(line, ROLES[color])
    label_steps(panel.yaxis, 4)
