"""Lines of a text as columns over time."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from gyrodrift.columns.fields import Fields, Form, Headings, as_label, is_number, is_whole
from gyrodrift.columns.keys import keys_of
from gyrodrift.columns.names import kind_of
from gyrodrift.columns.units import Dimension, Unit, unit_in, unit_of
from gyrodrift.io.plain_text import decoded, plain_text
from gyrodrift.values.arrays import Floats

LINES_MAX = 200_000
LARGEST = 1e18
"""Largest number; above, the line is damaged."""

WHOLE_WITHIN = 1e-6
NO_RATES = frozenset(
    {"clock", "seq", "temp", "encoder", "ax", "ay", "az", "mx", "my", "mz", "pitch", "roll", "quaternion"}
)
"""Labeled kinds that are neither a rate nor an angle about the vertical axis."""

RATE_DIMENSIONS = frozenset({Dimension.RATE, Dimension.ANGLE, Dimension.COUNTS})


@dataclass(frozen=True, slots=True)
class TimedLine:
    """Line and its arrival time, s, from any origin."""

    t_s: float
    text: str


@dataclass(frozen=True, slots=True)
class ColumnKey:
    """Position of a column.

    label
        Label of its values; empty for a value of a row.
    index, width
        Position in a row, from 0, and number of values of the row.
    repeat
        Number of earlier values with that label in a line; a SPEC can name number 0 only.
    """

    label: str = ""
    index: int = 0
    width: int = 0
    repeat: int = 0


@dataclass(frozen=True, slots=True, eq=False)
class Series:
    """Column of numbers over time.

    name
        Label, heading, or `column 3`.
    kind
        `kind_of` its label; empty without a label.
    t_s, values
        Arrival times and numbers, both of shape (n,).
    is_whole
        Whether its numbers, or the steps between them, are whole, like the counts of a sensor.
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
        """Whether label and unit allow a rate or an angle about the vertical axis."""
        return self.kind not in NO_RATES and (self.unit is None or self.unit.dimension in RATE_DIMENSIONS)


@dataclass(slots=True)
class _Growing:
    t_s: list[float] = field(default_factory=list)
    values: list[float] = field(default_factory=list)
    unit: Unit | None = None
    is_whole: bool = True


class TextTable:
    """Columns of lines.

    numbered_lines, last_s
        Number of lines with a number, and arrival of the last one, s; 0 before the first.
    """

    def __init__(self) -> None:
        self.numbered_lines = 0
        self.last_s = 0.0
        self._headings = Headings()
        self._columns: dict[ColumnKey, _Growing] = {}
        self._headers: dict[int, tuple[str, ...]] = {}
        self._kept: list[TimedLine] = []
        self._texts: dict[str, list[tuple[TimedLine, str]]] = {}

    @property
    def lines(self) -> Sequence[TimedLine]:
        """All lines, including headings."""
        return self._kept

    def senders(self) -> tuple[str, tuple[str, ...]]:
        """Label of the first column whose value names the sender of a line, and these values; empty without one."""
        texts_of = {label: [text for _, text in texts] for label, texts in self._texts.items()}
        named = ((label, keys_of(texts)) for label, texts in texts_of.items() if kind_of(label) in {"", "seq"})
        return next(((label, keys) for label, keys in named if keys), ("", ()))

    def of_sender(self, label: str, sender: str) -> "TextTable":
        """Table of the lines of one sender."""
        table = TextTable()
        for line, text in self._texts[label]:
            if text == sender:
                table.take(line)
        return table

    def take(self, line: TimedLine) -> None:
        """Add a line; lines beyond LINES_MAX are ignored."""
        if len(self._kept) >= LINES_MAX:
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
        for label, text in zip(fields.labels, fields.values, strict=True):
            if label:
                self._texts.setdefault(label, []).append((line, text))
        units = fields.units or ("",) * len(fields.values)
        for key, text, unit in zip(_keys(fields), fields.values, units, strict=True):
            if is_number(text) and abs(number := float(text)) < LARGEST:
                self._add(key, line.t_s, number, unit, is_whole=is_whole(text))

    def series(self) -> list[Series]:
        """Columns so far."""
        return [self._series(key, column) for key, column in self._columns.items()]

    def _add(self, key: ColumnKey, t_s: float, number: float, unit: str, *, is_whole: bool) -> None:
        column = self._columns.setdefault(key, _Growing())
        column.t_s.append(t_s)
        column.values.append(number)
        column.is_whole = column.is_whole and is_whole
        column.unit = column.unit or (unit_of(unit) if unit else None)

    def _series(self, key: ColumnKey, column: _Growing) -> Series:
        header = self._headers.get(key.width, ()) if not key.label else ()
        label = key.label or (header[key.index] if header else "")
        values = np.array(column.values)
        return Series(
            key=key,
            name=label or f"column {key.index + 1}",
            kind=kind_of(label),
            unit=column.unit or unit_in(label),
            t_s=np.array(column.t_s),
            values=values,
            is_whole=column.is_whole or _has_whole_steps(values),
        )


def _keys(fields: Fields) -> list[ColumnKey]:
    keys, repeats = [], dict.fromkeys(fields.labels, 0)
    for index, label in enumerate(fields.labels):
        if label:
            keys.append(ColumnKey(label, repeat=repeats[label]))
            repeats[label] += 1
        else:
            keys.append(ColumnKey(index=index, width=len(fields.values)))
    return keys


def _has_whole_steps(values: Floats) -> bool:
    """Whether the steps are whole: counts with an offset."""
    steps = np.diff(values)
    return bool(np.any(steps) and np.all(np.abs(steps - np.round(steps)) < WHOLE_WITHIN))


class LineTimes:
    """Split bytes into lines, and distribute lines that arrived together over the time since the lines before."""

    def __init__(self) -> None:
        self._pending = b""
        self._last_s: float | None = None

    def split(self, chunk: bytes, arrival_s: float) -> list[TimedLine]:
        """Lines that end in a chunk."""
        *whole, self._pending = (self._pending + plain_text(chunk)).replace(b"\r", b"\n").split(b"\n")
        self._pending = self._pending[-4096:]
        texts = [text for line in whole if (text := decoded(line).strip())]
        if not texts:
            return []
        begin_s = arrival_s if self._last_s is None else self._last_s
        self._last_s = arrival_s
        step_s = (arrival_s - begin_s) / len(texts)
        return [TimedLine(begin_s + (1 + index) * step_s, text) for index, text in enumerate(texts)]


def table_of(lines: Iterable[TimedLine]) -> TextTable:
    """A table of lines that are all there."""
    table = TextTable()
    for line in lines:
        table.take(line)
    return table
