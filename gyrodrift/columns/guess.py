"""Guess of the columns of an unknown text from some of its lines.

A column is a yaw rate only if a label, a unit or known firmware says so. Its unit is given only if it is written, or if
the numbers exclude all others. Anything else is a question to the user: the behavior of numbers may identify a clock or
an acceleration, but never a rate.
"""

import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

from gyrodrift.columns.behavior import find_accelerometer, find_clock, find_temperature, unname_clocks
from gyrodrift.columns.fields import Fields, Form, Headings, as_label, is_number
from gyrodrift.columns.names import (
    SPOKEN,
    USED,
    SeenColumn,
    name_by_known_row,
    name_by_label,
    name_by_unit,
)
from gyrodrift.columns.sizes import TEMPERATURES_C
from gyrodrift.columns.spec import IGNORED, spec_text
from gyrodrift.columns.stated_units import angle_unit, axis_units, clock_unit, rate_unit
from gyrodrift.columns.units import unit_in, unit_of

LINES_MIN = 3
LINES_MAX = 400
TIMES = re.compile(r"\s*[*×]\s*")
"""Factor in a name, such as `gz*100`, which the label keeps."""

UNKNOWN_UNIT = "UNIT"
"""Placeholder in a SPEC for a unit that the user must give."""


@dataclass(frozen=True, slots=True)
class GuessedColumn:
    """Guess of a column.

    looks_like
        Name such as `t_ms` or `gx`; IGNORED if it is not a known quantity.
    entry
        Entry for `--columns`; IGNORED if it is not used.
    why
        Reason for the guess.
    """

    looks_like: str
    entry: str
    why: str


@dataclass(frozen=True, slots=True)
class TextGuess:
    """Guess of the columns of a text.

    example
        A line of the text.
    labels
        Label per column; empty if columns are identified by position.
    """

    form: Form
    example: str
    labels: tuple[str, ...]
    columns: tuple[GuessedColumn, ...]

    @property
    def turn(self) -> GuessedColumn | None:
        """Column of the rate or of yaw; None if unknown."""
        return next((column for column in self.columns if column.entry.startswith(("rate", "yaw"))), None)

    @property
    def is_unit_known(self) -> bool:
        """Whether the unit of that column is known."""
        return self.turn is not None and UNKNOWN_UNIT not in self.turn.entry

    @property
    def spec(self) -> str | None:
        """SPEC for `--columns`; None if information is missing."""
        return self.template if self.is_unit_known else None

    @property
    def template(self) -> str | None:
        """SPEC with UNKNOWN_UNIT for a missing unit; None if no column is a rate or yaw."""
        if self.turn is None:
            return None
        return spec_text([column.entry for column in self.columns], self.labels)

    def meaning(self, index: int) -> str:
        """Name of a column; IGNORED without one."""
        return self.columns[index].looks_like if index < len(self.columns) else IGNORED


def guess(lines: Iterable[str], lines_per_s: float | None = None) -> TextGuess | None:
    """Guess the columns of a text; None without repeated lines with numbers.

    `lines_per_s` is the rate of the lines, or None; it gives the unit of a clock.
    """
    heard = [line for line in (line.strip() for line in lines) if line][-LINES_MAX:]
    guessed = _guess([line for line in heard if not line.startswith("#")], lines_per_s)
    if guessed is None or guessed.turn is None:  # all data may have a comment mark
        guessed = _guess([line.lstrip("# ") for line in heard], lines_per_s) or guessed
    return guessed


def _guess(heard: list[str], lines_per_s: float | None) -> TextGuess | None:
    headings = Headings()
    parsed = [(line, fields) for line in heard if (fields := headings.fields_of(line)) is not None]
    layout = _usual_layout([fields for _, fields in parsed])
    if layout is None:
        return None
    similar = [(line, fields) for line, fields in parsed if _layout(fields) == layout and _has_numbers(fields)]
    columns = _columns([fields for _, fields in similar], _header(parsed, layout, headings))
    name_by_known_row(columns)
    name_by_label(columns)
    name_by_unit(columns)
    pace = lines_per_s * len(similar) / len(heard) if lines_per_s else None
    unname_clocks(columns, pace)
    find_clock(columns, pace)
    find_accelerometer(columns)
    find_temperature(columns)
    guessed = _one_turn(tuple(_guessed(column, pace, columns) for column in columns))
    return TextGuess(layout.form, similar[-1][0], layout.labels, _with_axes(guessed, columns))


@dataclass(frozen=True, slots=True)
class _Layout:
    """Layout of a line: lines of a kind have the same."""

    form: Form
    labels: tuple[str, ...]
    count: int


def _layout(fields: Fields) -> _Layout:
    return _Layout(fields.form, fields.labels, len(fields.values))


def _has_numbers(fields: Fields) -> bool:
    return any(map(is_number, fields.values))


def _usual_layout(parsed: Sequence[Fields]) -> _Layout | None:
    """Most common layout with numbers; if several alternate, the one with a labeled rate or yaw."""
    counts = Counter(_layout(fields) for fields in parsed if _has_numbers(fields))
    common = [layout for layout, times in counts.items() if times >= LINES_MIN]
    if not common:
        return None
    highest = max(counts[layout] for layout in common)
    frequent = [layout for layout in common if counts[layout] >= 0.5 * highest]
    units = {_layout(fields): fields.units for fields in parsed}
    for kind in ("rate", "yaw", "heading"):
        for layout in frequent:
            if kind in _kinds(layout, units[layout]):
                return layout
    return max(frequent, key=lambda layout: counts[layout])


def _kinds(layout: _Layout, units: tuple[str, ...]) -> set[str]:
    """Kinds of the columns from labels and units only."""
    unit_texts = units or ("",) * layout.count
    columns = [
        SeenColumn(label, ("0",), (0.0,), unit_of(unit) or unit_in(label))
        for label, unit in zip(layout.labels, unit_texts, strict=True)
    ]
    name_by_label(columns)
    return {column.kind for column in columns}


def _header(parsed: Sequence[tuple[str, Fields]], layout: _Layout, headings: Headings) -> tuple[str, ...] | None:
    """Names in the last line above the first row of values."""
    names = None
    for _, fields in parsed:
        if fields.form is Form.ROW is layout.form and len(fields.values) == layout.count:
            if _has_numbers(fields):
                return names
            names = tuple(headings.full(as_label(TIMES.sub(" x ", value))) for value in fields.values)
    return None


def _columns(similar: Sequence[Fields], header: tuple[str, ...] | None) -> list[SeenColumn]:
    labels = header or similar[0].labels
    units = next((fields.units for fields in similar if fields.units), ("",) * len(labels))
    rows = [fields.values for fields in similar]
    columns = []
    for label, unit, texts in zip(labels, units, zip(*rows, strict=True), strict=True):
        numbers = tuple(float(text) for text in texts if is_number(text))
        is_numeric = len(numbers) == len(texts) and all(abs(number) < 1e18 for number in numbers)
        columns.append(SeenColumn(label, texts, numbers if is_numeric else (), unit_of(unit) or unit_in(label)))
    for column, after in reversed(list(pairwise(columns))):
        if column.unit is None and _head(column.label) == _head(after.label) != "":
            column.unit = after.unit  # `Rotation X: 0.1, Y: 0.2, Z: 0.3 rad/s`
    return columns


def _head(label: str) -> str:
    """Words before the axis of a label."""
    return label.rpartition(" ")[0]


def _guessed(column: SeenColumn, lines_per_s: float | None, columns: Sequence[SeenColumn]) -> GuessedColumn:
    kind, option = column.kind, column.option
    if kind == "clock":
        unit, why = clock_unit(column, lines_per_s)
        return GuessedColumn(unit, unit, why)
    if kind == "rate":
        unit, why = (option, "") if option else rate_unit(column, columns)
        return GuessedColumn(SPOKEN["rate"], f"rate:{unit or UNKNOWN_UNIT}", f"{column.why}{why}")
    if kind in {"yaw", "heading"}:
        unit, why = (option, "") if option else angle_unit(column)
        sign = ":-" if kind == "heading" else ""  # a compass is positive clockwise
        return GuessedColumn(kind, f"yaw:{unit or UNKNOWN_UNIT}{sign}", f"{column.why}{why}")
    is_counted = kind == "temp" and not all(TEMPERATURES_C[0] < number < TEMPERATURES_C[1] for number in column.numbers)
    entry = kind if kind in USED and not is_counted else IGNORED
    return GuessedColumn(SPOKEN.get(kind, kind) or IGNORED, entry, column.why)


def _one_turn(columns: tuple[GuessedColumn, ...]) -> tuple[GuessedColumn, ...]:
    """Keep the first rate, or else the first angle, which the device has filtered already; ignore others."""
    first = next((column for word in ("rate", "yaw") for column in columns if column.entry.startswith(word)), None)
    return tuple(
        GuessedColumn(column.looks_like, IGNORED, column.why)
        if column.entry.startswith(("rate", "yaw")) and column is not first
        else column
        for column in columns
    )


def _with_axes(guessed: tuple[GuessedColumn, ...], columns: Sequence[SeenColumn]) -> tuple[GuessedColumn, ...]:
    """Use the other axes too, if rate and acceleration have known units."""
    rate = next((column.entry for column in guessed if column.entry.startswith("rate:")), "")
    units = axis_units(rate.removeprefix("rate:"), columns)
    return tuple(
        GuessedColumn(column.looks_like, f"{source.kind}:{units[source.kind]}", column.why)
        if source.kind in units
        else column
        for column, source in zip(guessed, columns, strict=True)
    )
