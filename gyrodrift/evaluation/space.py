"""The ranges that parameters are searched in, and the unit cube in which every search method works."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import get_type_hints

import numpy as np
from annotated_types import Ge, Le, Lt

from gyrodrift.arrays import Floats
from gyrodrift.errors import UsageError
from gyrodrift.filters.registry import HDR, Filter


@dataclass(frozen=True, slots=True)
class Axis:
    """One parameter: its range, and whether factors or differences count in it."""

    name: str
    low: float
    high: float
    is_log: bool = False

    def values(self, u: Floats) -> Floats:
        """From the unit interval to the parameter's own unit."""
        inside = np.clip(u, 0.0, 1.0)
        if self.is_log:
            found: Floats = np.clip(self.low * (self.high / self.low) ** inside, self.low, self.high)
        else:
            found = self.low + (self.high - self.low) * inside
        return found

    def unit(self, value: float) -> float:
        """From the parameter's own unit to the unit interval; what lies outside goes to the nearer end."""
        inside = min(max(value, self.low), self.high)
        if self.is_log:
            return float(np.log(inside / self.low) / np.log(self.high / self.low))
        return (inside - self.low) / (self.high - self.low)


AXES = (
    Axis("i_c_dps", 1e-6, 0.1, is_log=True),
    Axis("tau_s", 1e-3, 30.0, is_log=True),
    Axis("theta_w_dps", 0.02, 20.0, is_log=True),
    Axis("c1", 0.0, 3.0),
    Axis("c2", 0.0, 3.0),
)
"""Wide enough for sensors of 0.01 to 10 deg/s of bias at 2 Hz to 10 kHz; narrower on request."""

RESTLEVEL_AXES = (
    Axis("window_s", 0.05, 5.0, is_log=True),
    Axis("quiet", 1.0, 50.0, is_log=True),
    Axis("turn_on_dps", 0.02, 20.0, is_log=True),
    Axis("walk_dps_rts", 1e-6, 0.1, is_log=True),
    Axis("drift_dps_s", 1e-4, 0.3, is_log=True),
    Axis("still_start", 0.0, 0.9999),
    Axis("rest_share", 0.001, 0.9, is_log=True),
)
"""Of restlevel what yaw depends on."""


def linear(axes: Sequence[Axis]) -> tuple[Axis, ...]:
    """The same ranges with differences counting everywhere."""
    return tuple(replace(axis, is_log=False) for axis in axes)


def params_of(axes: Sequence[Axis], cube: Floats) -> Floats:
    """Parameter vectors, shape (c, axes), from points of the unit cube of the same shape."""
    return np.column_stack([axis.values(cube[:, number]) for number, axis in enumerate(axes)])


def with_ranges(texts: Sequence[str], known: Sequence[Axis] = AXES, chosen: Filter = HDR) -> tuple[Axis, ...]:
    """The axes of a filter with some ranges replaced: `tau_s=0.01:2`.

    Raises
    ------
    UsageError
        Where a name is unknown, a range is upside down, or the filter does not take its values.
    """
    axes = {axis.name: axis for axis in known}
    for text in texts:
        name, low, high = _parsed(text)
        if name not in axes:
            raise UsageError(f"--range {text}: unknown parameter {name}; there are {', '.join(axes)}")
        if not low < high:
            raise UsageError(f"--range {text}: the range is upside down or empty")
        axes[name] = _checked(text, replace(axes[name], low=low, high=high), chosen)
    return tuple(axes.values())


def _parsed(text: str) -> tuple[str, float, float]:
    name, _, ends = text.partition("=")
    low, _, high = ends.partition(":")
    try:
        return name.strip(), float(low), float(high)
    except ValueError:
        raise UsageError(f"--range {text}: expected NAME=LOW:HIGH, such as tau_s=0.01:2") from None


def limits(name: str, chosen: Filter = HDR) -> tuple[float, float]:
    """What a filter takes for a parameter, least and most."""
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
        raise UsageError(f"--range {text}: {axis.name} goes up to {high:g}")
    if axis.low < low:
        raise UsageError(f"--range {text}: {axis.name} begins at {low:g}")
    if axis.is_log and axis.low <= 0.0:
        raise UsageError(f"--range {text}: {axis.name} is searched by factors; its range begins above 0")
    return axis
