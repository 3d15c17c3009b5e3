"""Units and scales by what a quarter turn measures of them: one is told only where no neighbour fits as well."""

from dataclasses import dataclass
from math import degrees

from gyrodrift.columns.spec import PER, RATE_DPS
from gyrodrift.columns.units import Dimension, Unit

QUARTER_DEG = 90.0
HAND = 0.15
"""How far a quarter turn of a hand may be off, relative."""

BESIDE_ANGLE = 0.05
"""The same where an angle in the same lines says how far the turn was."""

STATED_WITHIN = 0.25
"""A unit that is written is believed within this, and no two units are so near each other."""

LEAST_MEASURED = 5.0
"""Below so many units per deg/s no sensor gives counts: such a column is an axis that is tilted, or no rate."""


@dataclass(frozen=True, slots=True)
class PrintedUnit:
    """A unit of a rate as a SPEC writes it, and how many of it are one deg/s."""

    option: str
    per_dps: float
    about: str


KNOWN = (
    PrintedUnit("dps", 1.0, "deg/s"),
    PrintedUnit("rads", 1.0 / degrees(1.0), "rad/s"),
    PrintedUnit("mdps", 1e3, "mdeg/s"),
    PrintedUnit("mrads", 1e3 / degrees(1.0), "mrad/s"),
    PrintedUnit("lsb/60", 60.0, "deg/min"),
    PrintedUnit("lsb/10", 10.0, "0.1 deg/s"),
    PrintedUnit("lsb/100", 100.0, "0.01 deg/s"),
    PrintedUnit("lsb/131", 131.0, "counts of ±250 deg/s, InvenSense"),
    PrintedUnit("lsb/65.5", 65.5, "counts of ±500 deg/s, InvenSense"),
    PrintedUnit("lsb/32.8", 32.8, "counts of ±1000 deg/s, InvenSense"),
    PrintedUnit("lsb/16.4", 16.4, "counts of ±2000 deg/s, InvenSense"),
    PrintedUnit("lsb/228.57", 228.57, "counts of 4.375 mdeg/s, ST"),
    PrintedUnit("lsb/114.28", 114.28, "counts of 8.75 mdeg/s, ST"),
    PrintedUnit("lsb/57.14", 57.14, "counts of 17.5 mdeg/s, ST"),
    PrintedUnit("lsb/28.57", 28.57, "counts of 35 mdeg/s, ST"),
    PrintedUnit("lsb/14.29", 14.29, "counts of 70 mdeg/s, ST"),
    PrintedUnit("lsb/16", 16.0, "counts of a BNO055"),
    PrintedUnit("lsb/14.375", 14.375, "counts of an ITG-3200"),
)
"""Units that boards print, and the sensitivities of data sheets."""


@dataclass(frozen=True, slots=True)
class Scale:
    """How a rate is printed.

    option
        As a SPEC writes it: of a known unit, or lsb/N as measured.
    per_dps
        Units for one deg/s, as measured.
    near
        Known units that the measurement does not tell apart; one where the unit is known.
    error
        Of `option`, relative: 0 where the unit is known.
    """

    option: str
    per_dps: float
    near: tuple[PrintedUnit, ...]
    error: float

    @property
    def is_known(self) -> bool:
        """Whether it is a unit or a sensitivity that exists."""
        return self.error == 0.0


def scale_of(integral: float, turned_deg: float, within: float) -> Scale | None:
    """By the integral of a column over a turn of `turned_deg`, known to `within`; None where it is no rate's."""
    per_dps = abs(integral / turned_deg)
    near = tuple(unit for unit in KNOWN if 1.0 / (1.0 + within) < per_dps / unit.per_dps < 1.0 + within)
    if len(near) == 1:
        return Scale(near[0].option, per_dps, near, 0.0)
    if per_dps < LEAST_MEASURED:
        return None
    return Scale(f"lsb/{_three_digits(per_dps)}", per_dps, near, within)


def stated_scale(unit: Unit | None, integral: float, turned_deg: float) -> Scale | None:
    """Of a unit that is written beside the column; None where none is, or where the turn stands against it."""
    if unit is None or unit.dimension is not Dimension.RATE or not unit.option:
        return None
    stated = per_dps_of(unit.option)
    per_dps = abs(integral / turned_deg)
    if not 1.0 / (1.0 + STATED_WITHIN) < per_dps / stated < 1.0 + STATED_WITHIN:
        return None
    return Scale(unit.option, per_dps, (known_unit(unit.option),), 0.0)


def per_dps_of(option: str) -> float:
    """Units for one deg/s of an option of a rate."""
    if option in RATE_DPS:
        return 1.0 / RATE_DPS[option]
    found = PER.fullmatch(option)
    return float(found[2]) if found else 1.0


def known_unit(option: str) -> PrintedUnit:
    """The unit of an option, as people call it where they have a name for it."""
    named = (unit for unit in KNOWN if unit.option == option)
    return next(named, PrintedUnit(option, per_dps_of(option), option))


def _three_digits(value: float) -> str:
    return f"{value:.3g}" if value < 1e3 else f"{float(f'{value:.3g}'):.0f}"
