"""Meaning of the columns of a table: stated by the user, of a known form, or by labels with units."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise, takewhile
from pathlib import Path

from gyrodrift.columns.fields import as_label
from gyrodrift.columns.judge import ColumnVerdict, judged
from gyrodrift.columns.names import kind_of
from gyrodrift.columns.naming import CLOCK_WORDS
from gyrodrift.columns.spec import (
    ACCELERATION_MPS2,
    AID_MEANINGS,
    ANGLE_DEG,
    CLOCK_US,
    IGNORED,
    QUATERNION,
    RATE_DPS,
    SELECTED,
    Column,
    column_of,
    spec_text,
)
from gyrodrift.columns.times import ClockReader
from gyrodrift.columns.units import Dimension, Unit, unit_in, unit_of, without_unit
from gyrodrift.session.csv import MOST_COLUMNS, present_names
from gyrodrift.session.session import ACCEL_COLUMNS, COLUMNS
from gyrodrift.session.tables.known import KNOWN_TABLES, NOTHING, bare, label_index, plain
from gyrodrift.values.errors import DataError, UsageError

OWN, BY_COLUMNS, BY_LABELS = "gyrodrift", "--columns", "labels with units"
TARGETS = {
    "rate": "rate_dps",
    "yaw": "yaw_deg",
    "delta": "delta_deg",
    **{name: name.replace(".", "") for name in QUATERNION},
    "encoder": "encoder_deg",
    "temp": "temp_c",
    "seq": "seq",
    "still": "still",
    "gx": "gyro_x_dps",
    "gy": "gyro_y_dps",
    "ax": "accel_x_mps2",
    "ay": "accel_y_mps2",
    "az": "accel_z_mps2",
    **{name: name for name in AID_MEANINGS},
}
"""Columns of a session by the meanings of a SPEC."""

RATE_TARGETS = frozenset({"rate_dps", "gyro_x_dps", "gyro_y_dps"})
FORCE_TARGETS = frozenset(ACCEL_COLUMNS)
ANGLE_TARGETS = frozenset({"yaw_deg", "delta_deg", "encoder_deg"})

QUATERNION_REMARK = (
    "its rate is the difference of the yaw of a quaternion, counter-clockwise if z points up; if z points down (NED, as"
    " of AirSim and PX4), state --flip"
)
WORDS = re.compile(r"(?<=[_. ])")
LAST_BRACKETS = re.compile(r"(?<!\s)\s*+[(\[][^()\[\]]*[)\]]$")
ROWS_MIN, BACKWARD_SHARE = 10, 0.95
"""Least number of rows, and share of the steps, that show the direction of a clock."""

LABELS_MIN = 3
"""Least number of labels whose common words name the device."""


@dataclass(frozen=True, slots=True)
class UsedColumn:
    """A column that is used.

    target
        Column of a session, or what its rate is made of: `yaw_deg`, `delta_deg`, `qw`; a clock may have several.
    scale
        Factor to the unit of the session; 1 for a clock.
    unit
        Entry of a clock, such as `t_us`, `dt_ms` or `t:days`.
    entry
        Entry of a SPEC; empty for a known form.
    """

    index: int
    target: str
    scale: float = 1.0
    unit: str = ""
    entry: str = ""


@dataclass(frozen=True, slots=True)
class TableColumns:
    """How a table is read.

    form
        Known form, or how the columns were found.
    where
        Indices and values of the rows to use; empty for all.
    remarks
        Notes for the user, a sentence each.
    aids
        Columns of second sources.
    """

    form: str
    used: tuple[UsedColumn, ...]
    where: tuple[tuple[int, str], ...] = ()
    remarks: tuple[str, ...] = ()
    aids: tuple[Column, ...] = ()

    @property
    def targets(self) -> set[str]:
        """Columns of a session that the table has."""
        return {column.target for column in self.used}

    @property
    def read_indices(self) -> set[int]:
        """Indices of the columns whose cells are read."""
        return {column.index for column in self.used} | {index for index, _ in self.where}


@dataclass(frozen=True, slots=True)
class Head:
    """Beginning of a table.

    labels
        A label per column, maybe empty; an empty tuple for a table without a header.
    line
        Line number of the header, 0 without a header.
    preamble
        Keys and values before the header.
    rows
        First rows, whose values help to recognize columns.
    """

    path: Path
    labels: tuple[str, ...]
    width: int
    line: int
    rows: tuple[Sequence[str], ...]
    preamble: Mapping[str, str] = field(default_factory=lambda: NOTHING)

    def texts(self, index: int) -> list[str]:
        """Non-empty cells of a column in the first rows."""
        cells = (row[index].strip() for row in self.rows if index < len(row))
        return [cell for cell in cells if cell]


def columns_by_spec(head: Head, columns: Sequence[Column], *, needs_clock: bool = True) -> TableColumns:
    """Columns as the user states them; a clock is needed unless the user states the sample rate.

    Raises
    ------
    UsageError
        The table does not have these columns, or none is a clock.
    """
    is_selected = any(column.meaning == SELECTED for column in columns)
    width = MOST_COLUMNS if is_selected else head.width  # rows of a kind may be wider than most rows
    placed = [(_index(head, position, column, width), column) for position, column in enumerate(columns)]
    taken = tuple(_taken(index, column) for index, column in placed if _is_used(column))
    targets = {column.target for column in taken}
    if needs_clock and "t_device_s" not in targets:
        clocks = f"one of {', '.join(CLOCK_US)}; if there is none, state the sample rate with --sample-rate HZ"
        raise UsageError(f"--columns: {head.path}: no column is the clock: {clocks}")
    where = tuple((index, column.unit) for index, column in placed if column.meaning == SELECTED)
    remarks = (*_yaw_remarks(targets, ""), *_contradicted(head, columns, taken))
    aids = tuple(column for column in columns if column.meaning in AID_MEANINGS)
    return _with_labelled_unit(head, TableColumns(BY_COLUMNS, taken, where, remarks, aids), columns)


def _with_labelled_unit(head: Head, table_columns: TableColumns, columns: Sequence[Column]) -> TableColumns:
    """Give columns without a unit in the SPEC the unit of their label, if the label names one."""
    unstated = {TARGETS[given.meaning] for given in columns if given.meaning in TARGETS and not given.unit}
    if not head.labels:
        return table_columns
    taken = [_in_unit(head, used) if used.target in unstated else used for used in table_columns.used]
    return replace(table_columns, used=tuple(taken))


def _contradicted(head: Head, columns: Sequence[Column], taken: Sequence[UsedColumn]) -> tuple[str, ...]:
    """Note that the label names another unit than the user; the user's unit is used."""
    stated = next((column.unit for column in columns if column.meaning == "rate"), "")
    index = next((used.index for used in taken if used.target == "rate_dps"), len(head.labels))
    unit = unit_in(head.labels[index]) if stated and index < len(head.labels) else None
    if unit is None or unit.dimension is not Dimension.RATE or unit.option == stated:
        return ()
    return (f"its label {head.labels[index]!r} says {unit.option}; the unit of --columns, {stated}, is used",)


def _in_unit(head: Head, used: UsedColumn) -> UsedColumn:
    """Column in the unit of its label; the same column if that is no unit of rates, angles and accelerations."""
    unit = unit_in(head.labels[used.index]) if used.index < len(head.labels) else None
    factor = None
    if unit is not None and used.target in RATE_TARGETS | {"turn_rate"}:
        factor = rate_factor(unit)
    elif unit is not None and used.target in FORCE_TARGETS and unit.dimension is Dimension.ACCELERATION:
        factor = ACCELERATION_MPS2.get(unit.option)
    elif unit is not None and used.target in ANGLE_TARGETS | {"heading"} and unit.dimension is Dimension.ANGLE:
        factor = ANGLE_DEG.get(unit.option)
    return used if factor is None else replace(used, scale=used.scale * factor)


def _is_used(column: Column) -> bool:
    return column.meaning in TARGETS or bool(column.clock)


def _index(head: Head, position: int, column: Column, width: int) -> int:
    if not column.label:
        if position >= width and column.meaning != IGNORED:
            name = f"{column.meaning}{column.unit}" if column.meaning == SELECTED else column.meaning
            raise UsageError(f"--columns: {head.path}: has {head.width} columns, and {name} is the {position + 1}th")
        return position
    index = label_index(head.labels, column.label)
    if index is None:
        labels = ", ".join(head.labels) or "no header"
        raise UsageError(
            f"--columns: {head.path}: no column, or more than one, is called {column.label!r}; there are {labels}"
        )
    return index


def _taken(index: int, column: Column) -> UsedColumn:
    if column.clock:
        return UsedColumn(index, "t_device_s", unit=column.clock, entry=column.entry)
    return UsedColumn(index, TARGETS[column.meaning], column.scale, entry=column.entry)


def spec_of(head: Head, table_columns: TableColumns, changes: Mapping[int, str]) -> str:
    """SPEC of the columns that are used, with other entries for some; a value selects the rows that have it."""
    labels = head.labels if len(set(head.labels)) == len(head.labels) else ()
    entries = {column.index: column.entry for column in table_columns.used}
    entries |= {index: value if labels else f"{SELECTED}{value}" for index, value in table_columns.where}
    entries |= changes
    return spec_text([entries.get(index, IGNORED) for index in range(head.width)], [as_label(text) for text in labels])


def is_newest_first(head: Head, columns: Sequence[Column] | None) -> bool:
    """Whether the only clocks, as stated or labeled, go back from row to row."""
    if columns is None:
        clocks = [i for i, label in enumerate(head.labels) if kind_of(label) == "clock" or CLOCK_WORDS.search(label)]
    else:
        named = (label_index(head.labels, c.label) if c.label else i for i, c in enumerate(columns) if c.clock)
        clocks = [index for index in named if index is not None]
    directions = [direction for index in clocks if (direction := _direction(head.texts(index)))]
    return bool(directions) and max(directions) < 0


def _direction(texts: Sequence[str]) -> int:
    """1 for times that go on, -1 for times that go back, 0 for others."""
    try:
        t_s = ClockReader(["t_s"]).read([texts]) if len(texts) >= ROWS_MIN else []
    except ValueError:
        return 0
    steps = [after - before for before, after in pairwise(t_s)]
    forward, backward = sum(step > 0.0 for step in steps), sum(step < 0.0 for step in steps)
    moved = BACKWARD_SHARE * (forward + backward)
    return 0 if not t_s else 1 if forward > moved else -1 if backward > moved else 0


def own_columns(head: Head) -> TableColumns | None:
    """Columns of a session of this program; None if the header lacks a required name."""
    names = present_names([label.strip() for label in head.labels])
    if not {"t_device_s", "rate_dps"} <= set(names):
        return None
    twice = next((name for name in COLUMNS if names.count(name) > 1), None)
    if twice:
        raise DataError(f"{head.path}:{head.line}: column {twice} occurs twice; columns are {', '.join(COLUMNS)}")
    taken = [UsedColumn(index, name, unit="t_s" if name == "t_device_s" else "") for index, name in enumerate(names)]
    return TableColumns(OWN, tuple(column for column in taken if column.target in COLUMNS))


def known_columns(head: Head) -> TableColumns | None:
    """Columns of a known form of table; None if it has no known form."""
    for form in KNOWN_TABLES:
        placed = form.indices(head.path, head.labels)
        scale, clock = form.scale(head.preamble), form.clock_unit(head.preamble)
        if placed is None or scale is None or clock is None:
            continue
        taken = [_taken(index, spec_column) for index, spec_column in placed if _is_used(spec_column)]
        taken += [_taken(index, spec_column) for index, spec_column in form.axis_indices(head.labels)]
        taken = [replace(column, unit=clock) if clock and column.unit else column for column in taken]
        scaled = _scaled(taken, scale, form.force_scale(head.preamble))
        index = label_index(head.labels, form.where[0]) if form.where else None
        where = ((index, form.where[1]),) if form.where and index is not None else ()
        remarks = (form.remark,) if form.remark else ()
        return _stamped(head, TableColumns(form.name, scaled, where, remarks))
    return None


def _scaled(taken: Sequence[UsedColumn], rate_scale: float, force_scale: float | None) -> tuple[UsedColumn, ...]:
    """Columns with the scales of the preamble; without accelerations if theirs is unknown."""
    scales = {**dict.fromkeys(RATE_TARGETS, rate_scale), **dict.fromkeys(FORCE_TARGETS, force_scale)}
    return tuple(
        replace(column, scale=column.scale * scale)
        for column in taken
        if (scale := scales.get(column.target, 1.0)) is not None
    )


def _stamped(head: Head, table_columns: TableColumns) -> TableColumns:
    """Use the time in the header of the messages of `rostopic echo -p`, if it runs."""
    stamp = label_index(head.labels, "field.header.stamp")
    if table_columns.form != "rostopic echo -p" or stamp is None:
        return table_columns
    if len(set(head.texts(stamp))) < 2:
        remark = "its header.stamp does not run, so the time of arrival (%time) is used"
        return TableColumns(table_columns.form, table_columns.used, table_columns.where, (remark,))
    taken = [
        UsedColumn(stamp, column.target, unit="t_ns") if column.target == "t_device_s" else column
        for column in table_columns.used
    ]
    return TableColumns(table_columns.form, tuple(taken), table_columns.where)


def rate_factor(unit: Unit) -> float | None:
    """Factor of a unit to deg/s; None if it is no unit of a rate."""
    if unit.dimension is not Dimension.RATE:
        return None
    return 1.0 / float(unit.option.removeprefix("lsb/")) if unit.option.startswith("lsb/") else RATE_DPS[unit.option]


def verdict_on(head: Head) -> ColumnVerdict:
    """Verdict of the judge on the columns of a table."""
    labels = head.labels or ("",) * head.width
    rows = [row for row in head.rows if len(row) >= len(labels)]
    texts = [[row[index].strip() for row in rows] for index in range(len(labels))]
    spec_labels = _names(labels) if head.line else _names(tuple(map(bare, labels))) or _names(labels)
    names, stem = _without_common(labels), head.path.stem
    if kind_of(f"{stem} z") == "rate":  # `AngularVelocity.csv` names what its columns X, Y and Z are
        names = tuple(f"{stem} {name}" if len(name) == 1 else name for name in names)
    return judged(names, ("",) * len(labels), texts, spec_labels=spec_labels)


def _names(labels: tuple[str, ...]) -> tuple[str, ...]:
    """Labels as a SPEC may hold them; empty if two are equal."""
    names = tuple(map(as_label, labels))
    return names if len(set(map(plain, names))) == len(names) else ()


def _without_common(labels: tuple[str, ...]) -> tuple[str, ...]:
    """Labels without the words that all of them begin or end with, the clock too: `Shimmer_5E1A_Gyro_Z_CAL`."""
    words = [WORDS.split(LAST_BRACKETS.sub("", label.strip())) for label in labels if label.strip()]
    if len(words) < LABELS_MIN:
        return labels
    shared = [_common(words), _common([parts[::-1] for parts in words])]
    counts = [0 if any(map(unit_of, parts)) else len("".join(parts)) for parts in shared]
    names = tuple(_cut(label, *counts) if label.strip() else label for label in labels)
    is_common = any(counts) and all(len(parts) > len(shared[0]) + len(shared[1]) for parts in words)
    has_clock = any(kind_of(name) == "clock" or CLOCK_WORDS.search(name) for name in names)
    return names if is_common and has_clock else labels


def _common(words: Sequence[Sequence[str]]) -> list[str]:
    """Words with which all begin."""
    return [column[0] for column in takewhile(lambda column: len(set(column)) == 1, zip(*words, strict=False))]


def _cut(label: str, before: int, after: int) -> str:
    """Label without a number of characters before and after its name; the unit in brackets stays."""
    name = LAST_BRACKETS.sub("", label.strip())
    return (name[before : len(name) - after] + label.strip()[len(name) :]).strip("_. ")


def labelled_columns(head: Head, verdict: ColumnVerdict, *, needs_clock: bool = True) -> TableColumns | None:
    """Columns whose labels state meaning and unit; None without a stated rate or yaw, and a stated clock if needed."""
    is_stated = verdict.is_stated if needs_clock else verdict.turn is not None and verdict.turn.is_stated
    if not head.labels or not is_stated:
        return None
    clocks = () if verdict.clock is None or needs_clock else (verdict.clock.entry,)
    unused = {IGNORED, "seq"} if needs_clock else {IGNORED, *clocks}
    entries = [(index, column.entry) for index, column in enumerate(verdict.columns) if column.entry not in unused]
    taken = [_taken(index, column_of(entry)) for index, entry in entries]
    targets = {column.target for column in taken}
    turning = next(index for index, column in enumerate(verdict.columns) if column is verdict.turn)
    where = _own_kind(head)
    remarks = _yaw_remarks(targets, head.labels[turning])
    if "rate_dps" in targets and "encoder_deg" not in targets:
        remarks += _unused_angle_remarks(head, verdict)
    return TableColumns(BY_LABELS, tuple(taken), where, remarks)


def _own_kind(head: Head) -> tuple[tuple[int, str], ...]:
    """Selection of the rows that begin with the first word of the header, which may not be those of other headers."""
    word = head.labels[0].strip()
    return ((0, word),) if word and set(head.texts(0)) == {word} else ()


def _unused_angle_remarks(head: Head, verdict: ColumnVerdict) -> tuple[str, ...]:
    """Remark on an angle with a rate, which may be a reference or the result of the device's own filter."""
    angles = [index for index, column in enumerate(verdict.columns) if column.looks_like in {"yaw", "heading"}]
    units = [unit_in(head.labels[index]) for index in angles]
    if len(angles) != 1 or units[0] is None or units[0].dimension is not Dimension.ANGLE:
        return ()
    sign = ":-" if verdict.columns[angles[0]].looks_like == "heading" else ""
    entries = {
        index: column.entry for index, column in enumerate(verdict.columns) if column in (verdict.clock, verdict.turn)
    }
    entries[angles[0]] = f"encoder:{units[0].option}{sign}"
    labels = [head.labels[index].strip() for index in entries]
    spec = spec_text(list(entries.values()), labels)
    return (f"its angle {labels[-1]} is not used; if it is the reference, state --columns '{spec}'",)


def _yaw_remarks(targets: set[str], label: str) -> tuple[str, ...]:
    if not targets & {"yaw_deg", "qw"}:
        return ()
    if "qw" in targets:
        return (QUATERNION_REMARK,)
    is_compass = bool(label) and kind_of(without_unit(label)) == "heading"
    sign = "its sign is reversed (clockwise)" if is_compass else "if z points down (NED), state --flip"
    return (f"its rate is the difference of an angle, which the device has filtered already; {sign}",)
