"""The live view: where the table is, where raw and corrected yaw are, and how their errors grow; of any size."""

from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import NamedTuple

from rich.console import Group, RenderableType
from rich.panel import Panel
from rich.table import Table
from rich.text import Text

from gyrodrift.demo.yaw_error import YawError

FRAME_COLUMNS, FRAME_ROWS = 4, 2
LABEL_COLUMNS = 9
TABLE_ROWS, TABLE_COLUMNS = 4, 43
"""Of the table without its dials."""

LEGEND_ROWS = 1
ROOMY_ROWS = 20
"""From so many on there are blank lines between the parts."""

RAW, CORRECTED = "red", "green"
DOTS = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))
"""Bits of the braille dots of a character, by row and column."""

Cells = dict[tuple[int, int], tuple[int, str]]


class Size(NamedTuple):
    """Of a terminal, in characters."""

    columns: int
    rows: int


SMALLEST = Size(60, 15)
PICTURE = Size(100, 24)
"""Of a view that is kept as a picture, whatever the terminal."""


def draw(error: YawError, duration_s: float, port: str, size: Size) -> RenderableType:
    """The whole view at this moment, which fills the size."""
    if size.columns < SMALLEST.columns or size.rows < SMALLEST.rows:
        return Text(f"{error.elapsed_s:.1f} of {duration_s:g} s; the view wants {SMALLEST.columns}×{SMALLEST.rows}")
    columns, rows = size.columns - FRAME_COLUMNS, size.rows - FRAME_ROWS
    head = _head(error, duration_s, port, columns)
    blank = [Text()] if size.rows >= ROOMY_ROWS else []
    left = rows - len(head) - TABLE_ROWS - LEGEND_ROWS - 2 * len(blank)
    parts = [*head, *blank, _angles(error, columns), *blank, _plot(error, duration_s, Size(columns, left))]
    return Panel(Group(*parts), title="gyrodrift demo", height=size.rows, width=size.columns)


def _head(error: YawError, duration_s: float, port: str, columns: int) -> list[Text]:
    """What is said in words, in as few lines as hold it."""
    words = [
        f"{port}   {error.elapsed_s:5.1f} of {duration_s:g} s",
        f"{error.samples} samples" if error.samples else "waiting for the first sample",
        f"rate {error.rate_dps:+8.2f} deg/s",
        f"drift estimate {error.bias_dps:+.3f} deg/s",
    ]
    lines = [words[0]]
    for word in words[1:]:
        if len(lines[-1]) + len(word) + 5 > columns:
            lines.append(word)
        else:
            lines[-1] += f"   {word}"
    return [Text.assemble(("  " if number else "● ", "green"), line) for number, line in enumerate(lines)]


def summary(error: YawError) -> list[str]:
    """What the demo ends with, a line each."""
    return [
        f"{error.samples} samples in {error.elapsed_s:.1f} s of device time; yaw against the encoder of the table:",
        _summed_up("raw integration", error.raw_mean_deg, error.raw_error_deg),
        _summed_up("gyrodrift", error.corrected_mean_deg, error.corrected_error_deg),
    ]


def _summed_up(name: str, mean_deg: float, last_deg: float) -> str:
    return f"  {name:16} mean |error| {mean_deg:8.3f} deg   at the end {last_deg:+9.3f} deg"


def _angles(error: YawError, columns: int) -> Table:
    dial = columns - TABLE_COLUMNS
    table = Table(box=None, pad_edge=False)
    table.add_column("yaw", width=15, no_wrap=True)
    table.add_column("degrees", width=10, justify="right", no_wrap=True)
    table.add_column("+180° … -180°", width=dial, no_wrap=True)
    table.add_column("error", width=11, justify="right", no_wrap=True)
    rows = (
        ("table (encoder)", error.true_deg, None, "white"),
        ("raw integration", error.raw_deg, error.raw_error_deg, RAW),
        ("gyrodrift", error.corrected_deg, error.corrected_error_deg, CORRECTED),
    )
    for name, angle_deg, error_deg, colour in rows:
        shown = "" if error_deg is None else f"{error_deg:+.3f}°"
        ring = Text(_dial(angle_deg, dial), colour)
        table.add_row(Text(name, colour), f"{angle_deg:+.2f}°", ring, Text(shown, colour))
    return table


def _dial(angle_deg: float, columns: int) -> str:
    """Where the angle points, laid out flat; counter-clockwise is to the left, as seen from above."""
    turn = (180.0 - angle_deg) % 360.0 / 360.0
    at = min(columns - 1, int(turn * columns))
    return "─" * at + "┃" + "─" * (columns - 1 - at)


def _plot(error: YawError, duration_s: float, size: Size) -> RenderableType:
    """Both errors over time, in braille dots; an odd number of rows has one for 0."""
    columns, rows = size.columns - LABEL_COLUMNS, size.rows - 1 + size.rows % 2
    reach_deg = max([1.0, *(abs(value) for _, raw, corrected in error.history for value in (raw, corrected))])
    cells = _cells(error, duration_s, reach_deg, Size(columns, rows))
    middle = rows // 2
    labels = {0: f"{reach_deg:+7.1f}°", middle: "      0°", rows - 1: f"{-reach_deg:+7.1f}°"}
    lines = [
        Text.assemble(
            (f"{labels.get(row, ''):{LABEL_COLUMNS}}", "dim"),
            *_runs(cells, row, columns, "┈" if row == middle else " "),
        )
        for row in range(rows)
    ]
    legend = Text.assemble(" " * LABEL_COLUMNS, "yaw error over time: ", ("raw", RAW), ", ", ("gyrodrift", CORRECTED))
    return Group(*lines, legend)


def _cells(error: YawError, duration_s: float, reach_deg: float, size: Size) -> Cells:
    """Dots and colour of each character that has some, by row and column."""
    cells: Cells = {}
    wide, high = 2 * size.columns, 4 * size.rows - 1
    for t_s, raw_deg, corrected_deg in error.history:
        x = min(wide - 1, int((t_s - error.first_s) / duration_s * wide))
        for value_deg, colour in ((raw_deg, RAW), (corrected_deg, CORRECTED)):
            y = min(high, int((0.5 - 0.5 * value_deg / reach_deg) * high + 0.5))
            bits, _ = cells.get((y // 4, x // 2), (0, ""))
            cells[y // 4, x // 2] = (bits | DOTS[y % 4][x % 2], colour)
    return cells


def _runs(cells: Cells, row: int, columns: int, blank: str) -> Iterator[tuple[str, str]]:
    """The characters of a row, as many at once as have one colour."""
    empty = (0, "dim")
    characters: Sequence[tuple[int, str]] = [cells.get((row, column), empty) for column in range(columns)]
    for colour, run in groupby(characters, key=lambda character: character[1]):
        yield "".join(chr(0x2800 + bits) if bits else blank for bits, _ in run), colour
