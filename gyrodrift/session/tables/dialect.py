"""Dialect of a table: delimiter of its cells and decimal mark, detected from its lines."""

import csv
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from gyrodrift.session.tables.times import is_time

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
