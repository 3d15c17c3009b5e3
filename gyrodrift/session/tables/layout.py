"""Layout of a table: delimiter and decimal mark, preamble, rows of names and units, and first row."""

import csv
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

from gyrodrift.columns.fields import Form, is_hex
from gyrodrift.columns.log_prefix import LABEL as PREFIX_LABEL
from gyrodrift.columns.log_prefix import SENDER_LABEL, Prefixed, PrefixReader
from gyrodrift.columns.times import is_time
from gyrodrift.columns.units import unit_in, unit_of
from gyrodrift.session.csv import MOST_COLUMNS, REQUIRED
from gyrodrift.session.tables.labeled_text import TextLayout, text_layout
from gyrodrift.session.tables.plan import Head
from gyrodrift.session.tables.text import COMMENT, Lines, NoTableError, opened
from gyrodrift.values.errors import DataError, shortened

LOOKED_AT, MORE_OF_TEXT = 1000, 4000
"""Lines of the beginning to detect the layout from: preambles of flight logs have about 150, samples of YAML 30."""

COMMENT_MARKS = "#/ \t"

DELIMITERS = (",", ";", "\t", "|", " ")
"""Preferred ones first; a space stands for any number of spaces and tabs."""

SPACES = re.compile(r"[ \t]+")
NUMBER = re.compile(r"[-+]?(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:[eE][-+]?\d+)?|[-+]?(?:nan|inf|NaN|NAN|INF|Inf)")
COMMA_DECIMAL = re.compile(r"[-+]?\d*,\d+(?:[eE][-+]?\d+)?")
LAST_LINES = 50
"""Lines used for the detection, the last ones of the sample, which lie after a preamble."""

LONGEST_NUMBER = 64
LINE_SHOWN = 60

MOSTLY = 0.75
"""A table with a smaller share of values may be a text with labels: `gx: 1 gy: 2` has a half."""

USUALLY = 0.9
"""Share of the rows with a value in a column of values."""

HEADER_ROWS = 4
"""Most rows of names, units and groups: RaceChrono has three, Shimmer and LabVIEW four."""

AXIS = re.compile(r"[xyzXYZ]\d?")
INNER_BRACKETS = re.compile(r"[()\[\]]")


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
    has_prefix, has_stamp, has_sender
        Whether a terminal or a log has put a prefix in front of each line. Clock and sender of it are the last columns.
    """

    dialect: Dialect
    head: Head
    first_line: int
    has_prefix: bool = False
    has_stamp: bool = False
    has_sender: bool = False

    has_comments = False

    @property
    def has_decimal_comma(self) -> bool:
        """Whether the decimal mark is a comma."""
        return self.dialect.has_decimal_comma

    def __str__(self) -> str:
        return str(self.dialect)

    def rows(self, lines: Lines) -> Iterator[tuple[int, list[str]]]:
        """Rows with the numbers of their lines."""
        contents = (line for line in lines if lines.number >= self.first_line)
        if not self.has_prefix:
            for row in split(contents, self.dialect.delimiter):
                yield lines.number, row
            return
        prefix = PrefixReader()
        for line in contents:
            prefixed = prefix.split(line.strip())
            for row in split([prefixed.rest], self.dialect.delimiter):
                yield lines.number, [*row, *_tail(prefixed, has_stamp=self.has_stamp, has_sender=self.has_sender)]


def _tail(prefixed: Prefixed, *, has_stamp: bool, has_sender: bool) -> list[str]:
    """Cells of a prefix."""
    return [prefixed.stamp] * has_stamp + [prefixed.sender] * has_sender


def layout_of(path: Path, *, is_by_position: bool = False) -> TableLayout | TextLayout:
    """Detect the layout of a table, or of a text as a device prints it, from its beginning.

    Parameters
    ----------
    is_by_position
        Whether columns count by position, so that a word before a row is a column too.

    Raises
    ------
    DataError
        It cannot be read, is empty, is not text, or has no rows.
    """
    with opened(path) as file:
        lines = Lines(file)
        sample, further = (
            [(lines.number, line) for line in islice(lines, most) if line.strip("\0 \t\r\n")]
            for most in (LOOKED_AT, MORE_OF_TEXT)
        )
    table = _table(path, sample, lines.comments) if sample else None
    if 2 * sum(is_hex(line.strip()) for _, line in sample) > len(sample):
        raise NoTableError(f"{path}: its numbers are hexadecimal; let the device print decimal numbers")
    if table is not None and _share(table.head.rows) >= MOSTLY:
        return table
    marked = [(number, line.lstrip(f"{COMMENT} ")) for number, line in lines.comments]
    text = text_layout(path, [*sample, *further]) if sample else text_layout(path, marked, has_comments=True)
    has_names = table is not None and (table.head.labels or is_by_position or text is None or not text.head.labels)
    layout = table if has_names and (text is None or text.form is Form.ROW) else text
    if layout is None:
        raise NoTableError(f"{path}: {_why_no_rows([line.strip() for _, line in sample])}")
    return layout


def _why_no_rows(lines: Sequence[str]) -> str:
    if not lines:
        return f"is empty; expected a header with {', '.join(REQUIRED)}"
    if len(lines) == 1:
        return "has a header and no samples"
    last = shortened(lines[-1], LINE_SHOWN)
    return f"has no samples: no rows of numbers and no labels with numbers, but lines such as {last!r}"


def _share(rows: Sequence[Sequence[str]]) -> float:
    """Share of the filled cells that are values."""
    cells = [cell for row in rows for cell in row if cell]
    return sum(map(is_value, cells)) / max(1, len(cells))


def _table(path: Path, sample: Sequence[tuple[int, str]], comments: Sequence[tuple[int, str]]) -> TableLayout | None:
    """Layout of rows; None without rows of values."""
    numbers, lines = zip(*sample, strict=True)
    prefix = PrefixReader()
    prefixed = [prefix.split(line.strip()) for line in lines]
    has_prefix = 2 * sum(part.rest != line.strip() for part, line in zip(prefixed, lines, strict=True)) > len(lines)
    has_stamp = has_prefix and 2 * sum(bool(part.stamp) for part in prefixed) > len(lines)
    texts = [part.rest for part in prefixed] if has_prefix else list(lines)
    dialect = dialect_of(texts)
    rows = [[cell.strip() for cell in row] for row in split(texts, dialect.delimiter)]
    width = width_of(rows)
    if width > MOST_COLUMNS:
        raise DataError(f"{path}:{numbers[0]}: has {width} columns, more than {MOST_COLUMNS}: it is no session")
    first = _first_row(rows, width)
    if first is None:
        return None
    before = [_refitted(row, text, width) for row, text in zip(rows[:first], texts, strict=False)]
    labels, line = _header(before, numbers, width, rows[first][0]) or _commented(comments, dialect, width)
    kept = [(row, part) for row, part in zip(rows[first:], prefixed[first:], strict=True) if len(row) == width]
    labels = _with_preamble_units(_fitted(labels, [row for row, _ in kept]), before)
    has_sender = has_prefix and 2 * sum(bool(part.sender) for part in prefixed) > len(lines)
    if has_stamp:
        labels = _with_stamps(labels, kept)
    if has_sender and labels:
        labels = (*labels, SENDER_LABEL)
    shown = tuple([*row, *_tail(part, has_stamp=has_stamp, has_sender=has_sender)] for row, part in kept)
    width += has_stamp + has_sender
    preamble = {row[0]: row[1] for row in before if len(row) == 2}
    head = Head(path, labels, width, line, shown, preamble)
    return TableLayout(dialect, head, numbers[first], has_prefix, has_stamp, has_sender)


def _with_stamps(labels: tuple[str, ...], kept: Sequence[tuple[list[str], Prefixed]]) -> tuple[str, ...]:
    unit = next((part.unit for _, part in kept if part.stamp), "")
    return (*labels, _with_unit(PREFIX_LABEL, unit)) if labels else ()


def _first_row(rows: Sequence[list[str]], width: int) -> int | None:
    """Index of the first row with values where nearly all rows have them; pairs of a preamble have words there."""
    regular = [row for row in rows if len(row) == width and is_data(row)]
    usual = [i for i in range(width) if sum(is_value(row[i]) for row in regular) >= USUALLY * len(regular)]
    return next(
        (
            index
            for index, row in enumerate(rows)
            if len(row) == width and is_data(row) and all(is_value(row[i]) or not row[i] for i in usual)
        ),
        None,
    )


def _refitted(row: list[str], text: str, width: int, within: int = 1) -> list[str]:
    """Row before the data, split at its own delimiter if only that gives the width of the data."""
    if abs(len(row) - width) <= within or width < 3:
        return row
    rows = (next(split([text.strip()], delimiter), []) for delimiter in DELIMITERS)
    return next(([cell.strip() for cell in cells] for cells in rows if len(cells) == width), row)


def _header(
    before: Sequence[list[str]], numbers: Sequence[int], width: int, word: str
) -> tuple[tuple[str, ...], int] | None:
    """Labels from the last rows of words before the data, and the line of the names.

    Of the headers of several kinds of rows, that counts which begins with the same word as the data.

    The row with most different words has the names. Rows of units are added to them. Words of other rows, such as
    `GYRO` above `X Y Z`, are added to names of axes, and to names that stand for several columns.
    """
    likely = [index for index, row in enumerate(before) if abs(len(row) - width) <= 1 < len(row) and not is_data(row)][
        -HEADER_ROWS:
    ]
    if not likely:
        return None
    own = [index for index in likely if before[index][0] == word != "" and len(before[index]) == width]
    block = own[-1:] or [index for index in likely if len(before[index]) == len(before[likely[-1]])]
    named_at = max(block, key=lambda index: (_count_names(before[index]), -before[index].count(""), index))
    names = list(before[named_at])
    for index in block:
        if index != named_at and not _is_units(before[index]):
            names = _grouped(names, before[index], is_above=index < named_at)
    for index in block:
        if index != named_at and abs(index - named_at) <= HEADER_ROWS and _is_units(before[index]):
            names = [_with_unit(*pair) for pair in zip(names, before[index], strict=True)]
    return tuple(names), numbers[named_at]


def _count_names(row: Sequence[str]) -> int:
    """Number of different words that are no units."""
    return len({cell for cell in row if cell and unit_of(INNER_BRACKETS.sub("", cell)) is None and not is_value(cell)})


def _is_units(row: Sequence[str]) -> bool:
    """Whether at least half of the filled cells are units."""
    filled = [cell for cell in row if cell]
    return bool(filled) and 2 * sum(unit_of(INNER_BRACKETS.sub("", cell)) is not None for cell in filled) >= len(filled)


def _grouped(names: list[str], words: Sequence[str], *, is_above: bool) -> list[str]:
    """Names of axes, and names that come more than once, with the words of another row; above, a word spans blanks."""
    counts = Counter(names)
    full, word = [], ""
    for name, cell in zip(names, words, strict=True):
        word = cell or (word if is_above else "")
        needs_word = counts[name] > 1 or (is_above and AXIS.fullmatch(name))
        full.append(f"{word} {name}" if word and name and needs_word else name)
    return full


def _with_unit(label: str, unit: str) -> str:
    """Label with its unit in brackets, unless it has one."""
    unit = INNER_BRACKETS.sub("", unit)
    return label if not label or unit_in(label) or unit_of(unit) is None else f"{label} ({unit})"


def _with_preamble_units(labels: tuple[str, ...], before: Sequence[list[str]]) -> tuple[str, ...]:
    """Labels with units of a preamble that has one for each channel after the clock: `Y_Unit_Label, deg/s`."""
    for name, *units in before:
        filled = [unit for unit in units if unit]
        if "unit" in name.lower() and len(filled) == len(labels) - 1 and _is_units(filled):
            return (labels[0], *(_with_unit(*pair) for pair in zip(labels[1:], filled, strict=True)))
    return labels


def _commented(comments: Sequence[tuple[int, str]], dialect: Dialect, width: int) -> tuple[tuple[str, ...], int]:
    """Header in a comment, as some programs write it; empty if no comment has as many cells."""
    for number, line in reversed(comments):
        text = line.lstrip(COMMENT_MARKS)
        row = _refitted(next(iter(split([text], dialect.delimiter)), []), text, width, within=0)
        if len(row) == width and width > 1 and not is_data(row):
            return tuple(cell.strip() for cell in row), number
    return (), 0


def _fitted(labels: tuple[str, ...], rows: Sequence[list[str]]) -> tuple[str, ...]:
    """Labels for rows with an extra cell: after a delimiter at the end, or the row names that R writes."""
    if not rows or not labels:
        return labels
    width = len(rows[0])
    if len(labels) == width + 1 and labels[-1].lower() in {"", "comment"}:  # LabVIEW comments the first row only
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
