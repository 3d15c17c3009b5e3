"""The judge: meaning, unit and clock of columns, for the lines at a port and for the head of a file.

A column is a yaw rate only if a label, a unit or known firmware says so. Its unit is given only if it is written, or if
the numbers exclude all others. Anything else is a question to the user: the behavior of numbers may identify a clock or
an acceleration, but never a rate.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import log, pi, sqrt
from statistics import fmean

from gyrodrift.columns.behavior import (
    angle_per_rate,
    lengths_of,
    step_of,
)
from gyrodrift.columns.fields import is_whole
from gyrodrift.columns.keys import has_two_senders, keys_of
from gyrodrift.columns.names import (
    BRACKETED,
    SPOKEN,
    USED,
    SeenColumn,
    kind_of,
    quaternion_of,
)
from gyrodrift.columns.naming import rules, seen_columns, stated_clock_unit, time_unit
from gyrodrift.columns.rate_unit import DEGREES_OF_FREEDOM, NOISE_DPS, NOISE_SCALE, SURE_ODDS, student
from gyrodrift.columns.shape import MOST_DPS
from gyrodrift.columns.sizes import TEMPERATURES_C, gravity_unit, is_gravity
from gyrodrift.columns.spec import ANGLE_DEG, CLOCK_UNITS_US, CLOCK_US, IGNORED, RATE_DPS, SELECTED, spec_text
from gyrodrift.columns.times import (
    ClockReader,
    is_hms,
)
from gyrodrift.columns.turn.scale import scale_of
from gyrodrift.columns.units import TURNS_OR_RADIANS, Dimension, unit_in
from gyrodrift.values.constants import FULL_TURN_DEG

UNKNOWN_UNIT = "UNIT"
"""Placeholder in a SPEC for a unit that the user must give."""

UNKNOWN_CLOCK = f"t_{UNKNOWN_UNIT}"
SENDERS = re.compile(
    r"\b(node|device|dev|sensor|imu|mac|addr(ess)?|host|source|sender|client|station)\b", re.IGNORECASE
)
"""Words of a label that names who sent a row."""

UNKNOWN_SENDER = "WHICH"
"""Placeholder for the value of a column that names the sender of its row."""

RATE_UNITS = "dps, rads, mdps or lsb/N"
TURNING = ("rate", "delta", "yaw", "q.w")
"""Entries that say how the device turns."""

UNIT_FACTOR = 1.6
"""Largest factor between a clock and the arrival of its lines: timers tick in halves and tenths of a unit, too."""

MICROSECONDS_FROM = 400.0
"""Without arrival times, a step of at least this is in µs (2.5 kHz), a smaller one in ms (2.5 Hz)."""

USUAL_HZ = (1.0, 10_000.0)
"""Sample rates that a logger writes, from a sample per second to more than the 8 kHz of a flight controller."""

SI_ODDS = 10.0
"""Odds of rad/s if accelerations are in m/s²; a conservative guess that is never decisive alone.

Adafruit Unified Sensor and ROS use m/s² with rad/s, ESPHome and BNO055 with deg/s.
"""

IN_PARTS = re.compile(r"[*×]\s?\d|\bx\s?10|\d\s?[*×]", re.IGNORECASE)
"""Factor of a value in its label: `deg/s x10`, `gz*100`."""

RATES, FORCES = ("gx", "gy", "rate"), ("ax", "ay", "az")
IMU_RATE, IMU_FORCE = re.compile(r"(?:^|\.)angular_velocity\.z$"), re.compile(r"(?:^|\.)linear_acceleration\.z$")
"""Labels in a sensor_msgs/Imu as JSON; its rates are in rad/s (common_interfaces of ROS)."""

SAME_SCALE = 0.1
"""Largest relative difference of a rate and an angle of the same device that a filter and a bias may cause."""

SAMPLES_MIN = 20
GRAVITY_WITHIN = 0.1
ALWAYS = (0.1, 0.5, 0.9)
"""Quantiles of the length: gravity is constant, and a turn of 1 rad/s is not."""

CELSIUS = re.compile(r"(°|º|deg|degrees?)?\s*c(elsius)?", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class JudgedColumn:
    """Verdict on a column.

    looks_like
        Name such as `t_ms` or `gx`; IGNORED if it is not a known quantity.
    entry
        Entry for `--columns`; IGNORED if it is not used.
    why
        Reason.
    is_stated
        Whether label, unit or firmware state meaning and unit, so that no number had to be interpreted.
    missing
        Text that the user has to write for a placeholder in the entry; empty without a placeholder.
    """

    looks_like: str
    entry: str
    why: str
    is_stated: bool = False
    missing: str = ""


@dataclass(frozen=True, slots=True)
class ColumnVerdict:
    """Verdict on the columns of a text.

    labels
        Label per column; empty if columns are identified by position.
    question
        What a person has to decide between columns; empty otherwise.
    """

    columns: tuple[JudgedColumn, ...]
    labels: tuple[str, ...] = ()
    question: str = ""

    @property
    def turn(self) -> JudgedColumn | None:
        """Column of the rate or of yaw; None if unknown."""
        turns = (column for column in self.columns if column.entry.startswith(TURNING))
        return None if self.question else next(turns, None)

    @property
    def clock(self) -> JudgedColumn | None:
        """Column of the clock; None if there is none."""
        return next((column for column in self.columns if column.entry.startswith(("t_", "t:", "dt_"))), None)

    @property
    def is_unit_known(self) -> bool:
        """Whether the units of the turning column and of the clock, and the sender, are known."""
        return self.turn is not None and not self.missing

    @property
    def missing(self) -> tuple[str, ...]:
        """Text for each placeholder in the template, such as `UNIT by deg or rad`."""
        words = (UNKNOWN_CLOCK, UNKNOWN_SENDER, UNKNOWN_UNIT)
        pairs = (
            (next((word for word in words if word in column.entry), ""), column.missing) for column in self.columns
        )
        return tuple(f"{word} by {missing}" for word, missing in pairs if word)

    @property
    def reasons(self) -> str:
        """Reason for each column that is used, for a message."""
        return "; ".join(f"{column.looks_like} {column.why}" for column in self.columns if column.entry != IGNORED)

    @property
    def is_stated(self) -> bool:
        """Whether clock and turning column are stated, so that nobody needs to be asked."""
        return all(column is not None and column.is_stated for column in (self.turn, self.clock))

    @property
    def spec(self) -> str | None:
        """SPEC for `--columns`; None if information is missing."""
        return self.template if self.is_unit_known else None

    @property
    def template(self) -> str | None:
        """SPEC with UNKNOWN_UNIT for a missing unit; None if no column is a rate or yaw."""
        return None if self.turn is None else spec_text([column.entry for column in self.columns], self.labels)


def judged(
    labels: Sequence[str],
    units: Sequence[str],
    texts_by_column: Sequence[Sequence[str]],
    lines_per_s: float | None = None,
    spec_labels: tuple[str, ...] = (),
) -> ColumnVerdict:
    """Verdict on the columns of a text.

    Parameters
    ----------
    labels, units
        Label of each column, and the unit that stands after its values; both may be empty.
    texts_by_column
        Texts of each column, one per row.
    lines_per_s
        Rate of the lines, which gives the unit of a clock; None if it is unknown.
    spec_labels
        Labels by which a SPEC can name the columns; empty if only their position does.
    """
    keyed = {index: keys for index, texts in enumerate(texts_by_column) if (keys := _keys(labels[index], texts))}
    if not keyed:
        return replace(_judged_rows(labels, units, texts_by_column, lines_per_s), labels=spec_labels)
    key, senders = next(iter(keyed.items()))
    gyro = next((sender for sender in senders if kind_of(sender) == "rates"), "")
    kept = [row for row, text in enumerate(texts_by_column[key]) if text == (gyro or senders[0])]
    named = [f"{gyro} {label}" if gyro and len(label) == 1 else label for label in labels]
    pace = lines_per_s * len(kept) / len(texts_by_column[key]) if lines_per_s else None
    verdict = _judged_rows(named, units, [[texts[row] for row in kept] for texts in texts_by_column], pace)
    columns = [replace(column, is_stated=False) for column in verdict.columns]
    why = f"names the rows of the gyro, {gyro}" if gyro else "alternates"
    missing = "" if gyro else f"the sender that you mean ({', '.join(senders)})"
    mark = "" if spec_labels else SELECTED
    columns[key] = JudgedColumn("sender", f"{mark}{gyro or UNKNOWN_SENDER}", why, missing=missing)
    return ColumnVerdict(tuple(columns), spec_labels, verdict.question)


def _keys(label: str, texts: Sequence[str]) -> tuple[str, ...]:
    """Values of a column that names the sender of its row; empty for another column."""
    if kind_of(label) not in {"", "seq"} or unit_in(label) is not None or not all(texts):
        return ()
    return keys_of(texts, is_named=SENDERS.search(label.replace("_", " ")) is not None)


def _judged_rows(
    labels: Sequence[str], units: Sequence[str], texts_by_column: Sequence[Sequence[str]], lines_per_s: float | None
) -> ColumnVerdict:
    columns = seen_columns(labels, units, texts_by_column)
    for rule in rules(lines_per_s):
        rule.name(columns)
    candidates = [_judged(column, lines_per_s, columns) for column in columns]
    verdict = _with_axes(_scaled_by_angle(_one_turn(candidates, columns), columns), columns)
    clock, rate = ([column.numbers for column in columns if column.kind == kind] for kind in ("clock", "rate"))
    if clock and rate and has_two_senders(clock[0], rate[0]):
        return replace(verdict, question="the rows of two senders alternate, and no column says which is which")
    return verdict


def _judged_clock(column: SeenColumn, lines_per_s: float | None) -> JudgedColumn:
    """Unit of a clock from the arrival of its lines, or as written; otherwise it is asked for."""
    step = step_of(column.numbers) if len(column.numbers) > 1 else 0.0
    ticks = ""
    if lines_per_s and step > 0.0:
        ticks = f" (about {step * lines_per_s:.3g} by the arrival of the lines)"
        offsets = {unit: step * scale * 1e-6 * lines_per_s for unit, scale in CLOCK_US.items()}
        unit = next((unit for unit, off in offsets.items() if 1.0 / UNIT_FACTOR < off < UNIT_FACTOR), "")
        if unit:
            why = f"grows by {step:g} per line, and {lines_per_s:.3g} lines arrive per second"
            return JudgedColumn(unit, unit, why)
    if unit := stated_clock_unit(column):
        return JudgedColumn(unit, unit, column.why, is_stated=True)
    if is_hms(column.numbers):
        return JudgedColumn("t:hms", "t:hms", "jumps where a minute ends, so it is HHMMSS")
    is_second = not all(map(is_whole, column.texts)) and step < 2.0
    likely = "t_s" if is_second else "t_us" if step >= MICROSECONDS_FROM else "t_ms"
    units_us = CLOCK_US | {"t:days": CLOCK_UNITS_US["days"]}
    usual = [unit for unit, us in units_us.items() if step and USUAL_HZ[0] <= 1e6 / (step * us) <= USUAL_HZ[1]]
    if len(usual) == 1 and not ticks and not BRACKETED.search(column.label):
        return JudgedColumn(usual[0], usual[0], f"grows by {step:g} per line, which is a sample rate in this unit only")
    units = f"{', '.join(CLOCK_US)}, t:days or t:lsb/N, N ticks a second{ticks}"
    return JudgedColumn(likely, UNKNOWN_CLOCK, f"grows by {step:g} per line", missing=units)


def _judged(column: SeenColumn, lines_per_s: float | None, columns: Sequence[SeenColumn]) -> JudgedColumn:
    kind, option = column.kind, column.option
    match kind:
        case "clock":
            return _judged_clock(column, lines_per_s)
        case "rate":
            unit, why = (option, "") if option else _rate_unit(column, columns)
            is_stated = bool(option) or (column.unit is not None and column.unit.dimension is Dimension.RATE)
            missing = "" if unit else _asked_unit(column.label)
            return JudgedColumn(SPOKEN[kind], f"rate:{unit or UNKNOWN_UNIT}", f"{column.why}{why}", is_stated, missing)
        case "part":
            unit = (column.is_numeric and time_unit(column)) or "t_s"
            return JudgedColumn(unit, f"+{unit}", column.why, is_stated=True)
        case "step":
            unit = time_unit(column)
            return JudgedColumn(f"d{unit}", f"d{unit}", column.why)
        case "yaw" | "heading" | "encoder" | "delta":
            return _judged_angle(column)
    entry = kind if kind in USED and (kind != "temp" or _is_celsius(column)) else IGNORED
    return JudgedColumn(SPOKEN.get(kind, kind) or IGNORED, entry, column.why)


def _judged_angle(column: SeenColumn) -> JudgedColumn:
    """An angle; a compass is positive clockwise, and a reference needs a unit."""
    kind = column.kind
    unit, why = (column.option, "") if column.option else _angle_unit(column)
    entry = f"{'yaw' if kind == 'heading' else kind}:{unit or UNKNOWN_UNIT}{':-' if kind == 'heading' else ''}"
    is_stated = kind != "delta" and (bool(column.option) or column.unit is not None)
    if kind == "encoder" and not unit:
        return JudgedColumn(kind, IGNORED, column.why)
    return JudgedColumn(kind, entry, f"{column.why}{why}", is_stated, "" if unit else "deg or rad")


def _is_celsius(column: SeenColumn) -> bool:
    """Whether a temperature is in °C: in its range, and in no other unit."""
    word = re.split(r"[\s_(\[]+", column.label.strip().rstrip(")]"))[-1]
    is_other = column.unit is not None and unit_in(column.label) is not None and not CELSIUS.fullmatch(word)
    return not is_other and all(TEMPERATURES_C[0] < number < TEMPERATURES_C[1] for number in column.numbers)


def _rate_unit(column: SeenColumn, columns: Sequence[SeenColumn]) -> tuple[str, str]:
    """Unit for `rate:`, and the reason; empty if unknown."""
    unit = column.unit
    if unit is not None and unit.dimension is Dimension.RATE:
        return unit.option, f", in {unit.option} as labeled"
    if unit is not None:
        return "", ""
    if IMU_RATE.search(column.label) and any(IMU_FORCE.search(other_column.label) for other_column in columns):
        return "rads", ", in rad/s as a sensor_msgs/Imu of ROS"
    if _asked_unit(column.label) != RATE_UNITS:
        return "", ""
    return _rate_unit_by_numbers(column, columns)


def _rate_unit_by_numbers(column: SeenColumn, columns: Sequence[SeenColumn]) -> tuple[str, str]:
    """Unit of a rate that excludes all others, and the reason; empty without one."""
    if max(map(abs, column.numbers)) * RATE_DPS["rads"] > MOST_DPS:
        return "", ""
    rates = _lengths(columns, RATES)
    units_of_length = {gravity_unit(_quantile(rates, share), GRAVITY_WITHIN) for share in ALWAYS} if rates else set()
    if units_of_length in ({"g"}, {"mps2"}):
        return "", ", but the length of the three is that of gravity"
    forces = _lengths(columns, FORCES)
    is_si = bool(forces) and is_gravity(_quantile(forces, 0.5), error=GRAVITY_WITHIN)
    odds = _radian_odds(column) * (SI_ODDS if is_si else 1.0)
    if odds < SURE_ODDS:
        return "", ""
    with_gravity = " next to accelerations in m/s²" if is_si else ""
    return "rads", f", in rad/s: its noise is too small for deg/s{with_gravity}, odds {odds:.0f} to 1"


def _asked_unit(label: str) -> str:
    """Units of a rate that a label leaves open."""
    if TURNS_OR_RADIANS.search(label):
        return "lsb/0.00277778 for turns per second, or rads for radians per second"
    return "lsb/N with N numbers per deg/s, by the factor in its label" if IN_PARTS.search(label) else RATE_UNITS


def _angle_unit(column: SeenColumn) -> tuple[str, str]:
    """Unit for `yaw:` or `encoder:`, and the reason; empty if unknown."""
    if column.unit is not None and column.unit.dimension is Dimension.ANGLE:
        return column.unit.option, f", in {column.unit.option} as labeled"
    if column.unit is None and max(map(abs, column.numbers)) > 2.0 * pi + 0.01:
        return "deg", ", in degrees, since it exceeds 2π"
    return "", ""


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


def _one_turn(candidates: list[JudgedColumn], columns: Sequence[SeenColumn]) -> ColumnVerdict:
    """Keep one column that turns: the stated rate, the only rate, or else an angle, which the device has filtered.

    Of several angles the first is proposed, and nothing is stated. Two rates are a question.
    """
    rates = [index for index, column in enumerate(candidates) if column.entry.startswith(("rate", "delta"))]
    stated = [index for index in rates if candidates[index].is_stated] or rates
    angles = [index for index, column in enumerate(candidates) if column.entry.startswith("yaw")]
    kept = stated if len(stated) == 1 else [] if stated else angles[:1]
    question = ""
    if len(stated) > 1:
        names = " and ".join(columns[index].label or f"column {index + 1}" for index in stated)
        question = f"{names} may each be the yaw rate"
    elif (
        not rates
        and (unnamed := [c.label for c in columns if _is_unnamed_rate(c)])
        and (kept or quaternion_of(columns))
    ):
        kept, question = [], f"{' and '.join(unnamed)} are rates, and nothing says about which axis"
    elif not kept and (parts := quaternion_of(columns)):
        for part, index in parts.items():
            is_stated = columns[index].label[-1:].isalpha()
            why = "is a part of a quaternion" if is_stated else "is a part of a quaternion, if q0 is its scalar"
            candidates[index] = JudgedColumn("quaternion", f"q.{part}", why, is_stated)
    proposed = [
        replace(column, entry=IGNORED) if index in {*rates, *angles} and index not in kept else column
        for index, column in enumerate(candidates)
    ]
    if len(angles) > 1 and kept == angles[:1]:
        proposed[kept[0]] = replace(proposed[kept[0]], is_stated=False)
    return ColumnVerdict(tuple(proposed), question=question)


def _is_unnamed_rate(column: SeenColumn) -> bool:
    return column.is_numeric and not column.kind and column.unit is not None and column.unit.dimension is Dimension.RATE


def _scaled_by_angle(verdict: ColumnVerdict, columns: Sequence[SeenColumn]) -> ColumnVerdict:
    """Take unit and sign of the rate from an angle that turns with it; of a stated rate, the sign from a compass."""
    turn, clock = verdict.turn, verdict.clock
    if turn is None or clock is None or not turn.entry.startswith("rate"):
        return verdict
    rate = columns[verdict.columns.index(turn)]
    t_s = _times_s(verdict, columns)
    for angle in columns:
        if angle.kind not in {"yaw", "heading"} or not angle.is_numeric:
            continue
        unit = _angle_unit(angle)[0] or "rad"  # larger angles than 2π are in degrees
        per_rate = angle_per_rate(rate.numbers, angle.numbers, t_s, FULL_TURN_DEG / ANGLE_DEG[unit])
        scale = scale_of(1.0 / (per_rate * ANGLE_DEG[unit]), 1.0, SAME_SCALE) if per_rate else None
        if scale is not None and scale.is_known:
            sign = ":-" if (per_rate < 0.0) != (angle.kind == "heading") else ""
            if turn.is_stated and (turn.entry == f"rate:{scale.option}{sign}" or angle.kind != "heading"):
                continue
            why = f"{turn.why.partition(',')[0]}, and unit and sign are those with which {angle.label} turns"
            scaled = replace(turn, entry=f"rate:{scale.option}{sign}", why=why, is_stated=False, missing="")
            return replace(verdict, columns=tuple(scaled if column is turn else column for column in verdict.columns))
    return verdict


def _times_s(verdict: ColumnVerdict, columns: Sequence[SeenColumn]) -> Sequence[float]:
    """Times of the lines by their clock; empty if its unit is unknown."""
    pairs = zip(verdict.columns, columns, strict=True)
    is_clock = ("t_", "t:", "+t", "dt_")
    clocks = [(column.entry, source.texts) for column, source in pairs if column.entry.startswith(is_clock)]
    if not clocks or any(UNKNOWN_UNIT in entry for entry, _ in clocks) or len({len(texts) for _, texts in clocks}) > 1:
        return []
    return ClockReader([entry for entry, _ in clocks]).read([texts for _, texts in clocks])


def _with_axes(verdict: ColumnVerdict, columns: Sequence[SeenColumn]) -> ColumnVerdict:
    """Use the rates about x and y too, if all units are known, and the accelerations with them."""
    units = _axis_units(verdict, columns)
    with_axes = [
        replace(column, entry=f"{source.kind}:{units[source.kind]}") if source.kind in units else column
        for column, source in zip(verdict.columns, columns, strict=True)
    ]
    return ColumnVerdict(tuple(with_axes), question=verdict.question)


def _axis_units(verdict: ColumnVerdict, columns: Sequence[SeenColumn]) -> dict[str, str]:
    """Units of the further axes by kind; empty without a rate in a known unit and one column per axis.

    Without a label the unit of an acceleration is that in which its length is gravity.
    """
    unit = verdict.turn.entry.removeprefix("rate:") if verdict.turn and verdict.is_unit_known else ""
    if (unit not in RATE_DPS and not unit.startswith("lsb/")) or unit.endswith(":-"):
        return {}  # a frame that is not counter-clockwise is one that nobody knows here
    rates, forces = ([c for c in columns if c.kind in kinds and c.is_numeric] for kinds in (RATES[:2], FORCES))
    if sorted(column.kind for column in rates) != sorted(RATES[:2]):
        return {}
    if any(column.unit is not None and column.unit.dimension is not Dimension.RATE for column in rates):
        return {}
    units = {column.kind: column.unit.option if column.unit else unit for column in rates}
    force_unit = _force_unit(forces) if sorted(column.kind for column in forces) == sorted(FORCES) else ""
    return units | (dict.fromkeys(FORCES, force_unit) if force_unit else {})


def _force_unit(forces: Sequence[SeenColumn]) -> str:
    """Unit of accelerations by their labels or by gravity; empty if unknown."""
    stated = {
        column.unit.option for column in forces if column.unit and column.unit.dimension is Dimension.ACCELERATION
    }
    if len(stated) == 1:
        return stated.pop()
    lengths = _lengths(forces, FORCES)
    return gravity_unit(_quantile(lengths, 0.5), GRAVITY_WITHIN) if lengths else ""


def _lengths(columns: Sequence[SeenColumn], kinds: Sequence[str]) -> list[float]:
    """Lengths of the vectors of three columns, ascending; empty without one column per kind."""
    three = [column for kind in kinds for column in columns if column.kind == kind]
    return sorted(lengths_of(three)) if len(three) == len(kinds) else []


def _quantile(ascending: Sequence[float], share: float) -> float:
    return ascending[int(share * (len(ascending) - 1))]
