"""Layout of a table: delimiter and decimal mark, preamble, header, line of units, and first row."""

import csv
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

from gyrodrift.columns.times import is_time
from gyrodrift.columns.units import unit_of
from gyrodrift.session.csv import MOST_COLUMNS, REQUIRED
from gyrodrift.session.tables.plan import Head
from gyrodrift.session.tables.text import Lines, opened
from gyrodrift.values.errors import DataError

LOOKED_AT = 1000
"""Lines of the beginning to detect the layout from; preambles of flight logs have about 150."""

COMMENT_MARKS = "#/ \t"

DELIMITERS = (",", ";", "\t", "|", " ")
"""Preferred ones first; a space stands for any number of spaces and tabs."""

SPACES = re.compile(r"[ \t]+")
NUMBER = re.compile(r"[-+]?(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:[eE][-+]?\d+)?|[-+]?(?:nan|inf|NaN|NAN|INF|Inf)")
COMMA_DECIMAL = re.compile(r"[-+]?\d*,\d+(?:[eE][-+]?\d+)?")
LAST_LINES = 50
"""Lines used for the detection, the last ones of the sample, which lie after a preamble."""

LONGEST_NUMBER = 64


@dataclass(frozen=True, slots=True)
class Dialect:
    """Delimiter, and whether the decimal mark is a comma."""

    delimiter: str
    has_decimal_comma: bool = False

    def __str__(self) -> str:
        names = {",": "commas", ";": "semicolons", "\t": "tabs", "|": "bars", " ": "spaces"}
        return f"{names[self.delimiter]}{' and decimal commas' if self.has_decimal_comma else ''}"


@dataclass(frozen=True, slots=True)
class TableLayout:
    """How the text of a table is split into rows.

    first_line
        Number of the first possible row.
    """

    dialect: Dialect
    head: Head
    first_line: int


def layout_of(path: Path) -> TableLayout:
    """Detect the layout from the beginning of a table.

    Raises
    ------
    DataError
        It cannot be read, is empty, is not text, or has no rows.
    """
    with opened(path) as file:
        lines = Lines(file)
        sample = [(lines.number, line) for line in islice(lines, LOOKED_AT) if line.strip("\0 \t\r\n")]
    if not sample and not lines.comments:
        raise DataError(f"{path}: is empty; expected a header with {', '.join(REQUIRED)}")
    texts = [line for _, line in sample]
    dialect = dialect_of(texts)
    rows = [[cell.strip() for cell in row] for row in split(texts, dialect.delimiter)]
    width = width_of(rows)
    if width > MOST_COLUMNS:
        raise DataError(f"{path}:{sample[0][0]}: has {width} columns, more than {MOST_COLUMNS}: it is no session")
    first = next((index for index, row in enumerate(rows) if len(row) == width and is_data(row)), None)
    if first is None:
        reason = "has a header and no samples" if sample else f"is empty; expected a header with {', '.join(REQUIRED)}"
        raise DataError(f"{path}: {reason}")
    labels, line = _header(rows[:first], [number for number, _ in sample], width) or _commented(lines, dialect, width)
    labels = _fitted(labels, [row for row in rows[first:] if len(row) == width])
    preamble = {row[0]: row[1] for row in rows[:first] if len(row) == 2}
    kept = tuple(row for row in rows[first:] if len(row) == width)
    return TableLayout(dialect, Head(path, labels, width, line, kept, preamble), sample[first][0])


def _header(before: Sequence[list[str]], numbers: Sequence[int], width: int) -> tuple[tuple[str, ...], int] | None:
    """Last row of words before the data, joined with a line of units after it."""
    likely = [index for index, row in enumerate(before) if abs(len(row) - width) <= 1 and len(row) > 1]
    if not likely:
        return None
    index = likely[-1]
    row = before[index]
    if index - 1 in likely and len(before[index - 1]) == len(row) and _is_units(row):
        row, index = [_with_unit(*pair) for pair in zip(before[index - 1], row, strict=True)], index - 1
    return tuple(row), numbers[index]


def _is_units(row: Sequence[str]) -> bool:
    filled = [cell for cell in row if cell]
    return bool(filled) and all(unit_of(cell.strip("()[]")) is not None for cell in filled)


def _with_unit(label: str, unit: str) -> str:
    return f"{label} ({unit.strip('()[]')})" if unit else label


def _commented(lines: Lines, dialect: Dialect, width: int) -> tuple[tuple[str, ...], int]:
    """Header in a comment, as some programs write it; empty if no comment has as many cells."""
    for number, line in reversed(lines.comments):
        row = next(iter(split([line.lstrip(COMMENT_MARKS)], dialect.delimiter)), [])
        if len(row) == width and width > 1 and not is_data(row):
            return tuple(cell.strip() for cell in row), number
    return (), 0


def _fitted(labels: tuple[str, ...], rows: Sequence[list[str]]) -> tuple[str, ...]:
    """Labels for rows with an extra cell: after a delimiter at the end, or the row names that R writes."""
    if not rows or not labels:
        return labels
    width = len(rows[0])
    if len(labels) == width + 1 and not labels[-1]:
        return labels[:-1]
    if len(labels) != width - 1:
        return labels
    if all(not row[-1] for row in rows):
        return (*labels, "")
    counts = [row[0] for row in rows]
    return ("", *labels) if counts == [str(number) for number in range(1, len(rows) + 1)] else labels


def is_value(cell: str) -> bool:
    """Whether a cell is a number or a time of day."""
    cell = cell.strip()
    return len(cell) <= LONGEST_NUMBER and (NUMBER.fullmatch(cell) is not None or is_time(cell))


def is_data(row: Sequence[str]) -> bool:
    """Whether at least half of the non-empty cells are values."""
    filled = [cell for cell in row if cell.strip()]
    return bool(filled) and 2 * sum(map(is_value, filled)) >= len(filled)


def split(lines: Iterable[str], delimiter: str) -> Iterator[list[str]]:
    """Split lines into rows; a line with an odd number of quotes loses its quotes, which would join lines."""
    even = (line if line.count('"') % 2 == 0 else line.replace('"', "") for line in lines)
    if delimiter == " ":
        even, delimiter = (SPACES.sub("\t", line.strip()) for line in even), "\t"
    return csv.reader(even, delimiter=delimiter, skipinitialspace=delimiter != "\t")


def dialect_of(lines: Sequence[str]) -> Dialect:
    """Dialect in which most cells of the last lines are values."""
    last = lines[-LAST_LINES:]
    delimiter = max(DELIMITERS, key=lambda mark: _score(last, mark))
    rows = list(split(last, delimiter))
    cells = [cell.strip() for row in rows for cell in row if is_value(cell) and not is_time(cell)]
    with_comma = sum(COMMA_DECIMAL.fullmatch(cell) is not None for cell in cells)
    return Dialect(delimiter, with_comma > sum("." in cell for cell in cells))


def width_of(rows: Sequence[Sequence[str]]) -> int:
    """Most frequent number of cells; only rows with data count if there are any."""
    counts = Counter(len(row) for row in rows if is_data(row)) or Counter(map(len, rows))
    return counts.most_common(1)[0][0] if counts else 0


def _score(lines: Sequence[str], delimiter: str) -> tuple[float, int]:
    """Share of values in rows of the most frequent width, less the cells with another delimiter; and this width."""
    rows = list(split(lines, delimiter))
    width = width_of(rows)
    regular = [row for row in rows if len(row) == width]
    cells = [cell for row in regular for cell in row if cell.strip()]
    if width < 2 or not cells:
        return 0.0, 0
    values = sum(map(is_value, cells)) - sum(any(mark in cell for mark in ";\t|") for cell in cells)
    share = max(0.0, values / len(cells) * len(regular) / len(rows))
    return (share or 1e-9), width
