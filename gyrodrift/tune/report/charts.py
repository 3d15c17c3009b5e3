"""Charts of a tuning: cost by iteration, density of each parameter, slices, yaw error over time."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gyrodrift.evaluation.dataset import YawCurves
from gyrodrift.evaluation.space import Axis
from gyrodrift.report.chart import AxisScale, Chart, ChartSeries, Part, ScaleKind, Shape, line, thinned
from gyrodrift.tune.result import Run, Tuning
from gyrodrift.tune.warnings import slice_values
from gyrodrift.values.arrays import Floats

DOTS = 4000
"""Most dots of a search, some 15 bytes each."""

SLICE_DOTS = 500
"""Most dots in the chart of a slice."""

LARGEST_RISE = float(np.log(1000.0))
"""A cost that is 1000 times the least counts like any larger one: chosen."""

BARS = 40
"""Bars of a histogram over the range of a parameter."""

ZOOM_TYPICAL = 4.0
"""Range of the enlarged scale, in largest errors of the median session: chosen."""

WORTH_A_ZOOM = 0.5
"""Share of the full scale above which the errors of the tuned filter are not enlarged: chosen."""


def search_chart(tuning: Tuning) -> Chart:
    """The cost by iteration: every evaluation, the best so far of every seed, and two reference levels."""
    levels = [(tuning.euler.train, "plain", "dashed"), (tuning.reduced.train, "two", "dotted")]
    series = [ChartSeries(*dots(tuning.run), "quiet", Shape.DOTS, name="an evaluation", width=3.0, opacity=0.55)]
    series += [ChartSeries(*_steps(*best_so_far(run)), "tuned", width=1.0, opacity=0.45) for run in tuning.other_runs]
    series += [
        line(y=float(_drawable(np.array([pi]))[0]), color=color, dash=dash, width=2.0) for pi, color, dash in levels
    ]
    best = best_so_far(tuning.run)
    series.append(ChartSeries(*_steps(*best), "tuned", name="best so far", width=2.2))
    if len(tuning.run.history) == 1:  # a line through one point is invisible
        series.append(ChartSeries(*best, "tuned", Shape.DOTS, width=7.0))
    x = AxisScale("iteration (evaluation of the cost)", 0.0, len(tuning.run.history) + 1.0)
    return Chart("Cost by iteration on a logarithmic scale", x, [Part(_cost_scale(tuning), series)], 340)


def _steps(x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """A line that keeps each value until the next x."""
    return np.repeat(x, 2)[1:], np.repeat(y, 2)[:-1]


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
    """Top of the search chart: above plain integration and nine in ten evaluations."""
    costs = _drawable(tuning.run.history)
    high = [tuning.euler.train, tuning.reduced.train]
    high += [float(np.percentile(costs[np.isfinite(costs)], 90))] if np.isfinite(costs).any() else []
    finite = [value for value in high if np.isfinite(value) and value > 0.0]
    return 2.0 * max(finite, default=1.0)


def _cost_scale(tuning: Tuning) -> AxisScale:
    levels = _drawable(np.concatenate([tuning.run.history, [tuning.euler.train, tuning.reduced.train]]))
    lowest = float(np.nanmin(levels)) if np.isfinite(levels).any() else 0.1
    return AxisScale("PI, deg²", lowest / 1.6, max(highest_drawn(tuning), 10.0 * lowest), ScaleKind.LOG)


def density_chart(tuning: Tuning, number: int) -> Chart:
    """Density of a parameter at the end of the search, 1 for no preference, with the value found."""
    axis = tuning.axes[number]
    x, height = preference(tuning.run, number, axis)
    series = [
        ChartSeries(x, np.zeros_like(height), "tuned", Shape.BAND, y_end=height, opacity=0.22),
        ChartSeries(x, height, "tuned", name="density"),
        line(y=1.0, color="quiet", dash="dotted", width=1.0),
        line(x=float(getattr(tuning.run.params, axis.name)), color="ink", width=1.6),
    ]
    y = AxisScale("density", 0.0, 1.08 * max(float(height.max()), 1.3))
    return Chart(f"Density of {axis.name} in the search", _value_scale(tuning, axis), [Part(y, series)])


def _value_scale(tuning: Tuning, axis: Axis) -> AxisScale:
    """Scale of a parameter as in its search: logarithmic or linear."""
    unit = tuning.filter.parameter(axis.name).unit
    label = f"{axis.name}, {unit}" if unit else axis.name
    return AxisScale(label, axis.low, axis.high, ScaleKind.LOG if axis.is_log else ScaleKind.LINEAR)


def importances(slices: Floats) -> Floats:
    """Share of each parameter in how much the cost rises along the slices, shape (axes,), sum 1.

    The rise is the mean of ln(PI / least PI) over a slice, each value limited to ln 1000.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        rises = np.log(slices / slices.min(axis=1, keepdims=True))
    rises = np.minimum(np.nan_to_num(rises, nan=0.0, posinf=LARGEST_RISE), LARGEST_RISE).mean(axis=1)
    return rises / rises.sum() if rises.sum() > 0.0 else np.zeros(len(rises))


def slice_curve(tuning: Tuning, number: int) -> tuple[Floats, Floats]:
    """Values of a parameter and the costs of its slice, deg²; NaN for a cost that cannot be drawn."""
    return slice_values(tuning.slice_axes[number]), _drawable(tuning.slices[number])


def slice_chart(tuning: Tuning, number: int) -> Chart:
    """The cost against a parameter: every evaluation, and the slice through the parameters found."""
    axis = tuning.axes[number]
    evaluations, costs = dots(tuning.run, SLICE_DOTS)
    indices = evaluations.astype(int) - 1
    values = axis.values(tuning.run.cube[indices, number])
    late = indices >= len(tuning.run.history) // 2
    series = [
        ChartSeries(values[is_part], costs[is_part], "quiet", Shape.DOTS, width=3.0, opacity=opacity)
        for is_part, opacity in ((~late, 0.3), (late, 0.75))
    ]
    series.append(ChartSeries(*slice_curve(tuning, number), "tuned", name="slice", width=1.8))
    series.append(line(x=float(getattr(tuning.run.params, axis.name)), color="ink", width=1.3))
    x = _value_scale(tuning, tuning.slice_axes[number])
    return Chart(f"Cost against {axis.name}", x, [Part(_cost_scale(tuning), series)], 200)


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


def drift_chart(curve: YawCurves, scales: Heights) -> Chart:
    """Yaw error over time in a session: full scale above, enlarged for the tuned filter below."""
    series = [line(y=0.0, color="quiet", width=0.8)]
    series += [
        ChartSeries(*thinned(curve.minutes, error_deg), color, key=color, name=name)
        for error_deg, color, name in zip(
            curve.errors_deg, ("plain", "tuned"), ("plain integration", "tuned filter"), strict=True
        )
    ]
    parts = [Part(AxisScale("error, deg", *scales.full), series, 5.0)]
    if scales.zoom_deg:
        parts.append(Part(AxisScale("enlarged", -scales.zoom_deg, scales.zoom_deg), series, 4.0))
    last_min = max(float(curve.minutes[-1]) if len(curve.minutes) else 0.0, 1e-3)
    says = "Yaw error over time, plain integration and tuned filter"
    return Chart(says, AxisScale("minutes", 0.0, last_min), parts, 270 if scales.zoom_deg else 180)
