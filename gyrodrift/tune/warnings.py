"""Warnings of a tuning: parameters at a bound or not identifiable, and bad results on held-out sessions."""

from collections.abc import Iterator, Sequence
from math import sqrt

import numpy as np

from gyrodrift.evaluation.space import Axis, limits, row_of
from gyrodrift.filters.filter import Filter, FilterParams
from gyrodrift.tune.result import Pi
from gyrodrift.values.arrays import Floats

AT_BOUND = 0.01
"""Distance from an end of the range, in shares of it, that counts as at the bound: chosen."""

SAME_COST = 0.02
SAME_SHARE = 0.5
SCAN_POINTS = 41
"""A parameter is not identifiable if PI is within SAME_COST of its minimum over SAME_SHARE of the range: chosen."""

WORSE = 2.0
"""Ratio of test to training error, relative to plain integration, that gives a warning: chosen."""


def bound_of(axis: Axis, value: float) -> str:
    """Bound of the range at which a value lies, `lower` or `upper`; empty inside the range."""
    position = axis.unit(value)
    if position <= AT_BOUND:
        return "lower"
    return "upper" if position >= 1.0 - AT_BOUND else ""


def bound_warnings(chosen: Filter, axes: Sequence[Axis], params: FilterParams) -> Iterator[str]:
    """Warnings for parameters at an end of their range."""
    for axis in axes:
        end = bound_of(axis, getattr(params, axis.name))
        if end:
            value = axis.low if end == "lower" else axis.high
            advice = (
                ", which is a bound of the filter" if value in limits(axis.name, chosen) else "; widen it with --range"
            )
            yield f"{axis.name} is at the {end} end of its range, {value:g}{advice}"


def slice_candidates(chosen: Filter, axes: Sequence[Axis], params: FilterParams) -> Floats:
    """Candidates along each axis through a point, shape (axes · SCAN_POINTS, parameters)."""
    rows = np.repeat(row_of(params), len(axes) * SCAN_POINTS, axis=0)
    for number, axis in enumerate(axes):
        part = slice(number * SCAN_POINTS, (number + 1) * SCAN_POINTS)
        rows[part, chosen.names.index(axis.name)] = slice_values(axis)
    return rows


def slice_values(axis: Axis) -> Floats:
    """Values of a parameter in its slice, shape (SCAN_POINTS,)."""
    return axis.values(np.linspace(0.0, 1.0, SCAN_POINTS))


def identifiability_warnings(chosen: Filter, axes: Sequence[Axis], slices: Floats) -> Iterator[str]:
    """Warnings for parameters that the training sessions do not determine.

    Parameters
    ----------
    axes
        Axes of the parameters that were searched.
    slices
        PI along each axis, deg², shape (axes, SCAN_POINTS).
    """
    for axis, costs in zip(axes, slices, strict=True):
        is_same = costs <= (1.0 + SAME_COST) * costs.min()
        if is_same.mean() > SAME_SHARE:
            low, high = slice_values(axis)[is_same][[0, -1]]
            yield (
                f"{axis.name} is not determined by these sessions: from {low:.3g} to {high:.3g} the cost is within "
                f"{SAME_COST:.0%} of its minimum; {chosen.parameter(axis.name).decided_by}"
            )


def held_out_warnings(pi: Pi, euler: Pi) -> Iterator[str]:
    """Warnings for a test that is worse than plain integration, or much worse than the training.

    Test sessions may drift more than training sessions, so plain integration is the reference.
    """
    if pi.test is None or euler.test is None:
        return
    if pi.test > euler.test:
        yield "on held-out sessions the tuned filter is worse than plain integration: do not use it"
    elif sqrt(pi.test) > WORSE * sqrt(pi.train) * max(1.0, sqrt(euler.test / max(euler.train, 1e-300))):
        yield (
            f"held-out sessions are much worse than training sessions, {sqrt(pi.test):.3g} against "
            f"{sqrt(pi.train):.3g} deg RMS: the parameters are overfitted; record more sessions"
        )
