"""Lines of a text as columns over time, before anything is known of them."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.columns.names import kind_of
from gyrodrift.columns.units import Dimension, Unit, unit_in, unit_of
from gyrodrift.link.heard import decoded, plain_text
from gyrodrift.link.text.fields import Fields, Form, as_label, is_number, is_whole
from gyrodrift.link.text.headings import Headings

MOST_LINES = 200_000
LARGEST = 1e18
"""Numbers beyond are damaged lines."""

WHOLE_WITHIN = 1e-6
NO_RATES = frozenset(
    {"clock", "seq", "temp", "encoder", "ax", "ay", "az", "mx", "my", "mz", "pitch", "roll", "quaternion"}
)
"""Kinds that a label states, and that neither turn about the vertical axis nor say how far."""

RATE_DIMENSIONS = frozenset({Dimension.RATE, Dimension.ANGLE, Dimension.COUNTS})


@dataclass(frozen=True, slots=True)
class TimedLine:
    """A line and when it came, s of any origin."""

    t_s: float
    text: str


@dataclass(frozen=True, slots=True)
class ColumnKey:
    """Where a column stands.

    label
        Label of its values; empty for values of a row, which `place` (from 0) in rows of `width` values tells.
    repeat
        0 for the first value of that label in a line, which is the one that a SPEC can name.
    """

    label: str = ""
    place: int = 0
    width: int = 0
    repeat: int = 0


@dataclass(frozen=True, slots=True, eq=False)
class Series:
    """A column of numbers over time.

    name
        For people: its label, the name above it, or `column 3`.
    kind
        As `kind_of` a label; empty where no label says it.
    t_s, values
        Arrival and number, shape (n,) each.
    is_whole
        Whether its numbers, or the steps between them, are whole: counts, as sensors give them.
    """

    key: ColumnKey
    name: str
    kind: str
    unit: Unit | None
    t_s: Floats
    values: Floats
    is_whole: bool

    @property
    def can_turn(self) -> bool:
        """Whether neither its label nor its unit stands against a rate or an angle about the vertical axis."""
        return self.kind not in NO_RATES and (self.unit is None or self.unit.dimension in RATE_DIMENSIONS)


@dataclass(slots=True)
class _Growing:
    t_s: list[float] = field(default_factory=list)
    values: list[float] = field(default_factory=list)
    unit: Unit | None = None
    is_whole: bool = True


class TextTable:
    """Takes lines as they come and gives the columns that they hold.

    numbered_lines, last_s
        Lines that hold at least one number, and when the last of them came; 0 before the first.
    """

    def __init__(self) -> None:
        self.numbered_lines = 0
        self.last_s = 0.0
        self._headings = Headings()
        self._columns: dict[ColumnKey, _Growing] = {}
        self._headers: dict[int, tuple[str, ...]] = {}
        self._kept: list[TimedLine] = []

    @property
    def lines(self) -> Sequence[TimedLine]:
        """All of them: a heading belongs to the numbers below it."""
        return self._kept

    def take(self, line: TimedLine) -> None:
        """The next line; nothing beyond MOST_LINES is kept."""
        if len(self._kept) >= MOST_LINES:
            return
        self._kept.append(line)
        fields = self._headings.fields_of(line.text.lstrip("# "))
        if fields is None:
            return
        if not any(map(is_number, fields.values)):
            if fields.form is Form.ROW:
                self._headers[len(fields.values)] = tuple(map(as_label, fields.values))
            return
        self.numbered_lines += 1
        self.last_s = line.t_s
        units = fields.units or ("",) * len(fields.values)
        for key, text, unit in zip(_keys(fields), fields.values, units, strict=True):
            if is_number(text) and abs(number := float(text)) < LARGEST:
                self._add(key, line.t_s, number, unit, is_whole=is_whole(text))

    def series(self) -> list[Series]:
        """The columns so far."""
        return [self._series(key, column) for key, column in self._columns.items()]

    def _add(self, key: ColumnKey, t_s: float, number: float, unit: str, *, is_whole: bool) -> None:
        column = self._columns.setdefault(key, _Growing())
        column.t_s.append(t_s)
        column.values.append(number)
        column.is_whole = column.is_whole and is_whole
        column.unit = column.unit or (unit_of(unit) if unit else None)

    def _series(self, key: ColumnKey, column: _Growing) -> Series:
        header = self._headers.get(key.width, ()) if not key.label else ()
        label = key.label or (header[key.place] if header else "")
        values = np.array(column.values)
        return Series(
            key=key,
            name=label or f"column {key.place + 1}",
            kind=kind_of(label),
            unit=column.unit or unit_in(label),
            t_s=np.array(column.t_s),
            values=values,
            is_whole=column.is_whole or _has_whole_steps(values),
        )


def _keys(fields: Fields) -> list[ColumnKey]:
    keys, seen = [], dict.fromkeys(fields.labels, 0)
    for place, label in enumerate(fields.labels):
        if label:
            keys.append(ColumnKey(label, repeat=seen[label]))
            seen[label] += 1
        else:
            keys.append(ColumnKey(place=place, width=len(fields.values)))
    return keys


def _has_whole_steps(values: Floats) -> bool:
    """Counts from which a sketch has taken an offset."""
    steps = np.diff(values)
    return bool(np.any(steps) and np.all(np.abs(steps - np.round(steps)) < WHOLE_WITHIN))


class LineTimes:
    """Splits what came into lines, and spreads those that came together over the time since the ones before."""

    def __init__(self) -> None:
        self._pending = b""
        self._last_s: float | None = None

    def split(self, chunk: bytes, arrival_s: float) -> list[TimedLine]:
        """The lines that end in a chunk."""
        *whole, self._pending = (self._pending + plain_text(chunk)).replace(b"\r", b"\n").split(b"\n")
        self._pending = self._pending[-4096:]
        texts = [text for line in whole if (text := decoded(line).strip())]
        if not texts:
            return []
        begin_s = arrival_s if self._last_s is None else self._last_s
        self._last_s = arrival_s
        step_s = (arrival_s - begin_s) / len(texts)
        return [TimedLine(begin_s + (1 + at) * step_s, text) for at, text in enumerate(texts)]


def table_of(lines: Iterable[TimedLine]) -> TextTable:
    """A table of lines that are all there."""
    table = TextTable()
    for line in lines:
        table.take(line)
    return table
