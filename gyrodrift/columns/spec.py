"""Columns of foreign text and tables, as the user writes them: `t_ms, _, _, rate:lsb/131:-`."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from math import degrees, isfinite, nan

from gyrodrift.values.constants import FULL_TURN_DEG, SECONDS_PER_MINUTE, STANDARD_GRAVITY_MPS2
from gyrodrift.values.errors import UsageError
from gyrodrift.values.words import did_you_mean, nearest

IGNORED, SELECTED = "_", "="
"""Meanings of columns that are no quantity: ignored, and with the value of the rows to use."""

CLOCK_US = {"t_us": 1.0, "t_ms": 1e3, "t_s": 1e6, "t_ns": 1e-3}
"""Microseconds per unit of a clock."""

COUNTED_US = {"s.ms": 1e3, "s.us": 1.0, "s.ns": 1e-3}
"""Clocks whose fraction is a count without leading zeros, and the microseconds of it: `printf("%ld.%ld", s, us)`."""

CLOCK_UNITS_US = {
    **{name.removeprefix("t_"): us for name, us in CLOCK_US.items()},
    "min": SECONDS_PER_MINUTE * 1e6,
    "days": 86400e6,
    "hms": 1e6,
    **dict.fromkeys(COUNTED_US, 1e6),
}
"""Units of `t:UNIT`; days are those of Excel and of MATLAB's datenum, hms is HHMMSS.ss as in NMEA sentences."""

RATE_DPS = {"dps": 1.0, "mdps": 1e-3, "rads": degrees(1.0), "mrads": degrees(1e-3)}
ANGLE_DEG = {"deg": 1.0, "rad": degrees(1.0)}
DIRECTIONS = {"compass": -1.0, "cw": -1.0, "ccw": 1.0}
HEADING_DEG = {**ANGLE_DEG, **DIRECTIONS}
"""Units of a heading; `compass` and `cw` count clockwise, `ccw` counter-clockwise like all other angles."""

SPEED_MPS = {"mps": 1.0, "kn": 1852.0 / 3600.0, "kmh": 1.0 / 3.6}
"""Meters per second of a unit of speed; a knot is a nautical mile of 1852 m an hour."""

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
    is_aid
        Whether it is that of a second source, which may have a standard deviation and a delay.
    """

    units: Mapping[str, float] = field(default_factory=dict)
    per: str = ""
    per_scale: float = 1.0
    is_signed: bool = True
    is_aid: bool = False


RATE = Quantity(RATE_DPS, "lsb")
ACCELERATION = Quantity(ACCELERATION_MPS2, "lsb", STANDARD_GRAVITY_MPS2)
CLOCK = Quantity(CLOCK_UNITS_US, "lsb", 1e6, is_signed=False)
PLAIN = Quantity(is_signed=False)
WHEELS = ("wheel_left", "wheel_right")
AIDS: Mapping[str, Quantity] = {
    **dict.fromkeys(WHEELS, Quantity({"mps": 1.0, "dps": 1.0}, "lsb", is_aid=True)),
    "turn_rate": Quantity({"dps": 1.0, "rads": degrees(1.0)}, "lsb", is_aid=True),
    "heading": Quantity(HEADING_DEG, "lsb", is_aid=True),
    "speed": Quantity(SPEED_MPS, "lsb", is_aid=True),
}
"""Meanings of second sources; wheels may have any unit, since their track is unknown."""

AID_MEANINGS = frozenset(AIDS)
QUATERNION = ("q.w", "q.x", "q.y", "q.z")
QUANTITIES: Mapping[str, Quantity] = {
    **dict.fromkeys((IGNORED, *CLOCK_US), PLAIN),
    "t": CLOCK,
    **dict.fromkeys((*(f"d{name}" for name in CLOCK_US), "seq"), PLAIN),
    "rate": RATE,
    "delta": Quantity(ANGLE_DEG, "lsb"),
    "encoder": Quantity(ANGLE_DEG, "counts", FULL_TURN_DEG),
    "temp": PLAIN,
    "still": PLAIN,
    "yaw": Quantity(ANGLE_DEG),
    **dict.fromkeys(QUATERNION, Quantity({}, "lsb")),
    **dict.fromkeys(("gx", "gy"), RATE),
    **dict.fromkeys(("ax", "ay", "az"), ACCELERATION),
    **AIDS,
}
"""All meanings of a column; the rate is about the vertical axis, z."""

MEANINGS = tuple(QUANTITIES)
TURNS = {"rate": "a rate", "delta": "a delta", QUATERNION[0]: "a quaternion", "yaw": "yaw"}
"""Meanings that say how the device turns; a SPEC has one of them."""

OTHER_NAMES = {
    "gz": "rate",
    "temp_c": "temp",
    "rate_dps": "rate",
    "encoder_deg": "encoder",
    "yaw_deg": "yaw",
    "rest": "still",
}
NAMES = [*MEANINGS, *(name for name in OTHER_NAMES if name != "rest")]
"""Names for typing errors; `rest` is nearer to a wrong `rate` than `rate` itself."""

EXAMPLE = '--columns "t_ms, _, _, rate:lsb/131"'
EXPECTED = (
    f"expected one entry per column: {', '.join(MEANINGS)}; rate, gx and gy may have :dps, :mdps, :rads, :mrads or"
    f" :lsb/N, delta (the angle since the last sample), yaw and encoder :deg or :rad, encoder :counts/N, ax, ay and az"
    f" :mps2, :g, :mg or :lsb/N, and all of them :- for the other sign; t is a clock in other units, :lsb/N (N ticks a"
    f" second), :min, :days or :hms, dt_ms the time since the last sample, and +t_ms is added to a clock before it;"
    f" heading may have :deg, :rad and :compass (clockwise), speed :mps, :kn or :kmh, turn_rate :dps or :rads,"
    f" wheel_left and wheel_right :mps or :dps, each of them :sigma/N and :late/S (seconds), and heading :mod/90;"
    f" LABEL=VALUE uses only the rows with this value. As in {EXAMPLE}"
)
AID_OPTION = re.compile(r"(sigma|late|mod)/([0-9]{1,9}(?:\.[0-9]{0,9})?)")
PER = re.compile(r"(lsb|counts)/([0-9]{1,12}(?:\.[0-9]{0,12})?)")
TYPO_SIMILARITY, SHORTEST_TYPO = 0.7, 3
"""A VALUE that resembles a meaning this much, from this length on, is a typing error: `raet`, but not `GYRO` or `B`."""


@dataclass(frozen=True, slots=True)
class Column:
    """Column of a text or a table.

    meaning
        One of MEANINGS, or SELECTED; that of a clock begins with `+` if it is added to another one.
    scale
        Factor to µs, deg/s, degrees or m/s², with its sign.
    label
        Label in a line; empty if the position identifies it.
    unit
        Unit as written, `rads` or `lsb/131`; empty without one. For SELECTED, the value of the rows to use.
    sigma, late_s, modulo_deg
        Of a second source: standard deviation in its unit, NaN if unknown, delay in s, and period of a heading.
    """

    meaning: str
    scale: float = 1.0
    label: str = ""
    unit: str = ""
    sigma: float = nan
    late_s: float = 0.0
    modulo_deg: float = FULL_TURN_DEG

    @property
    def clock(self) -> str:
        """Entry of a clock, for `times.ClockReader`; empty for another column."""
        is_clock = self.meaning.lstrip("+d") in ("t", *CLOCK_US)
        return self.entry if is_clock else ""

    @property
    def entry(self) -> str:
        """Entry without the label."""
        sign = ":-" if self.scale < 0.0 else ""
        return f"{self.meaning}:{self.unit}".rstrip(":") + sign + "".join(self._aid_options())

    def _aid_options(self) -> Iterator[str]:
        scale = abs(self.scale) or 1.0
        yield f":sigma/{self.sigma / scale:g}" if isfinite(self.sigma) else ""
        yield f":late/{self.late_s:g}" if self.late_s else ""
        yield f":mod/{self.modulo_deg:g}" if self.modulo_deg != FULL_TURN_DEG else ""


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


def parsed(spec: str, *, is_aid: bool = False) -> tuple[Column, ...]:
    """Columns of a SPEC; `is_aid` for a second source, which needs no rate.

    Raises
    ------
    ValueError
        An entry is wrong; the message says what is expected.
    """
    columns = tuple(column_of(entry.strip()) for entry in _entries(spec))
    problem = next(_problems(columns, is_aid=is_aid), "")
    if problem:
        raise ValueError(f"{spec!r}: {problem}")
    return columns


def _entries(spec: str) -> list[str]:
    """Entries between the commas that do not stand in quotes."""
    entries, is_quoted = [""], False
    for part in re.split('([,"])', spec):
        is_quoted ^= part == '"'
        if part == "," and not is_quoted:
            entries.append("")
        else:
            entries[-1] += part
    return spec.split(",") if is_quoted else entries


def _problems(columns: Sequence[Column], *, is_aid: bool) -> Iterator[str]:
    """Contradictions between the columns."""
    meanings = [column.meaning for column in columns if column.meaning not in (IGNORED, SELECTED)]
    for meaning in meanings:
        if meanings.count(meaning) > 1:
            yield f"{meaning} is given twice; call the other one {IGNORED}"
    clocks = [column for column in columns if column.clock and not column.meaning.startswith("+")]
    if len(clocks) > 1:
        yield f"there are two clocks; call one of them {IGNORED}, or +{clocks[1].clock} if they are to be added"
    if any(meaning.startswith("+") for meaning in meanings) and not any(c.meaning.startswith("t") for c in clocks):
        yield "a column with + is added to a clock: name that one, as in 't_s, +t_ns, rate'"
    parts = [meaning for meaning in meanings if meaning in QUATERNION]
    if parts and len(parts) < len(QUATERNION):
        yield f"a quaternion needs all of {', '.join(QUATERNION)}"
    turns = [words for meaning, words in TURNS.items() if meaning in meanings]
    yield from _aid_problems(meanings, is_aid=is_aid)
    if not turns and not is_aid:
        yield _without_turn(columns)
    if len(turns) > 1:
        yield f"there are {' and '.join(turns)}; call one of them {IGNORED}, or call yaw encoder"
    if len({bool(column.label) for column in columns}) > 1:
        yield "either all columns need a label (LABEL=rate), or none"


def _aid_problems(meanings: Sequence[str], *, is_aid: bool) -> Iterator[str]:
    """Contradictions between the columns of second sources."""
    if is_aid and not any(meaning in AID_MEANINGS or meaning == "still" for meaning in meanings):
        yield f"no column is a second source: {', '.join(sorted(AID_MEANINGS))} or rest"
    if len(wheels := [meaning for meaning in meanings if meaning in WHEELS]) == 1:
        yield f"there is {wheels[0]} alone; two wheels show a turn: name {' and '.join(WHEELS)}, or call it speed"


def _without_turn(columns: Sequence[Column]) -> str:
    selected = [f"{column.label}={column.unit}" for column in columns if column.meaning == SELECTED]
    note = f" ({' and '.join(selected)} selects rows)" if selected else ""
    return f"no column is the rate or yaw{note}; {EXPECTED}"


def spec_text(entries: Sequence[str], labels: Sequence[str] = ()) -> str:
    """SPEC of entries such as `rate:lsb/131`: with labels if there are any, else by position."""
    if any(labels):
        named = zip(labels, entries, strict=True)
        return ", ".join(f"{quoted(label)}={entry}" for label, entry in named if label and entry != IGNORED)
    used = [index for index, entry in enumerate(entries) if entry != IGNORED]
    return ", ".join(entries[: max(used, default=-1) + 1])


def quoted(text: str) -> str:
    """A label or a value for a SPEC, in quotes if it has a comma or other marks of a SPEC."""
    return '"{}"'.format(text.replace('"', '""')) if re.search(r'[,="]', text) else text


def selection(label: str, value: str) -> str:
    """Entry of a SPEC that uses the rows with a value, in quotes if the value could be a meaning."""
    try:
        is_plain = column_of(f"{quoted(label)}={quoted(value)}").meaning == SELECTED
    except ValueError:
        is_plain = False
    return f"{quoted(label)}={quoted(value)}" if is_plain else f'{quoted(label)}="{value}"'


def column_of(entry: str) -> Column:
    """Column of an entry such as `gz=rate:rads`.

    Raises
    ------
    ValueError
        The entry is wrong; the message says what is expected.
    """
    before, mark, meaning_text = entry.rpartition('="' if entry.endswith('"') else "=")
    label = " ".join(_unquoted(before.strip()).split()) if mark else None
    if mark == '="':
        return Column(SELECTED, label=label or "", unit=_unquoted(f'"{meaning_text}'))
    name, *options = (part.strip() for part in meaning_text.split(":"))
    plus, name = ("+", name[1:]) if name.startswith("+t") else ("", name)
    meaning = OTHER_NAMES.get(name, name)
    if meaning not in QUANTITIES or (plus and meaning not in ("t", *CLOCK_US)) or (label == "" and name):
        if label is not None and name and meaning not in QUANTITIES and not _is_typo(name):
            return Column(SELECTED, label=label, unit=meaning_text.strip())
        raise ValueError(f"{entry!r} is not a column; {_meant(label, name)}{EXPECTED}")
    quantity, scale, unit = QUANTITIES[meaning], CLOCK_US.get(meaning, 1.0), ""
    of_aid: dict[str, float] = {}
    for option in options:
        if quantity.is_aid and (match := AID_OPTION.fullmatch(option)):
            of_aid[match[1]] = float(match[2])
            continue
        factor = -1.0 if option == "-" and quantity.is_signed else scale_of(quantity, option)
        if factor is None:
            raise ValueError(f"{entry!r}: {option!r} is not a unit of {meaning}; {EXPECTED}")
        scale *= factor
        unit = unit if option in ("-", *DIRECTIONS) else option
    if meaning == "t" and f"t_{unit}" in CLOCK_US:
        meaning, unit = f"t_{unit}", ""
    elif meaning == "t" and not unit:
        raise ValueError(f"{entry!r}: t needs a unit, such as t_ms, t:lsb/32768 or t:days; {EXPECTED}")
    if not quantity.is_aid:
        return Column(f"{plus}{meaning}", scale, label or "", unit)
    return Column(meaning, scale, label or "", unit, *_aid_options(entry, meaning, scale, of_aid))


def _aid_options(entry: str, meaning: str, scale: float, given: Mapping[str, float]) -> tuple[float, float, float]:
    """Standard deviation in the unit of a session, delay and period of a second source."""
    sigma, modulo = given.get("sigma", nan), given.get("mod", FULL_TURN_DEG)
    if sigma == 0.0:
        raise ValueError(f"{entry!r}: a standard deviation of 0 is a truth, and no source is one")
    if modulo == 0.0 or FULL_TURN_DEG % modulo or ("mod" in given and meaning != "heading"):
        raise ValueError(f"{entry!r}: expected heading:mod/90, or another part of 360 deg")
    return abs(scale) * sigma, given.get("late", 0.0), modulo


def _unquoted(text: str) -> str:
    return text[1:-1].replace('""', '"') if len(text) > 1 and text[0] == text[-1] == '"' else text


def _is_typo(name: str) -> bool:
    """Whether a text is a typing error of a meaning, or a unit without its meaning, and no value of a column."""
    names = [*NAMES, *RATE_DPS, *ANGLE_DEG]
    return name in RATE_DPS or (len(name) >= SHORTEST_TYPO and bool(nearest(name, names, 1, TYPO_SIMILARITY)))


def _meant(label: str | None, name: str) -> str:
    """Hint at the meaning of a wrong entry; empty if nothing is near."""
    meant = f"did you mean rate:{name}?" if name in RATE_DPS else did_you_mean(name, NAMES)
    value = f'to use only the rows with this value, write {quoted(label)}="{name}";' if label else ""
    return "".join(f"{part} " for part in (meant, value) if part)


def scale_of(quantity: Quantity, option: str) -> float | None:
    """Factor of a unit to the unit of a session; None for an unknown unit."""
    if option in quantity.units:
        return quantity.units[option]
    match = PER.fullmatch(option)
    per = float(match[2]) if match and match[1] == quantity.per else 0.0
    return quantity.per_scale / per if per else None
