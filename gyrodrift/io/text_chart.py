"""A line chart of text for terminals: braille dots, axes with round numbers, and lines that differ by their style."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise
from math import ceil, floor, log10
from typing import NamedTuple

from rich.text import Text

DOTS = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))
"""Bits of the braille dots of a character, by row and column (Unicode block U+2800)."""

DASH_DOTS = 3
"""Length of a dash and of the gap behind it, in dots."""

X_AXIS_ROWS = 2
SMALLEST_ROWS = 5
ROWS_PER_TICK, COLUMNS_PER_TICK = 4, 14

Cells = dict[tuple[int, int], tuple[int, str]]


class AxisRange(NamedTuple):
    """Values that an axis shows."""

    low: float
    high: float


@dataclass(frozen=True, slots=True)
class ChartLine:
    """One line of a chart.

    points
        (x, y) in rising order of x.
    color
        Style of rich.
    """

    name: str
    points: Sequence[tuple[float, float]]
    color: str
    is_dashed: bool = False

    @property
    def key(self) -> str:
        """Sample of the line for a legend."""
        return "╌╌" if self.is_dashed else "──"


def padded_range(values: Sequence[float], least_span: float) -> AxisRange:
    """AxisRange of the values, at least this wide, to whole ticks."""
    low, high = min(values, default=0.0), max(values, default=0.0)
    extra = max(0.0, 0.5 * (least_span - (high - low)))
    step = tick_step(high - low + 2.0 * extra, 8)
    return AxisRange(floor((low - extra) / step) * step, ceil((high + extra) / step) * step)


def tick_step(span: float, most: int) -> float:
    """Smallest of 1, 2 and 5 times a power of ten that gives at most this many steps."""
    raw = max(span, 1e-12) / max(1, most)
    power: float = 10.0 ** floor(log10(raw))
    return next(factor * power for factor in (1.0, 2.0, 5.0, 10.0) if factor * power >= raw * (1.0 - 1e-9))


def ticks(shown: AxisRange, most: int) -> list[float]:
    """Round values inside a range."""
    step = tick_step(shown.high - shown.low, most)
    first, last = ceil(shown.low / step - 1e-9), floor(shown.high / step + 1e-9)
    return [index * step for index in range(first, last + 1)]


def legend(series: Sequence[ChartLine], title: str) -> Text:
    """The title, then each line's sample and name."""
    parts = [part for line in series for part in ("   ", (f"{line.key} {line.name}", line.color))]
    return Text.assemble(title, *parts)


def chart(series: Sequence[ChartLine], x_range: AxisRange, y_range: AxisRange, columns: int, rows: int) -> list[Text]:
    """Rows of text with the axes; `rows` is at least SMALLEST_ROWS."""
    plot_rows = rows - X_AXIS_ROWS
    labels = _y_labels(y_range, plot_rows)
    width = max(map(len, labels.values()))
    plot_columns = columns - width - 2
    cells = _cells(series, x_range, y_range, plot_columns, plot_rows)
    lines = []
    for row in range(plot_rows):
        axis = f"{labels.get(row, ''):>{width}} {'┤' if row in labels else '│'}"
        blank = "┈" if row in labels and float(labels[row]) == 0.0 else " "
        lines.append(Text.assemble((axis, "dim"), *_runs(cells, row, plot_columns, blank)))
    return [*lines, *_x_axis(x_range, width + 1, plot_columns)]


def _y_labels(shown: AxisRange, rows: int) -> dict[int, str]:
    """Label of each row that has one."""
    values = ticks(shown, max(3, rows // ROWS_PER_TICK + 1))
    digits = _digits(values)
    return {_row(value, shown, rows): _label(value, digits) for value in values}


def _row(value: float, shown: AxisRange, rows: int) -> int:
    return min(rows - 1, _dot(value, shown, 4 * rows) // 4)


def _dot(value: float, shown: AxisRange, dots: int) -> int:
    """Row of dots from the top."""
    share = (shown.high - value) / (shown.high - shown.low)
    return max(0, min(dots - 1, round(share * (dots - 1))))


def _x_axis(shown: AxisRange, indent: int, columns: int) -> list[Text]:
    values = ticks(shown, max(2, columns // COLUMNS_PER_TICK))
    digits = _digits(values)
    line, labels = ["─"] * columns, [" "] * (columns + indent + 1)
    for value in values:
        column = round((value - shown.low) / (shown.high - shown.low) * (columns - 1))
        line[column] = "┬"
        text = _label(value, digits)
        start = max(0, min(len(labels) - len(text), indent + 1 + column - len(text) // 2))
        labels[start : start + len(text)] = text
    return [Text(" " * indent + "└" + "".join(line), "dim"), Text("".join(labels), "dim")]


def _digits(values: Sequence[float]) -> int:
    step = values[1] - values[0] if len(values) > 1 else 1.0
    return max(0, -floor(log10(step) + 1e-9))


def _label(value: float, digits: int) -> str:
    return f"{round(value, digits) + 0.0:.{digits}f}"  # + 0.0: no -0


def _cells(series: Sequence[ChartLine], x_range: AxisRange, y_range: AxisRange, columns: int, rows: int) -> Cells:
    """Dots and color of each character that has some, by row and column; a later line covers an earlier."""
    cells: Cells = {}
    for line in series:
        for x, y in _line_dots(line, x_range, y_range, columns, rows):
            bits, _ = cells.get((y // 4, x // 2), (0, ""))
            cells[y // 4, x // 2] = (bits | DOTS[y % 4][x % 2], line.color)
    return cells


def _line_dots(
    line: ChartLine, x_range: AxisRange, y_range: AxisRange, columns: int, rows: int
) -> Iterator[tuple[int, int]]:
    """Dots of a line, without those in the gaps of a dashed one."""
    wide = 2 * columns
    newest: dict[int, float] = {}
    for x, y in line.points:
        newest[min(wide - 1, round((x - x_range.low) / (x_range.high - x_range.low) * (wide - 1)))] = y
    dots = [(x, _dot(y, y_range, 4 * rows)) for x, y in newest.items() if x >= 0]
    for x, y in _joined(dots):
        if not (line.is_dashed and (x + y) // DASH_DOTS % 2):
            yield x, y


def _joined(dots: Sequence[tuple[int, int]]) -> Iterator[tuple[int, int]]:
    """The dots and the straight way between them."""
    yield from dots[:1]
    for (x0, y0), (x1, y1) in pairwise(dots):
        steps = max(abs(x1 - x0), abs(y1 - y0), 1)
        for step in range(1, steps + 1):
            yield x0 + round((x1 - x0) * step / steps), y0 + round((y1 - y0) * step / steps)


def _runs(cells: Cells, row: int, columns: int, blank: str) -> Iterator[tuple[str, str]]:
    """Characters of a row, joined if they have one color."""
    empty = (0, "dim")
    characters: Sequence[tuple[int, str]] = [cells.get((row, column), empty) for column in range(columns)]
    for color, run in groupby(characters, key=lambda character: character[1]):
        yield "".join(chr(0x2800 + bits) if bits else blank for bits, _ in run), color
