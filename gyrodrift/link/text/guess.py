"""What probably stands in the columns of an unknown text, from some of its lines, with what speaks for each.

Labels come first: who prints `gz:` says what it is. Where there are none, a column is told by how it behaves: a clock
grows evenly, the length of three accelerations stays the same, a rate moves about zero.
"""

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from gyrodrift.columns.names import SPOKEN, USED, SeenColumn, kind_of, name_by_first_word, name_by_label
from gyrodrift.columns.spec import IGNORED
from gyrodrift.link.text.behaviour import find_accelerometer, find_clock, find_rate, find_temperature
from gyrodrift.link.text.fields import Fields, Form, as_label, fields_of, is_number
from gyrodrift.link.text.units import clock_unit, rate_unit

LEAST_LINES = 3
MOST_LINES = 400
TEMPERATURES_C = (-55.0, 150.0)
"""Beyond what any sensor is made for, a temperature is in counts."""


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
    def spec(self) -> str | None:
        """For `--columns`; None where no column looks like a rate."""
        entries = [column.entry for column in self.columns]
        if not any(entry.startswith("rate") for entry in entries):
            return None
        if self.form in (Form.LABELLED, Form.JSON):
            named = zip(self.labels, entries, strict=True)
            return ", ".join(f"{label}={entry}" for label, entry in named if entry != IGNORED)
        while entries[-1] == IGNORED:
            entries.pop()
        return ", ".join(entries)

    def meaning(self, place: int) -> str:
        """What the column at that place looks like; IGNORED where there is none."""
        return self.columns[place].said if place < len(self.columns) else IGNORED


def guess(lines: Iterable[str], lines_per_s: float | None = None) -> TextGuess | None:
    """What the columns of a text probably are; None where nothing in it repeats that has numbers.

    `lines_per_s` is the pace at which the lines came, where it is known: it tells the unit of a clock. An error inside
    of it is no guess: lines come from a device that can print anything, and a guess must not end what it explains.
    """
    try:
        return _guess(lines, lines_per_s)
    except (ArithmeticError, LookupError, TypeError, ValueError):  # StatisticsError is a ValueError
        return None


def _guess(lines: Iterable[str], lines_per_s: float | None) -> TextGuess | None:
    heard = [line for line in (line.strip() for line in lines) if line and not line.startswith("#")][-MOST_LINES:]
    parsed = [(line, fields) for line in heard if (fields := fields_of(line)) is not None]
    layout = _usual_layout([fields for _, fields in parsed])
    if layout is None:
        return None
    alike = [(line, fields) for line, fields in parsed if _layout(fields) == layout and _has_numbers(fields)]
    columns = _columns([fields for _, fields in alike], _header(parsed, layout))
    name_by_label(columns)
    name_by_first_word(columns)
    pace = lines_per_s * len(alike) / len(heard) if lines_per_s else None
    find_clock(columns, pace)
    find_accelerometer(columns)
    find_temperature(columns)
    find_rate(columns)
    text = " ".join(heard[:MOST_LINES]).lower()
    guessed = tuple(_guessed(column, pace, text) for column in columns)
    return TextGuess(layout.form, alike[-1][0], layout.labels, guessed)


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
    """The most common one that has numbers; where several take turns, the one with a rate by its labels."""
    found = Counter(_layout(fields) for fields in parsed if _has_numbers(fields))
    common = [layout for layout, times in found.items() if times >= LEAST_LINES]
    if not common:
        return None
    most = max(found[layout] for layout in common)
    turns = [layout for layout in common if found[layout] >= 0.5 * most]
    with_rate = [layout for layout in turns if any(kind_of(label) == "rate" for label in layout.labels)]
    return max(with_rate or turns, key=lambda layout: found[layout])


def _header(parsed: Sequence[tuple[str, Fields]], layout: _Layout) -> tuple[str, ...] | None:
    """The names in the last line above the first row of values."""
    names = None
    for _, fields in parsed:
        if fields.form is Form.ROW is layout.form and len(fields.values) == layout.count:
            if _has_numbers(fields):
                return names
            names = tuple(map(as_label, fields.values))
    return None


def _columns(alike: Sequence[Fields], header: tuple[str, ...] | None) -> list[SeenColumn]:
    labels = header or alike[0].labels
    rows = [fields.values for fields in alike]
    columns = []
    for label, texts in zip(labels, zip(*rows, strict=True), strict=True):
        numbers = tuple(float(text) for text in texts if is_number(text))
        is_numeric = len(numbers) == len(texts) and all(abs(number) < 1e18 for number in numbers)
        columns.append(SeenColumn(label, texts, numbers if is_numeric else ()))
    return columns


def _guessed(column: SeenColumn, lines_per_s: float | None, text: str) -> GuessedColumn:
    kind = column.kind
    if kind == "clock":
        unit, why = clock_unit(column, lines_per_s)
        return GuessedColumn(unit, unit, why)
    if kind == "rate":
        said = kind_of(column.label) if kind_of(column.label) in {"gx", "gy"} else SPOKEN["rate"]
        unit, why = rate_unit(column, text)
        return GuessedColumn(said, f"rate{unit}", f"{column.why}{why}")
    is_counted = kind == "temp" and not all(TEMPERATURES_C[0] < number < TEMPERATURES_C[1] for number in column.numbers)
    entry = kind if kind in USED and not is_counted else IGNORED
    return GuessedColumn(SPOKEN.get(kind, kind) or IGNORED, entry, column.why)
