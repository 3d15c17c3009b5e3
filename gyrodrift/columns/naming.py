"""Names of columns: what a text says of them, and what their numbers do, strongest first."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

from gyrodrift.columns.behavior import find_accelerometer, find_temperature, goes_on, grows, step_of
from gyrodrift.columns.fields import DECIMAL_COMMA, is_number
from gyrodrift.columns.names import SeenColumn, kind_of, name_by_known_row, name_by_label, name_by_unit
from gyrodrift.columns.spec import CLOCK_US
from gyrodrift.columns.times import PER_S, counted_unit, epoch_unit, is_date, is_stamp, is_time_of_day
from gyrodrift.columns.units import Dimension, unit_in, unit_of, without_unit

CLOCK_WORDS = re.compile(r"time|elapsed|stamp|clock|zeit|uptime|\btemps\b|tiempo", re.IGNORECASE)
STEP_WORDS = re.compile(
    r"\bdt\b|delta|diff|interval|period|offset|exposure|latency|duration|delay|rtt|\brise\b|response|since last|flight",
    re.IGNORECASE,
)
"""Words of a label that names another time than that of the sample."""

STEP_NAMES = re.compile(r"^d ?t\b|^delta ?t|time (step|delta|diff)|since last|interval", re.IGNORECASE)
"""Labels of the time since the last sample."""

CLOCK_ENDINGS = {
    "t_ms": ("ms", "millis"),
    "t_us": ("us", "micros"),
    "t_ns": ("ns", "nanos"),
    "t_s": ("sec", "seconds"),
}
PARTS_OF_TIME, PARTS_MOST = (
    ("t:lsb/0.000277777778", "t:min", "t_s", "t_ms", "t_us", "t_ns"),
    (24, 60, 61, 1e3, 1e6, 1e9),
)
"""Units of columns that add up to a time of day, and the numbers below which they are. A minute may have 61 seconds."""

LARGEST = 1e19
"""Largest number; nanoseconds since 1970 are smaller, and above it a line is damaged."""

NUMBERS_SHARE = 0.9
"""Smallest share of numbers in the first rows of a column of numbers; the others are damaged."""


def seen_columns(
    labels: Sequence[str], units: Sequence[str], texts_by_column: Sequence[Sequence[str]]
) -> list[SeenColumn]:
    """Columns of a text; `units` stand after the values, and may be empty."""
    columns = []
    for label, unit, texts in zip(labels, units, texts_by_column, strict=True):
        values = _values(texts)
        numbers = tuple(map(float, values)) if values and all(map(is_number, values)) else ()
        is_usable = all(abs(number) < LARGEST for number in numbers)
        columns.append(SeenColumn(label, tuple(values), numbers if is_usable else (), unit_of(unit) or unit_in(label)))
    for column, after in reversed(list(pairwise(columns))):
        if column.unit is None and _head(column.label) == _head(after.label) != "":
            column.unit = after.unit  # `Rotation X: 0.1, Y: 0.2, Z: 0.3 rad/s`
    return columns


def _values(texts: Sequence[str]) -> Sequence[str]:
    """Values with a decimal point, without empty ones and the few that are no number."""
    filled = [text for text in texts if text]
    pointed = [text.replace(",", ".") if DECIMAL_COMMA.fullmatch(text) else text for text in filled]
    numbers = [text for text in pointed if is_number(text) and text.lower().lstrip("+-") not in {"nan", "inf"}]
    return numbers if len(numbers) >= NUMBERS_SHARE * len(pointed) else pointed


def _head(label: str) -> str:
    """Words before the axis of a label."""
    return label.rpartition(" ")[0]


@dataclass(frozen=True, slots=True)
class Rule:
    """A rule that names columns, and why it may: it leaves columns alone that have a name already."""

    name: Callable[[list[SeenColumn]], None]
    why: str


def rules(lines_per_s: float | None) -> tuple[Rule, ...]:
    """All rules, strongest first: what is written comes before what the numbers do."""
    return (
        Rule(name_by_known_row, "Firmware whose lines begin with a known word has fixed columns and units."),
        Rule(name_by_label, "A label names a quantity, unless its unit is one of another quantity."),
        Rule(name_by_unit, "One value in a unit of rates, or three, are rates, unless a label says otherwise."),
        Rule(_unname_counters, "A counter goes on; what alternates or stands is something else."),
        Rule(_name_parts_of_time, "An hour, a minute and a second in columns of their own add up to a clock."),
        Rule(partial(_name_clock, lines_per_s=lines_per_s), "A clock is labeled and goes on, or grows evenly."),
        Rule(find_accelerometer, "Three columns whose length is gravity while they move are an accelerometer."),
        Rule(find_temperature, "The last column without a label, steady at room temperature, is a temperature."),
    )


def _unname_counters(columns: list[SeenColumn]) -> None:
    for column in columns:
        if column.kind == "seq" and not goes_on(column.numbers, None):
            column.kind, column.why = "", ""


def _name_parts_of_time(columns: list[SeenColumn]) -> None:
    """Name the parts of a time of day, the coarsest first; days count only with hours, months only with a date."""
    parts = [(size, column) for column in columns for size in [_part_size(column)] if size >= 0]
    sizes = [size for size, _ in parts]
    rest_columns = [column for column in columns if not any(column is part for _, part in parts)]
    if any(_is_labeled_clock(column) and _goes_on(column, None) for column in rest_columns):
        return
    if len(set(sizes)) < len(sizes) or not {PARTS_OF_TIME.index("t:min"), PARTS_OF_TIME.index("t_s")} <= set(sizes):
        return
    for size, column in sorted(parts, key=lambda part: part[0]):
        column.kind = "clock" if size == min(sizes) else "part"
        column.why = f"is labeled {column.label}"


def _part_size(column: SeenColumn) -> int:
    """Index of a part of a time in PARTS_OF_TIME; -1 for another column. A part is below a whole of the next unit."""
    unit = time_unit(column) if _may_be_clock(column) and column.is_numeric and unit_of(column.label) else ""
    if unit not in PARTS_OF_TIME:
        return -1
    size = PARTS_OF_TIME.index(unit)
    is_last = unit not in {"t:min", PARTS_OF_TIME[0]}
    is_part = all(0.0 <= number < PARTS_MOST[size] and (is_last or number.is_integer()) for number in column.numbers)
    return size if is_part else -1


def _name_clock(columns: list[SeenColumn], lines_per_s: float | None) -> None:
    """Name the clock: of labeled ones that go on, the first with a unit, else the leftmost column that grows evenly."""
    labeled = [column for column in columns if _is_labeled_clock(column)]
    running = [column for column in labeled if _goes_on(column, lines_per_s)]
    clock = next((column for column in running if stated_clock_unit(column)), next(iter(running), None))
    clock = next((column for column in columns if column.kind == "clock"), clock)
    if clock is not None and not clock.kind:
        clock.kind, clock.why = "clock", f"is labeled {clock.label}" if clock.label else "is a time"
        for part in columns:
            if part is not clock and _is_part_of(part, clock):
                part.kind, part.why = "part", f"is the part of {clock.label or 'the clock'} below a second or a day"
    for column in columns:
        if column in labeled or not _may_be_clock(column) or not grows(column.numbers, lines_per_s):
            continue
        step = step_of(column.numbers)
        if step == 1.0 and not (lines_per_s and 850.0 < lines_per_s < 1150.0):
            if not any(other_column.kind == "seq" for other_column in columns):
                column.kind, column.why = "seq", "counts one by one"
        elif clock is None:
            clock = column
            column.kind, column.why = "clock", f"grows by {step:g} with each line"
    steps = [column for column in columns if not column.kind and _is_step(column)]
    if clock is None and len(steps) == 1:
        steps[0].kind, steps[0].why = "step", f"is labeled {steps[0].label}"


def _is_step(column: SeenColumn) -> bool:
    """Whether a column is the time since the last line, as its label and its unit say."""
    name = without_unit(column.label).replace("_", " ")
    is_unit = time_unit(column) in CLOCK_US
    return is_unit and STEP_NAMES.search(name) is not None and column.is_numeric and min(column.numbers) >= 0.0


def _is_part_of(part: SeenColumn, clock: SeenColumn) -> bool:
    """Whether a column is a time of day beside dates, or a fraction of a second beside whole seconds."""
    if _is_of(is_date, clock):
        return _is_of(is_time_of_day, part)
    unit = "" if part.kind else time_unit(part)
    if unit not in PER_S or not part.is_numeric or min(part.numbers) < 0.0 or max(part.numbers) >= PER_S[unit]:
        return False
    return len(set(clock.texts)) < 0.5 * len(clock.texts) and not any("." in text for text in clock.texts)


def _is_of(form: Callable[[str], bool], column: SeenColumn) -> bool:
    return bool(column.texts) and all(map(form, column.texts))


def _may_be_clock(column: SeenColumn) -> bool:
    """Whether neither unit nor label say another quantity, or another time."""
    if column.kind or STEP_WORDS.search(without_unit(column.label).replace("_", " ")):
        return False
    return column.unit is None or column.unit.dimension is Dimension.TIME


def _is_labeled_clock(column: SeenColumn) -> bool:
    if not _may_be_clock(column):
        return False
    name = without_unit(column.label)
    is_named = "clock" in (kind_of(name), kind_of(column.label)) or CLOCK_WORDS.search(name) is not None
    return (is_named and column.is_numeric) or (bool(column.texts) and all(map(is_stamp, column.texts)))


def _goes_on(column: SeenColumn, lines_per_s: float | None) -> bool:
    if not column.is_numeric:
        return len(set(column.texts)) > 1
    return goes_on(column.numbers, lines_per_s) or bool(counted_unit(column.texts))


def time_unit(column: SeenColumn) -> str:
    """Entry of a clock in the unit of a label; empty without a unit of time."""
    unit = column.unit or unit_of(column.label)
    return unit.option if unit is not None and unit.dimension is Dimension.TIME else ""


def stated_clock_unit(column: SeenColumn) -> str:
    """Unit of a clock as written; empty without one."""
    if all(map(is_stamp, column.texts)):
        return "t_s"
    if column.unit is not None or unit_of(column.label) is not None:
        return time_unit(column)
    plain = re.sub(r"[\s_]", "", column.label.lower())
    named = (option for option, endings in CLOCK_ENDINGS.items() if plain.isalpha() and plain.endswith(endings))
    return next(named, "") or epoch_unit(column.texts)
