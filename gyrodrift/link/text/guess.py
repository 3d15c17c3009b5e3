"""The columns of an unknown text, from some of its lines: what something says, and what has to be asked.

A number is a yaw rate only where a label, a unit or known firmware says so, and its unit is told only where it is
written or the numbers leave no other. What is not said is a question: how numbers behave may tell a clock or an
acceleration, but never a rate.
"""

import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

from gyrodrift.columns.names import (
    SPOKEN,
    USED,
    SeenColumn,
    name_by_known_row,
    name_by_label,
    name_by_unit,
)
from gyrodrift.columns.ranges import TEMPERATURES_C
from gyrodrift.columns.spec import IGNORED
from gyrodrift.columns.units import unit_in, unit_of
from gyrodrift.link.text.behavior import find_accelerometer, find_clock, find_temperature, unname_clocks
from gyrodrift.link.text.fields import Fields, Form, as_label, is_number
from gyrodrift.link.text.headings import Headings
from gyrodrift.link.text.units import angle_unit, clock_unit, rate_unit

LEAST_LINES = 3
MOST_LINES = 400
TIMES = re.compile(r"\s*[*×]\s*")
"""A number that is multiplied, `gz*100`, keeps that in its name."""

ASKED_UNIT = "UNIT"
"""Stands in a SPEC for what a person has to say."""


@dataclass(frozen=True, slots=True)
class GuessedColumn:
    """One column.

    said
        What it looks like, as in `t_ms` or `gx`; what is no quantity has the name IGNORED.
    entry
        The entry of `--columns` for it, IGNORED where it is of no use.
    why
        What speaks for it.
    """

    said: str
    entry: str
    why: str


@dataclass(frozen=True, slots=True)
class TextGuess:
    """What the lines of a text hold.

    example
        A line of the kind that was looked at.
    labels
        One for each column; empty where the place of a value says what it is.
    """

    form: Form
    example: str
    labels: tuple[str, ...]
    columns: tuple[GuessedColumn, ...]

    @property
    def turn(self) -> GuessedColumn | None:
        """The column that says how the device turns; None where nothing says that one does."""
        return next((column for column in self.columns if column.entry.startswith(("rate", "yaw"))), None)

    @property
    def is_unit_said(self) -> bool:
        """Whether it is known in which unit that column is."""
        return self.turn is not None and ASKED_UNIT not in self.turn.entry

    @property
    def spec(self) -> str | None:
        """For `--columns`; None where something has to be asked first."""
        return self.template if self.is_unit_said else None

    @property
    def template(self) -> str | None:
        """The same with ASKED_UNIT for a unit that is not said; None where no column is a rate or yaw."""
        if self.turn is None:
            return None
        entries = [column.entry for column in self.columns]
        if any(self.labels):
            named = zip(self.labels, entries, strict=True)
            return ", ".join(f"{label}={entry}" for label, entry in named if entry != IGNORED and label)
        while entries[-1] == IGNORED:
            entries.pop()
        return ", ".join(entries)

    def meaning(self, place: int) -> str:
        """What the column at that place looks like; IGNORED where there is none."""
        return self.columns[place].said if place < len(self.columns) else IGNORED


def guess(lines: Iterable[str], lines_per_s: float | None = None) -> TextGuess | None:
    """What the columns of a text are; None where nothing in it repeats that has numbers.

    `lines_per_s` is the pace at which the lines came, where it is known: it tells the unit of a clock.
    """
    heard = [line for line in (line.strip() for line in lines) if line][-MOST_LINES:]
    found = _guess([line for line in heard if not line.startswith("#")], lines_per_s)
    if found is None or found.turn is None:  # what looks like comments may be all there is
        found = _guess([line.lstrip("# ") for line in heard], lines_per_s) or found
    return found


def _guess(heard: list[str], lines_per_s: float | None) -> TextGuess | None:
    headings = Headings()
    parsed = [(line, fields) for line in heard if (fields := headings.fields_of(line)) is not None]
    layout = _usual_layout([fields for _, fields in parsed])
    if layout is None:
        return None
    alike = [(line, fields) for line, fields in parsed if _layout(fields) == layout and _has_numbers(fields)]
    columns = _columns([fields for _, fields in alike], _header(parsed, layout, headings))
    name_by_known_row(columns)
    name_by_label(columns)
    name_by_unit(columns)
    pace = lines_per_s * len(alike) / len(heard) if lines_per_s else None
    unname_clocks(columns, pace)
    find_clock(columns, pace)
    find_accelerometer(columns)
    find_temperature(columns)
    guessed = tuple(_guessed(column, pace, columns) for column in columns)
    return TextGuess(layout.form, alike[-1][0], layout.labels, _one_turn(guessed))


@dataclass(frozen=True, slots=True)
class _Layout:
    """Lines that have it are of one kind."""

    form: Form
    labels: tuple[str, ...]
    count: int


def _layout(fields: Fields) -> _Layout:
    return _Layout(fields.form, fields.labels, len(fields.values))


def _has_numbers(fields: Fields) -> bool:
    return any(map(is_number, fields.values))


def _usual_layout(parsed: Sequence[Fields]) -> _Layout | None:
    """The most common one that has numbers; where several take turns, the one with a rate or yaw by its labels."""
    found = Counter(_layout(fields) for fields in parsed if _has_numbers(fields))
    common = [layout for layout, times in found.items() if times >= LEAST_LINES]
    if not common:
        return None
    most = max(found[layout] for layout in common)
    turns = [layout for layout in common if found[layout] >= 0.5 * most]
    units = {_layout(fields): fields.units for fields in parsed}
    for kind in ("rate", "yaw", "heading"):
        for layout in turns:
            if kind in _kinds(layout, units[layout]):
                return layout
    return max(turns, key=lambda layout: found[layout])


def _kinds(layout: _Layout, units: tuple[str, ...]) -> set[str]:
    """By labels and units alone."""
    said = units or ("",) * layout.count
    columns = [
        SeenColumn(label, ("0",), (0.0,), unit_of(unit) or unit_in(label))
        for label, unit in zip(layout.labels, said, strict=True)
    ]
    name_by_label(columns)
    return {column.kind for column in columns}


def _header(parsed: Sequence[tuple[str, Fields]], layout: _Layout, headings: Headings) -> tuple[str, ...] | None:
    """The names in the last line above the first row of values."""
    names = None
    for _, fields in parsed:
        if fields.form is Form.ROW is layout.form and len(fields.values) == layout.count:
            if _has_numbers(fields):
                return names
            names = tuple(headings.full(as_label(TIMES.sub(" x ", value))) for value in fields.values)
    return None


def _columns(alike: Sequence[Fields], header: tuple[str, ...] | None) -> list[SeenColumn]:
    labels = header or alike[0].labels
    units = next((fields.units for fields in alike if fields.units), ("",) * len(labels))
    rows = [fields.values for fields in alike]
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
    """The words before the axis of a label."""
    return label.rpartition(" ")[0]


def _guessed(column: SeenColumn, lines_per_s: float | None, columns: Sequence[SeenColumn]) -> GuessedColumn:
    kind, option = column.kind, column.option
    if kind == "clock":
        unit, why = clock_unit(column, lines_per_s)
        return GuessedColumn(unit, unit, why)
    if kind == "rate":
        unit, why = (option, "") if option else rate_unit(column, columns)
        return GuessedColumn(SPOKEN["rate"], f"rate:{unit or ASKED_UNIT}", f"{column.why}{why}")
    if kind in {"yaw", "heading"}:
        unit, why = (option, "") if option else angle_unit(column)
        sign = ":-" if kind == "heading" else ""  # a compass counts clockwise
        return GuessedColumn(kind, f"yaw:{unit or ASKED_UNIT}{sign}", f"{column.why}{why}")
    is_counted = kind == "temp" and not all(TEMPERATURES_C[0] < number < TEMPERATURES_C[1] for number in column.numbers)
    entry = kind if kind in USED and not is_counted else IGNORED
    return GuessedColumn(SPOKEN.get(kind, kind) or IGNORED, entry, column.why)


def _one_turn(columns: tuple[GuessedColumn, ...]) -> tuple[GuessedColumn, ...]:
    """A rate is used rather than an angle, which the device has filtered already; of several the first."""
    first = next((column for word in ("rate", "yaw") for column in columns if column.entry.startswith(word)), None)
    return tuple(
        GuessedColumn(column.said, IGNORED, column.why)
        if column.entry.startswith(("rate", "yaw")) and column is not first
        else column
        for column in columns
    )
