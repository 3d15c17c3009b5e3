"""Columns of foreign text and tables, as the user writes them: `t_ms, _, _, rate:lsb/131:-`."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import degrees

from gyrodrift.values.constants import STANDARD_GRAVITY_MPS2
from gyrodrift.values.errors import UsageError
from gyrodrift.values.nearest import did_you_mean

IGNORED = "_"
CLOCK_US = {"t_us": 1.0, "t_ms": 1e3, "t_s": 1e6, "t_ns": 1e-3}
"""Microseconds per unit of a clock."""

RATE_DPS = {"dps": 1.0, "mdps": 1e-3, "rads": degrees(1.0), "mrads": degrees(1e-3)}
ANGLE_DEG = {"deg": 1.0, "rad": degrees(1.0)}
ACCELERATION_MPS2 = {"mps2": 1.0, "g": STANDARD_GRAVITY_MPS2, "mg": 1e-3 * STANDARD_GRAVITY_MPS2}


@dataclass(frozen=True, slots=True)
class Quantity:
    """Units that may follow a meaning as `:UNIT`.

    units
        Name, and factor to the unit of a session.
    per
        `lsb` or `counts`, if a scale may be given as lsb/N or counts/N.
    per_scale
        Value of N counts in the unit of a session.
    is_signed
        Whether `:-` may reverse its sign.
    """

    units: Mapping[str, float] = field(default_factory=dict)
    per: str = ""
    per_scale: float = 1.0
    is_signed: bool = True


RATE = Quantity(RATE_DPS, "lsb")
ACCELERATION = Quantity(ACCELERATION_MPS2, "lsb", STANDARD_GRAVITY_MPS2)
PLAIN = Quantity(is_signed=False)
QUANTITIES: Mapping[str, Quantity] = {
    **dict.fromkeys((IGNORED, *CLOCK_US, "seq"), PLAIN),
    "rate": RATE,
    "encoder": Quantity(ANGLE_DEG, "counts", 360.0),
    "temp": PLAIN,
    "still": PLAIN,
    "yaw": Quantity(ANGLE_DEG),
    **dict.fromkeys(("gx", "gy"), RATE),
    **dict.fromkeys(("ax", "ay", "az"), ACCELERATION),
}
"""All meanings of a column; the rate is about the vertical axis, z."""

MEANINGS = tuple(QUANTITIES)
OTHER_NAMES = {"gz": "rate", "temp_c": "temp", "rate_dps": "rate", "encoder_deg": "encoder", "yaw_deg": "yaw"}
EXAMPLE = '--columns "t_ms, _, _, rate:lsb/131"'
EXPECTED = (
    f"expected one entry per column: {', '.join(MEANINGS)}; rate, gx and gy may have :dps, :mdps, :rads, :mrads or"
    f" :lsb/N, encoder :deg, :rad or :counts/N, yaw :deg or :rad, ax, ay and az :mps2, :g, :mg or :lsb/N, and all of"
    f" them :- for the other sign, as in {EXAMPLE}"
)
PER = re.compile(r"(lsb|counts)/([0-9]{1,12}(?:\.[0-9]{0,12})?)")


@dataclass(frozen=True, slots=True)
class Column:
    """Column of a text or a table.

    meaning
        One of MEANINGS.
    scale
        Factor to µs, deg/s, degrees or m/s², with its sign.
    label
        Label in a line; empty if the position identifies it.
    unit
        Unit as written, `rads` or `lsb/131`; empty without one.
    """

    meaning: str
    scale: float = 1.0
    label: str = ""
    unit: str = ""


def columns_of(spec: str) -> tuple[Column, ...]:
    """Columns of the option `--columns SPEC`.

    Raises
    ------
    UsageError
        An entry is wrong; the message says what is expected.
    """
    try:
        return parsed(spec)
    except ValueError as error:
        raise UsageError(f"--columns: {error}") from error


def parsed(spec: str) -> tuple[Column, ...]:
    """Columns of a SPEC.

    Raises
    ------
    ValueError
        An entry is wrong; the message says what is expected.
    """
    columns = tuple(column_of(entry.strip()) for entry in spec.split(","))
    for meaning in MEANINGS[1:]:
        named = [column for column in columns if column.meaning == meaning]
        if len(named) > 1:
            raise ValueError(f"{spec!r}: {meaning} is given twice; call the other one {IGNORED}")
    meanings = {column.meaning for column in columns}
    if len(meanings & CLOCK_US.keys()) > 1:
        raise ValueError(f"{spec!r}: there are two clocks; call one of them {IGNORED}")
    if not meanings & {"rate", "yaw"}:
        raise ValueError(f"{spec!r}: no column is the rate or yaw; {EXPECTED}")
    if {"rate", "yaw"} <= meanings:
        raise ValueError(f"{spec!r}: there are a rate and yaw; call one of them {IGNORED}, or call yaw encoder")
    if len({bool(column.label) for column in columns}) > 1:
        raise ValueError(f"{spec!r}: either all columns need a label (LABEL=rate), or none")
    return columns


def spec_text(entries: Sequence[str], labels: Sequence[str] = ()) -> str:
    """SPEC of entries such as `rate:lsb/131`: with labels if there are any, else by position."""
    if any(labels):
        named = zip(labels, entries, strict=True)
        return ", ".join(f"{label}={entry}" for label, entry in named if label and entry != IGNORED)
    used = [index for index, entry in enumerate(entries) if entry != IGNORED]
    return ", ".join(entries[: max(used, default=-1) + 1])


def column_of(entry: str) -> Column:
    """Column of an entry such as `gz=rate:rads`.

    Raises
    ------
    ValueError
        The entry is wrong; the message says what is expected.
    """
    label, mark, meaning_text = entry.rpartition("=")
    name, *options = (part.strip() for part in meaning_text.strip().split(":"))
    meaning = OTHER_NAMES.get(name, name)
    if meaning not in QUANTITIES or (mark and not label.strip()):
        meant = f"{did_you_mean(name, [*MEANINGS, *OTHER_NAMES])} ".lstrip()
        raise ValueError(f"{entry!r} is not a column; {meant}{EXPECTED}")
    quantity, scale, unit = QUANTITIES[meaning], CLOCK_US.get(meaning, 1.0), ""
    for option in options:
        factor = -1.0 if option == "-" and quantity.is_signed else scale_of(quantity, option)
        if factor is None:
            raise ValueError(f"{entry!r}: {option!r} is not a unit of {meaning}; {EXPECTED}")
        scale *= factor
        unit = unit if option == "-" else option
    return Column(meaning, scale, " ".join(label.split()), unit)


def scale_of(quantity: Quantity, option: str) -> float | None:
    """Factor of a unit to the unit of a session; None for an unknown unit."""
    if option in quantity.units:
        return quantity.units[option]
    match = PER.fullmatch(option)
    per = float(match[2]) if match and match[1] == quantity.per else 0.0
    return quantity.per_scale / per if per else None
