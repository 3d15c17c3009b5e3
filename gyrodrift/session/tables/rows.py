"""Rows of text as columns of numbers; bad rows are counted and the first one is reported."""

import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import islice
from math import nan

import numpy as np

from gyrodrift.columns.fields import is_value
from gyrodrift.columns.sizes import has_16_bits
from gyrodrift.columns.times import FORMS, ClockReader, is_stamp
from gyrodrift.session.tables.plan import OWN, RATE_TARGETS, Head, TableColumns, UsedColumn
from gyrodrift.values.arrays import Floats
from gyrodrift.values.constants import INT16_COUNTS
from gyrodrift.values.errors import shortened, visible

PIECE = 20_000
"""Rows per conversion."""

CELL_SHOWN, VALUES_SHOWN = 40, 5
BLOCKS_MAX = 100
"""Most blocks of rows that may be those of senders, one after the other."""

SPACES = " \u00a0\u202f'’"
GROUPED = {
    mark: re.compile(rf"[-+]?(?:\d+|[1-9]\d{{0,2}}([{SPACES}{thousands}])\d{{3}}(?:\1\d{{3}})*)?(?:[{mark}]\d*)?")
    for mark, thousands in ((".", ","), (",", "."))
}
"""Numbers with a mark between thousands, by their decimal mark: `1,234.5`, `1 234,5`, `1'234`."""


class WrongCellError(ValueError):
    """A row is no sample; the text is the reason."""


@dataclass(slots=True)
class Refused:
    """Rows that are no samples: count, line and reason of the first, and whether it is the last row of the table."""

    count: int = 0
    line: int = 0
    why: str = ""
    is_last: bool = False

    def add(self, line: int, why: str) -> None:
        """Count a row."""
        if not self.count:
            self.line, self.why = line, why
        self.count += 1


@dataclass(slots=True)
class ColumnsRead:
    """Columns of a table while they are read.

    began
        First stamp if the clock counts from it, else empty.
    counted
        Unit of the clock if its fraction has no leading zeros, else empty.
    rejected
        First values of the rows that are not to be used.
    edges
        First and last row, and between them those before and after each step back of the clock; at most 2 BLOCKS_MAX.
    """

    pieces: dict[str, list[Floats]]
    refused: Refused = field(default_factory=Refused)
    headers: int = 0
    without_rate: int = 0
    count: int = 0
    began: str = ""
    counted: str = ""
    rejected: dict[str, None] = field(default_factory=dict)
    edges: list[Sequence[str]] = field(default_factory=list)
    last_s: float = nan

    def column(self, target: str) -> Floats | None:
        """Values of a column, shape (n,); None if it is not used."""
        return np.concatenate(self.pieces[target] or [np.empty(0)]) if target in self.pieces else None


class RowReader:
    """Converts the rows of a table; `keeps_empty` keeps rows without a rate, as in sessions of this program."""

    def __init__(self, head: Head, columns: TableColumns, *, has_decimal_comma: bool, keeps_empty: bool) -> None:
        self.columns_read = ColumnsRead({column.target: [] for column in columns.used})
        self._width, self._is_selected = head.width, False
        self._needed = 1 + max(column.index for column in columns.used)
        self._head, self._columns, self._comma = head, columns, has_decimal_comma
        self._keeps_empty = keeps_empty
        self._values = [column for column in columns.used if column.target != "t_device_s" or columns.form == OWN]
        self._clocks = [column for column in columns.used if column not in self._values]
        self._clock = ClockReader([column.unit for column in self._clocks])
        self._moved = next(name for name in ("rate_dps", "yaw_deg", "delta_deg", "qw") if name in columns.targets)

    def read(self, rows: Iterable[tuple[int, list[str]]]) -> ColumnsRead:
        """Read all rows, each with the number of its line."""
        stream = iter(rows)
        last = 0
        while piece := list(islice(stream, PIECE)):
            self._take(piece)
            last = piece[-1][0]
        self.columns_read.refused.is_last = (
            self.columns_read.refused.count > 0 and self.columns_read.refused.line == last
        )
        self.columns_read.began, self.columns_read.counted = self._clock.began, self._clock.counted
        return self.columns_read

    def _take(self, piece: list[tuple[int, list[str]]]) -> None:
        for index, value in self._columns.where:
            piece = self._selected([(line, row) for line, row in piece if len(row) > index], index, value)
        if self._columns.where and piece and not self._is_selected:
            self._is_selected = True  # rows of a kind may have another width than most rows
            self._width = Counter(len(row) for _, row in piece).most_common(1)[0][0]
        fits = self._width >= self._needed
        good = [r for r in piece if (fits and len(r[1]) == self._width) or self._accept_row(*r)]
        if not good:
            return
        self._remove_groups([row for _, row in good])
        try:
            rows = [row for _, row in good]
            self._keep(*self._converted(rows))
        except ValueError:
            for line, row in good:
                self._take_alone(line, row)

    def _selected(self, rows: list[tuple[int, list[str]]], index: int, value: str) -> list[tuple[int, list[str]]]:
        """Rows with a value in a column; numbers compare as numbers."""
        present = dict.fromkeys(row[index].strip() for _, row in rows)
        values = {cell for cell in present if is_value(cell, value)}
        for cell in list(present)[:VALUES_SHOWN] if not values else ():
            self.columns_read.rejected[cell] = None
        return [(line, row) for line, row in rows if row[index].strip() in values]

    def _remove_groups(self, rows: Sequence[list[str]]) -> None:
        """Remove the marks between thousands from a column that has only such numbers."""
        mark, thousands = (",", ".") if self._comma else (".", ",")
        for index in {column.index for column in self._columns.used}:
            joined = "".join(row[index] for row in rows)
            has_marks = thousands in joined or not joined.isascii() or " " in joined or "'" in joined
            if has_marks and all(GROUPED[mark].fullmatch(row[index].strip()) for row in rows):
                for row in rows:
                    row[index] = re.sub(f"[{SPACES}{thousands}]", "", row[index])

    def _take_alone(self, line: int, row: list[str]) -> None:
        try:
            values, kept = self._converted([row])
        except ValueError as error:
            if [cell.strip() for cell in row] == list(self._head.labels):
                self.columns_read.headers += 1
            else:
                self.columns_read.refused.add(line, self._why(row, error))
        else:
            self._keep(values, kept)

    def _accept_row(self, line: int, row: list[str]) -> bool:
        """Accept a row with one delimiter too many at its end; count every other row of a wrong width."""
        if len(row) == self._width + 1 > self._needed and not row[-1].strip():
            row.pop()
            return True
        labels = len(self._head.labels) or self._width
        if [cell.strip() for cell in row] == list(self._head.labels):
            self.columns_read.headers += 1
        else:
            zeros = any("\0" in cell for cell in row)
            expected = (
                f"the header has {labels} columns" if self._width >= self._needed else f"{self._needed} are named"
            )
            reason = f"has {len(row)} values, {expected}"
            self.columns_read.refused.add(line, "has zero bytes" if zeros else reason)
        return False

    def _converted(self, rows: Sequence[Sequence[str]]) -> tuple[dict[str, Floats], Sequence[Sequence[str]]]:
        """Values by their target, and the rows that have a rate."""
        cells = list(zip(*rows, strict=True))
        values = {column.target: self._numbers(column, cells[column.index]) for column in self._values}
        if self._clocks:  # last, since it remembers what it has read
            stamps = [self._stamps(cells[column.index]) for column in self._clocks]
            values["t_device_s"] = np.array(self._clock.read(stamps))
        if self._keeps_empty:
            return values, rows
        has_rate = ~np.isnan(values[self._moved])
        for column in self._columns.aids:  # a row may have a second source alone
            has_rate |= np.isfinite(values[column.meaning])
        if has_rate.all():
            return values, rows
        self.columns_read.without_rate += int((~has_rate).sum())
        kept = [row for row, has in zip(rows, has_rate.tolist(), strict=True) if has]
        return {target: numbers[has_rate] for target, numbers in values.items()}, kept

    def _numbers(self, taken: UsedColumn, cells: Sequence[str]) -> Floats:
        numbers = _floats(self._points(cells))
        if taken.target in RATE_TARGETS and has_16_bits(taken.scale):
            numbers = np.where(numbers >= INT16_COUNTS, numbers - 2 * INT16_COUNTS, numbers)
        with np.errstate(over="ignore"):
            return numbers if taken.scale == 1.0 else numbers * taken.scale

    def _stamps(self, cells: Sequence[str]) -> Sequence[str]:
        return cells if is_stamp(cells[0].strip()) else self._points(cells)

    def _points(self, cells: Sequence[str]) -> Sequence[str]:
        """Cells with decimal points; refuses cells with both marks, and `_`, which only Python allows in numbers."""
        joined = "\n".join(cells)
        if "_" in joined or (self._comma and "." in joined):
            raise WrongCellError
        return joined.replace(",", ".").split("\n") if self._comma and "," in joined else cells

    def _keep(self, values: dict[str, Floats], rows: Sequence[Sequence[str]]) -> None:
        if rows and "t_device_s" in values:
            self._note_edges(values["t_device_s"], rows)
        for target, column in values.items():
            self.columns_read.pieces[target].append(column)
        self.columns_read.count += len(next(iter(values.values())))

    def _note_edges(self, t_s: Floats, rows: Sequence[Sequence[str]]) -> None:
        """Keep the rows at which a block of rows may begin or end."""
        read = self.columns_read
        edges = read.edges or [rows[0], rows[0]]
        *inner, last = edges
        for index in np.flatnonzero(np.diff(t_s, prepend=read.last_s) < 0.0)[:BLOCKS_MAX].tolist():
            inner += [rows[index - 1] if index else last, rows[index]]
        read.edges, read.last_s = [*inner[: 2 * BLOCKS_MAX], rows[-1]], float(t_s[-1])

    def _why(self, row: Sequence[str], error: ValueError) -> str:
        """Reason why a row is refused: its first wrong cell."""
        if any("\0" in cell for cell in row):
            return "has zero bytes"
        for column in self._columns.used:
            try:
                if column in self._values:
                    self._numbers(column, [row[column.index]])
                else:
                    ClockReader([column.unit]).read([self._stamps([row[column.index]])])
            except ValueError:
                labels = self._head.labels
                label = labels[column.index].strip() if column.index < len(labels) else f"column {column.index + 1}"
                expected = "a number" if column in self._values else f"a time: {FORMS}"
                shown = shortened(row[column.index], CELL_SHOWN)
                return f"{visible(shortened(label, CELL_SHOWN))} is {shown!r}, expected {expected}"
        return str(error)


def _floats(cells: Sequence[str]) -> Floats:
    """Numbers, NaN for empty cells."""
    try:
        return np.array(list(map(float, cells)), dtype=np.float64)
    except ValueError:
        return np.array([float(cell) if cell.strip() else nan for cell in cells], dtype=np.float64)
