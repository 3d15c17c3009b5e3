"""Reading of a line of the csv protocol, at a port and in a file."""

from collections.abc import Sequence
from math import isfinite, nan

from gyrodrift.values.constants import CLOCK_MASK
from gyrodrift.values.sample import Inertial, Reading

LEAST_AXES = 7
"""Least number of columns with three axes."""


def csv_reading(t_us: int, values: Sequence[float]) -> Reading:
    """Reading of the numbers after the clock; an infinite angle, temperature or acceleration is missing."""
    valid = [value if isfinite(value) else nan for value in values]
    has_axes = len(values) >= LEAST_AXES - 1
    inertial = Inertial(*values[:3], *valid[3:6]) if has_axes else None
    encoder_deg, temp_c, still, *_ = [*valid[6 if has_axes else 1 :], nan, nan, nan]
    return Reading(t_us & CLOCK_MASK, None, values[2 if has_axes else 0], encoder_deg, temp_c, still, nan, inertial)
