"""Unit of accelerations by gravity: at rest and in most motions their median length is 9.81 m/s²."""

from gyrodrift.columns.spec import ACCELERATION_MPS2
from gyrodrift.values.constants import STANDARD_GRAVITY_MPS2

NEAR = 0.25
"""Largest relative error of the length of gravity: biases, scale errors and the forces of a motion are smaller."""

FREE_SHARE = 0.2
"""Accelerations whose median length is a smaller share of gravity are without gravity."""

COUNTS_PER_G = tuple(float(1 << bits) for bits in range(8, 16))
"""Counts of 10 to 16 bits at ±1 to ±16 g (data sheets of ADXL345, MMA8452, LIS3DH and MPU-6050)."""


def is_gravity(length: float, gravity: float = STANDARD_GRAVITY_MPS2, error: float = NEAR) -> bool:
    """Whether a length is that of gravity, which is `gravity` in the same unit, up to a relative error."""
    return abs(length - gravity) <= error * gravity


def gravity_unit(length: float, error: float = NEAR) -> str:
    """Unit in which a length is gravity, as in a SPEC, up to a relative error; empty if there is none."""
    named = {unit: STANDARD_GRAVITY_MPS2 / scale for unit, scale in ACCELERATION_MPS2.items()}
    counted = {f"lsb/{counts:.0f}": counts for counts in COUNTS_PER_G if not is_gravity(counts, named["mg"])}
    return next((unit for unit, size in (named | counted).items() if is_gravity(length, size, error)), "")
