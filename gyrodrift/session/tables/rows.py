"""Rows of text as columns of numbers: the good ones are kept, the bad ones counted, and the first of them named."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import islice
from math import nan

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.errors import shortened, visible
from gyrodrift.session.tables.plan import OWN, Head, TableColumns, Taken
from gyrodrift.session.tables.times import StampReader

PIECE = 20_000
"""Rows that are converted at once."""

CELL_SHOWN = 40


class WrongCellError(ValueError):
    """A row cannot be a sample; the text says why."""


@dataclass(slots=True)
class Refused:
    """Rows that are no samples: how many, where and why the first, and whether it is the last row of all."""

    count: int = 0
    line: int = 0
    why: str = ""
    is_last: bool = False

    def add(self, line: int, why: str) -> None:
        """Count one."""
        if not self.count:
            self.line, self.why = line, why
        self.count += 1


@dataclass(slots=True)
class ColumnsRead:
    """The columns of a table while they fill.

    began
        First stamp, where the clock counts from it.
    """

    pieces: dict[str, list[Floats]]
    refused: Refused = field(default_factory=Refused)
    headers: int = 0
    without_rate: int = 0
    count: int = 0
    began: str = ""

    def column(self, target: str) -> Floats | None:
        """All of a column; None where it is not taken."""
        return np.concatenate(self.pieces[target] or [np.empty(0)]) if target in self.pieces else None


class RowReader:
    """Converts the rows of one table; `keeps_empty` keeps rows without a rate, which sessions of ours may have."""

    def __init__(self, head: Head, columns: TableColumns, *, has_decimal_comma: bool, keeps_empty: bool) -> None:
        self.found = ColumnsRead({each.target: [] for each in columns.taken})
        self._head, self._columns, self._comma = head, columns, has_decimal_comma
        self._keeps_empty = keeps_empty
        self._clock = next(each for each in columns.taken if each.target == "t_device_s")
        self._stamps = StampReader(self._clock.unit)
        self._moved = next(name for name in ("rate_dps", "yaw_deg", "qw") if name in columns.targets)

    def read(self, rows: Iterable[tuple[int, list[str]]]) -> ColumnsRead:
        """All rows, with the numbers of their lines."""
        stream = iter(rows)
        last = 0
        while piece := list(islice(stream, PIECE)):
            self._take(piece)
            last = piece[-1][0]
        self.found.refused.is_last = self.found.refused.count > 0 and self.found.refused.line == last
        self.found.began = self._stamps.began
        return self.found

    def _take(self, piece: list[tuple[int, list[str]]]) -> None:
        width, where = self._head.width, self._columns.where
        good = [(line, row) for line, row in piece if len(row) == width or self._is_row(line, row)]
        if where is not None:
            good = [(line, row) for line, row in good if row[where[0]] == where[1]]
        if not good:
            return
        try:
            self._keep(self._converted([row for _, row in good]))
        except ValueError:
            for line, row in good:
                self._take_alone(line, row)

    def _take_alone(self, line: int, row: list[str]) -> None:
        try:
            values = self._converted([row])
        except ValueError as error:
            if [cell.strip() for cell in row] == list(self._head.labels):
                self.found.headers += 1
            else:
                self.found.refused.add(line, self._why(row, error))
        else:
            self._keep(values)

    def _is_row(self, line: int, row: list[str]) -> bool:
        """Whether a row of another width is one: with a delimiter at its end. Others are counted."""
        if len(row) == self._head.width + 1 and not row[-1].strip():
            row.pop()
            return True
        labels = len(self._head.labels) or self._head.width
        if [cell.strip() for cell in row] == list(self._head.labels):
            self.found.headers += 1
        else:
            zeros = any("\0" in cell for cell in row)
            said = f"has {len(row)} values, the header has {labels} columns"
            self.found.refused.add(line, "has zero bytes" if zeros else said)
        return False

    def _converted(self, rows: Sequence[Sequence[str]]) -> dict[str, Floats]:
        cells = list(zip(*rows, strict=True))
        values = {each.target: self._numbers(each, cells[each.index]) for each in self._columns.taken}
        if self._keeps_empty:
            return values
        is_known = ~np.isnan(values[self._moved])
        self.found.without_rate += int((~is_known).sum())
        return {target: column[is_known] for target, column in values.items()}

    def _numbers(self, taken: Taken, cells: Sequence[str]) -> Floats:
        if taken.target == "t_device_s" and self._columns.form != OWN:
            return self._stamps.read(cells if ":" in cells[0] else self._points(cells))
        numbers = _floats(self._points(cells))
        with np.errstate(over="ignore"):
            return numbers if taken.scale == 1.0 else numbers * taken.scale

    def _points(self, cells: Sequence[str]) -> Sequence[str]:
        """Cells with decimal points; none has both marks, and none a `_`, which Python alone takes for a digit."""
        joined = "\n".join(cells)
        if "_" in joined or (self._comma and "." in joined):
            raise WrongCellError
        return joined.replace(",", ".").split("\n") if self._comma and "," in joined else cells

    def _keep(self, values: dict[str, Floats]) -> None:
        for target, column in values.items():
            self.found.pieces[target].append(column)
        self.found.count += len(next(iter(values.values())))

    def _why(self, row: Sequence[str], error: ValueError) -> str:
        """The first cell that is none of what it is to be."""
        if any("\0" in cell for cell in row):
            return "has zero bytes"
        for each in self._columns.taken:
            try:
                self._numbers(each, [row[each.index]])
            except ValueError:
                labels = self._head.labels
                label = labels[each.index].strip() if each.index < len(labels) else f"column {each.index + 1}"
                expected = "a time" if each.target == "t_device_s" else "a number"
                shown = shortened(row[each.index], CELL_SHOWN)
                return f"{visible(shortened(label, CELL_SHOWN))} is {shown!r}, expected {expected}"
        return str(error)


def _floats(cells: Sequence[str]) -> Floats:
    """Numbers, NaN for empty cells."""
    try:
        return np.array(list(map(float, cells)), dtype=np.float64)
    except ValueError:
        return np.array([float(cell) if cell.strip() else nan for cell in cells], dtype=np.float64)
