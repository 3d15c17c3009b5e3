"""Units of a clock, a rate and an angle: as written, or as the numbers exclude all others."""

import re
from collections.abc import Sequence
from math import hypot, log, pi, sqrt
from statistics import fmean

from gyrodrift.columns.behavior import step_of
from gyrodrift.columns.fields import is_whole
from gyrodrift.columns.names import SeenColumn
from gyrodrift.columns.rate_unit import DEGREES_OF_FREEDOM, NOISE_DPS, NOISE_SCALE, SURE_ODDS, student
from gyrodrift.columns.spec import CLOCK_US, RATE_DPS
from gyrodrift.columns.units import Dimension
from gyrodrift.values.constants import STANDARD_GRAVITY_MPS2

UNIT_FACTOR = 6.0
"""Largest factor between a clock and the arrival of its lines; its units differ by a factor of 1000."""

MICROSECONDS_FROM = 400.0
"""Without arrival times, a step of at least this is in µs (2.5 kHz), a smaller one in ms (2.5 Hz)."""

SI_ODDS = 10.0
"""Odds of rad/s if accelerations are in m/s²; a conservative guess that is never decisive alone.

Adafruit Unified Sensor and ROS use m/s² with rad/s, ESPHome and BNO055 with deg/s.
"""

OTHER_RATES, FORCES = ("gx", "gy"), ("ax", "ay", "az")
FORCE_UNITS = {
    "g": 1.0,
    "mps2": STANDARD_GRAVITY_MPS2,
    "mg": 1000.0,
    **{f"lsb/{counts}": float(counts) for counts in (2048, 4096, 8192, 16384)},
}
"""Length of gravity by unit; counts of 16 bits at ±2 to ±16 g (MPU-6050, register map 4.17)."""

IMU_RATE, IMU_FORCE = re.compile(r"(?:^|\.)angular_velocity\.z$"), re.compile(r"(?:^|\.)linear_acceleration\.z$")
"""Labels in a sensor_msgs/Imu as JSON; its rates are in rad/s (common_interfaces of ROS)."""

SAMPLES_MIN = 20
GRAVITY_WITHIN = 0.1
ALWAYS = (0.1, 0.5, 0.9)
"""Quantiles of the length: gravity is constant, and a turn of 1 rad/s is not."""


def clock_unit(column: SeenColumn, lines_per_s: float | None) -> tuple[str, str]:
    """Key of CLOCK_US, and the reason."""
    step = step_of(column.numbers) if len(column.numbers) > 1 else 0.0
    if lines_per_s and step > 0.0:
        offsets = {unit: step * scale * 1e-6 * lines_per_s for unit, scale in CLOCK_US.items()}
        unit = next((unit for unit, off in offsets.items() if 1.0 / UNIT_FACTOR < off < UNIT_FACTOR), "")
        if unit:
            return unit, f"grows by {step:g} per line, and {lines_per_s:.3g} lines arrive per second"
    if column.unit is not None and column.unit.dimension is Dimension.TIME:
        return column.unit.option, f"is labeled {column.label}"
    plain = re.sub(r"[^a-z]", "", column.label.lower())
    named = (
        ("t_ms", ("ms", "millis")),
        ("t_us", ("us", "micros")),
        ("t_ns", ("ns", "nanos")),
        ("t_s", ("sec", "seconds")),
    )
    for unit, endings in named:
        if plain.endswith(endings):
            return unit, f"is labeled {column.label}"
    if not all(map(is_whole, column.texts)) and step < 2.0:
        return "t_s", f"grows by {step:g} per line"
    return ("t_us" if step >= MICROSECONDS_FROM else "t_ms"), f"grows by {step:g} per line"


def rate_unit(column: SeenColumn, columns: Sequence[SeenColumn]) -> tuple[str, str]:
    """Unit for `rate:`, and the reason; empty if unknown."""
    unit = column.unit
    if unit is not None and unit.dimension is Dimension.RATE:
        return unit.option, f", in {unit.option} as labeled"
    if unit is not None:
        return "", ""
    if IMU_RATE.search(column.label) and any(IMU_FORCE.search(other_column.label) for other_column in columns):
        return "rads", ", in rad/s as a sensor_msgs/Imu of ROS"
    if _is_gravity(columns, ("gx", "gy", "rate"), (1.0, STANDARD_GRAVITY_MPS2), ALWAYS):
        return "", ", but the three columns have the length of gravity"
    odds = _radian_odds(column) * (SI_ODDS if _is_gravity_si(columns) else 1.0)
    if odds < SURE_ODDS:
        return "", ""
    with_gravity = " next to accelerations in m/s²" if _is_gravity_si(columns) else ""
    return "rads", f", in rad/s: its noise is too small for deg/s{with_gravity}, odds {odds:.0f} to 1"


def angle_unit(column: SeenColumn) -> tuple[str, str]:
    """Unit for `yaw:`, and the reason; empty if unknown."""
    if column.unit is not None and column.unit.dimension is Dimension.ANGLE:
        return column.unit.option, f", in {column.unit.option} as labeled"
    if max(map(abs, column.numbers)) > 2.0 * pi + 0.01:
        return "deg", ", in degrees, since it exceeds 2π"
    return "", ""


def axis_units(rate_unit_option: str, columns: Sequence[SeenColumn]) -> dict[str, str]:
    """Units of the rates about x and y and of the accelerations by kind; empty unless all of them are known.

    Without a label the unit of an acceleration is that in which its length is gravity. Rates alone are named too: they
    show which axis turns.
    """
    kinds = [column.kind for column in columns]
    rates = [column for column in columns if column.kind in OTHER_RATES]
    forces = [column for column in columns if column.kind in FORCES]
    is_whole_set = sorted(column.kind for column in (*rates, *forces) if column.is_numeric) == sorted(
        (*OTHER_RATES, *FORCES)
    )
    if rate_unit_option not in RATE_DPS and not rate_unit_option.startswith("lsb/"):
        return {}
    named = {column.kind: column.unit.option for column in rates if column.unit and column.unit.option}
    of_rates = dict.fromkeys(OTHER_RATES, rate_unit_option) | named
    if not forces and sorted(column.kind for column in rates if column.is_numeric) == sorted(OTHER_RATES):
        return of_rates
    force_unit = _force_unit(forces) if is_whole_set and "rate" in kinds else ""
    return of_rates | dict.fromkeys(FORCES, force_unit) if force_unit else {}


def _force_unit(forces: Sequence[SeenColumn]) -> str:
    """Unit of accelerations by their labels or by gravity; empty if unknown."""
    stated = {
        column.unit.option for column in forces if column.unit and column.unit.dimension is Dimension.ACCELERATION
    }
    if len(stated) == 1:
        return stated.pop()
    lengths = sorted(hypot(*vector) for vector in zip(*(column.numbers for column in forces), strict=True))
    length = lengths[len(lengths) // 2]
    return next((unit for unit, size in FORCE_UNITS.items() if abs(length - size) < GRAVITY_WITHIN * size), "")


def _radian_odds(column: SeenColumn) -> float:
    """Odds of rad/s against deg/s from the noise at rest; 1 if the noise is invisible."""
    numbers = column.numbers
    if len(numbers) < SAMPLES_MIN or all(map(is_whole, column.texts)):
        return 1.0
    bends = sorted(abs(a - 2.0 * b + c) for a, b, c in zip(numbers, numbers[1:], numbers[2:], strict=False))
    quiet = bends[: max(3, len(bends) // 2)]  # the device moves at most half of the time
    digits = max(len(text.partition(".")[2]) for text in column.texts)
    hidden = 10.0**-digits / sqrt(12.0)  # uniform rounding error of a step
    noise = max(sqrt(fmean(bend * bend for bend in quiet) / 6.0), hidden)
    return _density(noise * RATE_DPS["rads"]) / _density(noise)


def _density(noise_dps: float) -> float:
    """Student's t of the logarithm of a noise, up to a constant."""
    return student(log(noise_dps / NOISE_DPS) / NOISE_SCALE, DEGREES_OF_FREEDOM)


def _is_gravity_si(columns: Sequence[SeenColumn]) -> bool:
    """Whether three accelerations in the same line have the length of gravity in m/s²."""
    return _is_gravity(columns, ("ax", "ay", "az"), (STANDARD_GRAVITY_MPS2,))


def _is_gravity(
    columns: Sequence[SeenColumn], kinds: Sequence[str], sizes: Sequence[float], quantiles: Sequence[float] = (0.5,)
) -> bool:
    """Whether three columns have the length of gravity at these quantiles."""
    three = [column for kind in kinds for column in columns if column.kind == kind]
    if len(three) != 3 or not all(column.is_numeric for column in three):
        return False
    lengths = sorted(hypot(*vector) for vector in zip(*(column.numbers for column in three), strict=True))
    chosen_lengths = [lengths[int(quantile * (len(lengths) - 1))] for quantile in quantiles]
    return any(all(abs(length - size) < GRAVITY_WITHIN * size for length in chosen_lengths) for size in sizes)
