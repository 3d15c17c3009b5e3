"""Which columns of a table are taken as what: as a person says, as a known head has it, or as labels say with unit."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

from gyrodrift.columns.names import kind_of
from gyrodrift.columns.spec import ANGLE_DEG, CLOCK_US, IGNORED, RATE_DPS, Column
from gyrodrift.columns.units import Dimension, Unit, unit_in, unit_of, without_unit
from gyrodrift.errors import DataError, UsageError
from gyrodrift.session.csv import COLUMNS, OLD_NAMES
from gyrodrift.session.tables.known import KNOWN, NOTHING, label_index
from gyrodrift.session.tables.times import epoch_unit, is_time

OWN, BY_COLUMNS, BY_LABELS = "gyrodrift", "--columns", "labels with units"
TARGETS = {
    "rate": "rate_dps",
    "yaw": "yaw_deg",
    "encoder": "encoder_deg",
    "temp": "temp_c",
    "seq": "seq",
    "still": "still",
}
"""Columns of a session by the meanings of a SPEC; others are not used yet."""

CLOCK_WORDS = re.compile(r"time|elapsed|stamp|clock|zeit|uptime|\btemps\b|tiempo", re.IGNORECASE)
STEP_WORDS = re.compile(
    r"\bdt\b|delta|diff|interval|period|offset|exposure|latency|duration|delay|rtt|\brise\b|response|since last|flight",
    re.IGNORECASE,
)
CLOCKWISE = re.compile(r"heading|azimuth|compass|bearing|course|\bhdg\b|\bcog\b", re.IGNORECASE)
RATES = {"rate", "rates"}
"""Kinds of a label that name the vertical axis, or no axis: of the latter one with a unit of rates is the rate."""

BACKWARDS = 0.1
"""Steps back that a clock may have: restarts, and rows in another order."""

NUMBER_BEGINS = re.compile(r"[-+]?[.,]?\d")
QUATERNION = re.compile(r"(?:.*[\s._])?q(?:uat(?:ernion)?)?[\s._]?([wxyz])", re.IGNORECASE)
AIMS = re.compile(r"target|set_?point|desired|cmd|command|(?<![a-z])(sp|ref|goal)(?![a-z])", re.IGNORECASE)
"""A quaternion of these is where the device should point, not where it does."""

CELSIUS = re.compile(r"(°|º|deg|degrees?)?\s*c(elsius)?", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Taken:
    """A column that is taken.

    target
        Column of a session that it becomes, or `yaw_deg`.
    scale
        Factor to the unit of that column; 1 of a clock.
    unit
        Unit of a clock, `t_us`.
    """

    index: int
    target: str
    scale: float = 1.0
    unit: str = ""


@dataclass(frozen=True, slots=True)
class TableColumns:
    """How a table is read.

    form
        Known head, or how else the columns were found.
    where
        Index and value of the rows that are taken; None for all.
    remarks
        What a person is to be told, a sentence each.
    """

    form: str
    taken: tuple[Taken, ...]
    where: tuple[int, str] | None = None
    remarks: tuple[str, ...] = ()

    @property
    def targets(self) -> set[str]:
        """Columns of a session that are there."""
        return {each.target for each in self.taken}


@dataclass(frozen=True, slots=True)
class Head:
    """What is known of a table before it is read.

    labels
        One a column, empty where there is none; an empty tuple for a table without a header.
    line
        Number of the header's line, 0 without.
    preamble
        Pairs before the header.
    rows
        Rows of the beginning, for what their values tell.
    """

    path: Path
    labels: tuple[str, ...]
    width: int
    line: int
    rows: tuple[Sequence[str], ...]
    preamble: Mapping[str, str] = field(default_factory=lambda: NOTHING)

    def texts(self, index: int) -> list[str]:
        """The cells of a column in those rows, without empty ones."""
        cells = (row[index].strip() for row in self.rows if index < len(row))
        return [cell for cell in cells if cell]


def columns_by_spec(head: Head, columns: Sequence[Column]) -> TableColumns:
    """As a person says.

    Raises
    ------
    UsageError
        Where the table has no such columns, or none is a clock.
    """
    placed = [(_index(head, place, column), column) for place, column in enumerate(columns)]
    taken = tuple(_taken(index, column) for index, column in placed if _is_used(column))
    found = {each.target for each in taken}
    if "t_device_s" not in found:
        raise UsageError(f"--columns: {head.path}: no column is the clock: one of {', '.join(CLOCK_US)}")
    remarks = (*_yaw_remarks(found, ""), *_contradicted(head, columns, taken))
    return _with_labelled_unit(head, TableColumns(BY_COLUMNS, taken, remarks=remarks), columns)


def _with_labelled_unit(head: Head, found: TableColumns, columns: Sequence[Column]) -> TableColumns:
    """A rate without a unit in the SPEC has that of its label, where that names one."""
    rate = next((column for column in columns if column.meaning == "rate"), None)
    if rate is None or rate.unit or not head.labels:
        return found
    taken = [_in_unit(head, each) if each.target == "rate_dps" else each for each in found.taken]
    return TableColumns(found.form, tuple(taken), found.where, found.remarks)


def _contradicted(head: Head, columns: Sequence[Column], taken: Sequence[Taken]) -> tuple[str, ...]:
    """What a label says of the unit of the rate, where a person says something else, who is believed."""
    said = next((column.unit for column in columns if column.meaning == "rate"), "")
    at = next((each.index for each in taken if each.target == "rate_dps"), len(head.labels))
    unit = unit_in(head.labels[at]) if said and at < len(head.labels) else None
    if unit is None or unit.dimension is not Dimension.RATE or unit.option == said:
        return ()
    return (f"its label {head.labels[at]!r} says {unit.option}, --columns says {said}, which is taken",)


def _in_unit(head: Head, rate: Taken) -> Taken:
    unit = unit_in(head.labels[rate.index]) if rate.index < len(head.labels) else None
    factor = rate_factor(unit) if unit else None
    return rate if factor is None else Taken(rate.index, rate.target, rate.scale * factor)


def _is_used(column: Column) -> bool:
    return column.meaning in TARGETS or column.meaning in CLOCK_US


def _index(head: Head, place: int, column: Column) -> int:
    if not column.label:
        if place >= head.width and column.meaning != IGNORED:
            raise UsageError(
                f"--columns: {head.path}: has {head.width} columns, and {column.meaning} is the {place + 1}th"
            )
        return place
    index = label_index(head.labels, column.label)
    if index is None:
        there = ", ".join(head.labels) or "no header"
        raise UsageError(
            f"--columns: {head.path}: no column, or more than one, is called {column.label!r}; there are {there}"
        )
    return index


def _taken(index: int, column: Column) -> Taken:
    if column.meaning in CLOCK_US:
        return Taken(index, "t_device_s", unit=column.meaning)
    return Taken(index, TARGETS[column.meaning], column.scale)


def own_columns(head: Head) -> TableColumns | None:
    """A session of ours, by its names; None where the header has none that it needs."""
    labels = [label.strip() for label in head.labels]
    names = [OLD_NAMES.get(label, label) if OLD_NAMES.get(label) not in labels else label for label in labels]
    if not {"t_device_s", "rate_dps"} <= set(names):
        return None
    twice = next((name for name in COLUMNS if names.count(name) > 1), None)
    if twice:
        raise DataError(f"{head.path}:{head.line}: column {twice} stands twice; columns are {', '.join(COLUMNS)}")
    taken = [Taken(index, name, unit="t_s" if name == "t_device_s" else "") for index, name in enumerate(names)]
    return TableColumns(OWN, tuple(each for each in taken if each.target in COLUMNS))


def known_columns(head: Head) -> TableColumns | None:
    """By a head that is known; None where it is none of them."""
    for known in KNOWN:
        placed = known.indices(head.path, head.labels)
        scale = known.scale(head.preamble) if placed is not None else None
        if placed is None or scale is None:
            continue
        taken = [_taken(index, column) for index, column in placed if _is_used(column)]
        scaled = tuple(
            Taken(each.index, each.target, each.scale * scale) if each.target == "rate_dps" else each for each in taken
        )
        at = label_index(head.labels, known.where[0]) if known.where else None
        where = (at, known.where[1]) if known.where and at is not None else None
        remarks = (known.remark,) if known.remark else ()
        return _stamped(head, TableColumns(known.name, scaled, where, remarks))
    return None


def _stamped(head: Head, found: TableColumns) -> TableColumns:
    """`rostopic echo -p` has the time of the message too, which counts where it runs."""
    stamp = label_index(head.labels, "field.header.stamp")
    if found.form != "rostopic echo -p" or stamp is None:
        return found
    if len(set(head.texts(stamp))) < 2:
        said = "its header.stamp does not run, so the time at which each message came is taken (%time)"
        return TableColumns(found.form, found.taken, found.where, (said,))
    taken = [Taken(stamp, each.target, unit="t_ns") if each.target == "t_device_s" else each for each in found.taken]
    return TableColumns(found.form, tuple(taken), found.where)


def rate_factor(unit: Unit) -> float | None:
    """Factor of a unit to deg/s; None where it is none of a rate."""
    if unit.dimension is not Dimension.RATE:
        return None
    return 1.0 / float(unit.option.removeprefix("lsb/")) if unit.option.startswith("lsb/") else RATE_DPS[unit.option]


def labelled_columns(head: Head) -> TableColumns | None:
    """By labels that say what a column is and in which unit; None where there is no clock, or not one rate (or yaw)."""
    clocks = [Taken(index, "t_device_s", unit=unit) for index, unit in _clocks(head)]
    rates = [each for index in range(len(head.labels)) if (each := _rate(head, index))]
    yaws = [each for index in range(len(head.labels)) if (each := _yaw(head, index))]
    quaternion = _quaternion(head)
    if not clocks or len(rates) > 1 or (not rates and len(yaws) != 1 and not (quaternion and not yaws)):
        return None
    running = [clock for clock in clocks if _goes_on(head.texts(clock.index))] or clocks
    moved = rates or yaws or quaternion
    taken = (running[0], *moved, *_temperature(head))
    remarks = _yaw_remarks({each.target for each in moved}, head.labels[moved[0].index])
    return TableColumns(BY_LABELS, taken, remarks=remarks)


def _clocks(head: Head) -> list[tuple[int, str]]:
    found = ((index, clock_unit(label, head.texts(index))) for index, label in enumerate(head.labels))
    return [(index, unit) for index, unit in found if unit]


def _goes_on(texts: Sequence[str]) -> bool:
    """Whether a clock changes, and hardly ever back: `response time (ms)` does not."""
    if len(set(texts)) < 2 or not all(map(NUMBER_BEGINS.match, texts)) or any(map(is_time, texts)):
        return len(set(texts)) > 1
    try:
        numbers = [float(text.replace(",", ".")) for text in texts]
    except ValueError:
        return True
    return sum(after < before for before, after in pairwise(numbers)) <= BACKWARDS * len(numbers)


def clock_unit(label: str, texts: Sequence[str]) -> str:
    """The unit of a clock as a SPEC calls it; empty for a column that is none, or does not say its unit."""
    unit, name = unit_in(label) or unit_of(label), without_unit(label)
    is_clock = kind_of(name) == "clock" or kind_of(label) == "clock" or CLOCK_WORDS.search(name)
    if not is_clock or STEP_WORDS.search(name.replace("_", " ")) or not texts:
        return ""
    if all(map(is_time, texts)):
        return "t_s"
    if unit is not None:
        return unit.option if unit.dimension is Dimension.TIME else ""
    return epoch_unit(texts)


def _rate(head: Head, index: int) -> Taken | None:
    label = head.labels[index]
    unit = unit_in(label)
    factor = rate_factor(unit) if unit else None
    is_rate = bool({kind_of(without_unit(label)), kind_of(label)} & RATES)
    has_numbers = any(map(NUMBER_BEGINS.match, head.texts(index)))
    return Taken(index, "rate_dps", factor) if factor is not None and is_rate and has_numbers else None


def _yaw(head: Head, index: int) -> Taken | None:
    label = head.labels[index]
    unit, name = unit_in(label), without_unit(label)
    if unit is None or unit.dimension is not Dimension.ANGLE:
        return None
    kind = kind_of(name)
    if kind not in {"yaw", "heading"}:
        return None
    return Taken(index, "yaw_deg", ANGLE_DEG[unit.option] * (-1.0 if kind == "heading" else 1.0))


def _quaternion(head: Head) -> list[Taken]:
    """The four parts of the one quaternion; none where there are others."""
    labels = ["" if AIMS.search(label) else label.strip() for label in head.labels]
    found = [(QUATERNION.fullmatch(label), index) for index, label in enumerate(labels)]
    parts = {part[1].lower(): index for part, index in found if part}
    is_one = len(parts) == 4 and sum(part is not None for part, _ in found) == 4
    return [Taken(parts[axis], f"q{axis}") for axis in "wxyz"] if is_one else []


def _yaw_remarks(targets: set[str], label: str) -> tuple[str, ...]:
    if not targets & {"yaw_deg", "qw"}:
        return ()
    turned = ", and its sign is turned (clockwise)" if label and CLOCKWISE.search(label) else ""
    return (f"its rate is the difference of an angle{turned}: the device's own filter has been at work",)


def _temperature(head: Head) -> list[Taken]:
    for index, label in enumerate(head.labels):
        unit = unit_in(label)
        if unit is not None and unit.dimension is Dimension.TEMPERATURE and kind_of(without_unit(label)) == "temp":
            word = re.split(r"[\s_(\[]+", label.strip().rstrip(")]"))[-1]
            if CELSIUS.fullmatch(word):
                return [Taken(index, "temp_c")]
    return []
