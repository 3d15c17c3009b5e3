"""Unit and scale of a rate, from the integral of a quarter turn; a unit is certain only if no other one fits."""

from dataclasses import dataclass
from math import degrees

from gyrodrift.columns.sizes import INVENSENSE, ST, ST_FINEST
from gyrodrift.columns.spec import PER, RATE_DPS
from gyrodrift.columns.units import Dimension, Unit

QUARTER_DEG = 90.0
HAND = 0.15
"""Largest relative error of a quarter turn by hand."""

ANGLE_TOLERANCE = 0.05
"""Largest relative error of the turn, if an angle in the same lines measures it."""

STATED_WITHIN = 0.25
"""Largest relative difference to a stated unit; other units differ by more."""

COUNTS_MIN = 5.0
"""Smallest counts per deg/s of a sensor; below, the column is a tilted axis, or not a rate."""


@dataclass(frozen=True, slots=True)
class PrintedUnit:
    """Unit of a rate as in a SPEC, and its number per deg/s."""

    option: str
    per_dps: float
    about: str


PRINTED_UNITS = (
    PrintedUnit("dps", 1.0, "deg/s"),
    PrintedUnit("rads", 1.0 / degrees(1.0), "rad/s"),
    PrintedUnit("mdps", 1e3, "mdeg/s"),
    PrintedUnit("mrads", 1e3 / degrees(1.0), "mrad/s"),
    PrintedUnit("lsb/60", 60.0, "deg/min"),
    PrintedUnit("lsb/10", 10.0, "0.1 deg/s"),
    PrintedUnit("lsb/100", 100.0, "0.01 deg/s"),
    *(
        PrintedUnit(f"lsb/{counts:g}", counts, f"counts of ±{full_scale} deg/s, InvenSense")
        for full_scale, counts in INVENSENSE.items()
    ),
    *(
        PrintedUnit(f"lsb/{counts:g}", counts, f"counts of {step:g} mdeg/s, ST")
        for step, counts in (ST_FINEST, *ST.items())
    ),
    PrintedUnit("lsb/16", 16.0, "counts of a BNO055"),
    PrintedUnit("lsb/14.375", 14.375, "counts of an ITG-3200"),
)
"""Units that boards print, and sensitivities of data sheets."""


@dataclass(frozen=True, slots=True)
class Scale:
    """Scale of a printed rate.

    option
        Unit as in a SPEC; lsb/N with the measured N if it is unknown.
    per_dps
        Measured units per deg/s.
    near
        Known units that fit the measurement; a single one if the unit is known.
    error
        Relative error of `option`: 0 if the unit is known.
    """

    option: str
    per_dps: float
    near: tuple[PrintedUnit, ...]
    error: float

    @property
    def is_known(self) -> bool:
        """Whether the unit is known."""
        return self.error == 0.0


def scale_of(integral: float, turn_deg: float, within: float, *, is_named: bool = False) -> Scale | None:
    """Scale from the integral of a column over `turn_deg`, relative error `within`; None if it is not a rate.

    A column whose label names the yaw rate (`is_named`) may have any unit, such as percent of the full scale.
    """
    per_dps = abs(integral / turn_deg)
    near = tuple(unit for unit in PRINTED_UNITS if 1.0 / (1.0 + within) < per_dps / unit.per_dps < 1.0 + within)
    if len(near) == 1:
        return Scale(near[0].option, per_dps, near, 0.0)
    if per_dps < COUNTS_MIN and not is_named:
        return None
    return Scale(f"lsb/{_three_digits(per_dps)}", per_dps, near, within)


def stated_scale(unit: Unit | None, integral: float, turn_deg: float) -> Scale | None:
    """Scale from a stated unit; None without a unit, or if the turn contradicts it."""
    if unit is None or unit.dimension is not Dimension.RATE or not unit.option:
        return None
    stated = per_dps_of(unit.option)
    per_dps = abs(integral / turn_deg)
    if not 1.0 / (1.0 + STATED_WITHIN) < per_dps / stated < 1.0 + STATED_WITHIN:
        return None
    return Scale(unit.option, per_dps, (known_unit(unit.option),), 0.0)


def per_dps_of(option: str) -> float:
    """Units per deg/s of an option of a rate."""
    if option in RATE_DPS:
        return 1.0 / RATE_DPS[option]
    match = PER.fullmatch(option)
    return float(match[2]) if match else 1.0


def known_unit(option: str) -> PrintedUnit:
    """Unit of an option, with its usual name if it has one."""
    named = (unit for unit in PRINTED_UNITS if unit.option == option)
    return next(named, PrintedUnit(option, per_dps_of(option), option))


def _three_digits(value: float) -> str:
    return f"{value:.3g}" if value < 1e3 else f"{float(f'{value:.3g}'):.0f}"
