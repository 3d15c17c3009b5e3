"""The live view of the demo: angles of the table, raw and corrected yaw, and a chart of both errors."""

from typing import NamedTuple

from rich.console import Group, RenderableType
from rich.panel import Panel
from rich.table import Table
from rich.text import Text

from gyrodrift.demo.yaw_error import YawError
from gyrodrift.io.text_chart import AxisRange, ChartLine, chart, legend, padded_range

FRAME_COLUMNS, FRAME_ROWS = 4, 2
TABLE_ROWS, TABLE_COLUMNS = 4, 43
"""Size of the table of angles without its dials, in characters."""

LEGEND_ROWS = 1
ROOMY_ROWS = 20
"""Rows of a terminal from which on blank lines separate the parts."""

RAW, CORRECTED = "red", "green"
LEAST_DEG = 2.0
"""The chart shows at least this range of errors, deg."""


class Size(NamedTuple):
    """Size of a terminal, in characters."""

    columns: int
    rows: int


SMALLEST = Size(60, 15)
PICTURE = Size(100, 24)
"""Size of the picture of `--svg`, whatever the terminal."""


def draw(error: YawError, duration_s: float, port: str, size: Size) -> RenderableType:
    """The view of this moment, as large as the terminal."""
    if size.columns < SMALLEST.columns or size.rows < SMALLEST.rows:
        return Text(f"{error.elapsed_s:.1f} of {duration_s:g} s; the view needs {SMALLEST.columns}×{SMALLEST.rows}")
    columns, rows = size.columns - FRAME_COLUMNS, size.rows - FRAME_ROWS
    head = _head(error, duration_s, port, columns)
    blank = [Text()] if size.rows >= ROOMY_ROWS else []
    chart_rows = rows - len(head) - TABLE_ROWS - LEGEND_ROWS - 2 * len(blank)
    parts = [*head, *blank, _angles(error, columns), *blank, _plot(error, duration_s, Size(columns, chart_rows))]
    return Panel(Group(*parts), title="gyrodrift demo", height=size.rows, width=size.columns)


def _head(error: YawError, duration_s: float, port: str, columns: int) -> list[Text]:
    """Port, time, samples, rate and bias, in as few lines as hold them."""
    words = [
        f"{port}   {error.elapsed_s:5.1f} of {duration_s:g} s",
        f"{error.samples} samples" if error.samples else "waiting for the first sample",
        f"rate {error.rate_dps:+8.2f} deg/s",
        f"bias {error.bias_dps:+.3f} deg/s",
    ]
    lines = [words[0]]
    for word in words[1:]:
        if len(lines[-1]) + len(word) + 5 > columns:
            lines.append(word)
        else:
            lines[-1] += f"   {word}"
    return [Text.assemble(("  " if number else "● ", "green"), line) for number, line in enumerate(lines)]


def summary(error: YawError) -> list[str]:
    """Lines that the demo prints at its end."""
    return [
        f"{error.samples} samples in {error.elapsed_s:.1f} s of device time; yaw against the encoder of the table:",
        _summary_line("raw integration", error.raw_mean_deg, error.raw_error_deg),
        _summary_line("gyrodrift", error.corrected_mean_deg, error.corrected_error_deg),
    ]


def _summary_line(name: str, mean_deg: float, last_deg: float) -> str:
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
    for name, angle_deg, error_deg, color in rows:
        shown = "" if error_deg is None else f"{error_deg:+.3f}°"
        ring = Text(_dial(angle_deg, dial), color)
        table.add_row(Text(name, color), f"{angle_deg:+.2f}°", ring, Text(shown, color))
    return table


def _dial(angle_deg: float, columns: int) -> str:
    """A dial laid out flat: a mark at the angle; counter-clockwise is to the left, as seen from above."""
    turn = (180.0 - angle_deg) % 360.0 / 360.0
    column = min(columns - 1, int(turn * columns))
    return "─" * column + "┃" + "─" * (columns - 1 - column)


def _plot(error: YawError, duration_s: float, size: Size) -> RenderableType:
    """Both errors over time, with their legend below."""
    times = [t_s - error.first_s for t_s, _, _ in error.history]
    series = (
        ChartLine(
            "raw integration",
            [(t_s, row[1]) for t_s, row in zip(times, error.history, strict=True)],
            RAW,
            is_dashed=True,
        ),
        ChartLine("gyrodrift", [(t_s, row[2]) for t_s, row in zip(times, error.history, strict=True)], CORRECTED),
    )
    values = [value for line in series for _, value in line.points]
    lines = chart(series, AxisRange(0.0, duration_s), padded_range([0.0, *values], LEAST_DEG), size.columns, size.rows)
    return Group(*lines, legend(series, "yaw error, deg:"))
