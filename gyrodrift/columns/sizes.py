"""Usual sizes of quantities, by which columns are recognized and units checked: sensitivities, ranges, gravity."""

from gyrodrift.columns.spec import ACCELERATION_MPS2
from gyrodrift.values.constants import STANDARD_GRAVITY_MPS2

INVENSENSE = {250: 131.0, 500: 65.5, 1000: 32.8, 2000: 16.4}
"""Counts per deg/s by full scale, deg/s: MPU-6050 (PS-MPU-6000A), ICM-20948 (DS-000189). Bosch differs by 0.2 %."""

ST = {8.75: 114.28, 17.5: 57.14, 35.0: 28.57, 70.0: 14.29}
"""Counts per deg/s by step, mdeg/s, at ±250 to 2000 deg/s: LSM6DS3 (DocID026899), LSM6DSO (DS12140)."""

ST_FINEST = (4.375, 228.57)
"""Step, mdeg/s, and counts per deg/s at ±125 deg/s, which few sketches use."""

SENSITIVITIES = (*INVENSENSE.values(), *ST.values())
"""Counts per deg/s of common ranges."""

SAMPLE_RATES_HZ = (1.0, 20_000.0)
"""Sample rates of gyros, from a logger with a sample per second to more than the 8 kHz of an ICM-42688."""

SAME_SENSITIVITY = 0.01
"""Largest relative difference of a sensitivity as users and data sheets round it."""

WINDOW = 50
"""Samples of a window, for noise and level of a rate."""


def has_16_bits(scale: float) -> bool:
    """Whether counts of `scale` deg/s are those of a sensor with 16 bits, which has none above 2¹⁵.

    Larger ones are negative, and were printed without their sign.
    """
    counts = (*SENSITIVITIES, ST_FINEST[1])
    return any(abs(abs(scale) * count - 1.0) < SAME_SENSITIVITY for count in counts)


TEMPERATURES_C = (-55.0, 150.0)
"""Military temperature range up to the largest junction temperature; outside, a temperature is in counts."""

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
