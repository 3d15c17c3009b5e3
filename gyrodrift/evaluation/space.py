"""Search ranges of parameters, and their map to the unit cube."""

from collections.abc import Sequence
from dataclasses import astuple, dataclass, replace
from typing import get_type_hints

import numpy as np
from annotated_types import Ge, Le, Lt

from gyrodrift.filters.filter import Filter, FilterParams
from gyrodrift.values.arrays import Floats
from gyrodrift.values.errors import UsageError


@dataclass(frozen=True, slots=True)
class Axis:
    """Search range of a parameter, linear or logarithmic."""

    name: str
    low: float
    high: float
    is_log: bool = False

    def values(self, u: Floats) -> Floats:
        """Values of the parameter from the unit interval."""
        inside = np.clip(u, 0.0, 1.0)
        if self.is_log:
            values: Floats = np.clip(self.low * (self.high / self.low) ** inside, self.low, self.high)
        else:
            values = self.low + (self.high - self.low) * inside
        return values

    def unit(self, value: float) -> float:
        """Position of a value in the unit interval; a value outside is moved to the nearer end."""
        inside = min(max(value, self.low), self.high)
        if self.is_log:
            return float(np.log(inside / self.low) / np.log(self.high / self.low))
        return (inside - self.low) / (self.high - self.low)


def axes_of(chosen: Filter) -> tuple[Axis, ...]:
    """Axes of the searched parameters of a filter."""
    ranges = [(parameter.name, parameter.search) for parameter in chosen.searched]
    return tuple(Axis(name, span.low, span.high, span.is_log) for name, span in ranges if span is not None)


def row_of(params: FilterParams) -> Floats:
    """Parameters as one candidate, shape (1, parameters)."""
    return np.array([astuple(params)], dtype=np.float64)


def candidates_of(chosen: Filter, axes: Sequence[Axis], values: Floats) -> Floats:
    """Candidates with all parameters of the filter, shape (c, parameters), from values of the axes, shape (c, axes)."""
    unsearched = chosen.params() if chosen.unsearched is None else chosen.unsearched
    whole = np.repeat(row_of(unsearched), len(values), axis=0)
    for column, axis in enumerate(axes):
        whole[:, chosen.names.index(axis.name)] = values[:, column]
    return whole


def params_record(chosen: Filter, candidate: Floats) -> FilterParams:
    """A candidate, shape (parameters,), as the record of its filter."""
    record: FilterParams = chosen.params(*candidate.tolist())
    return record


def linear(axes: Sequence[Axis]) -> tuple[Axis, ...]:
    """Axes with the same ranges, all linear."""
    return tuple(replace(axis, is_log=False) for axis in axes)


def values_of(axes: Sequence[Axis], cube: Floats) -> Floats:
    """Values of the axes, shape (c, axes), from points of the unit cube of the same shape."""
    return np.column_stack([axis.values(cube[:, column]) for column, axis in enumerate(axes)])


def with_ranges(texts: Sequence[str], chosen: Filter) -> tuple[Axis, ...]:
    """Axes of a filter; texts like `tau_s=0.01:2` replace ranges.

    Raises
    ------
    UsageError
        If a name is unknown, a range is reversed, or the filter does not accept its values.
    """
    axes = {axis.name: axis for axis in axes_of(chosen)}
    for text in texts:
        name, low, high = _parsed(text)
        if name not in axes:
            raise UsageError(f"--range {text}: unknown parameter {name}; there are {', '.join(axes)}")
        if not low < high:
            raise UsageError(f"--range {text}: LOW must be below HIGH")
        axes[name] = _checked(text, replace(axes[name], low=low, high=high), chosen)
    return tuple(axes.values())


def _parsed(text: str) -> tuple[str, float, float]:
    name, _, ends = text.partition("=")
    low, _, high = ends.partition(":")
    try:
        return name.strip(), float(low), float(high)
    except ValueError:
        raise UsageError(f"--range {text}: expected NAME=LOW:HIGH, such as tau_s=0.01:2") from None


def limits(name: str, chosen: Filter) -> tuple[float, float]:
    """Bounds of a parameter: minimum and maximum."""
    low, high = -np.inf, np.inf
    for bound in get_type_hints(chosen.params, include_extras=True)[name].__metadata__:
        if isinstance(bound, Le | Lt):
            high = float(bound.le if isinstance(bound, Le) else bound.lt)  # type: ignore[arg-type]
        else:
            low = float(bound.ge if isinstance(bound, Ge) else bound.gt)  # type: ignore[arg-type]
    return low, high


def _checked(text: str, axis: Axis, chosen: Filter) -> Axis:
    low, high = limits(axis.name, chosen)
    if axis.high > high:
        raise UsageError(f"--range {text}: {axis.name} is at most {high:g}")
    if axis.low < low:
        raise UsageError(f"--range {text}: {axis.name} is at least {low:g}")
    if axis.is_log and axis.low <= 0.0:
        raise UsageError(f"--range {text}: {axis.name} is searched on a logarithmic scale; LOW must be above 0")
    return axis
