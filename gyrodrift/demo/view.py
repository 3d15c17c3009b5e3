"""The live view of the demo: angles, raw and corrected yaw, and a chart of both errors against the encoder."""

from dataclasses import dataclass, field
from typing import Any, NamedTuple

from rich.console import Group, RenderableType
from rich.panel import Panel
from rich.table import Table
from rich.text import Text

from gyrodrift.io.text_chart import AxisRange, ChartLine, chart, legend, padded_range

HISTORY = 4096

FRAME_COLUMNS, FRAME_ROWS = 4, 2

TABLE_ROWS, TABLE_COLUMNS = 4, 43
"""Size of the table of angles without its dials, in characters."""

LEGEND_ROWS = 1
ROOMY_ROWS = 20
"""Rows of a terminal from which on blank lines separate the parts."""

RAW, CORRECTED = "red", "green"

LEAST_DEG = 2.0
"""The chart shows at least this range of errors, deg."""


@dataclass(slots=True)
class YawError:
    """Mean |error| in degrees; all angles are 0 at the first sample.

    raw_deg, corrected_deg, true_deg
        The latest angles.
    history
        (t_s, raw error, corrected error) of the samples, thinned when the list grows long.
    """

    samples: int = 0
    t_s: float = 0.0
    raw_deg: float = 0.0
    corrected_deg: float = 0.0
    true_deg: float = 0.0
    rate_dps: float = 0.0
    bias_dps: float = 0.0
    raw_sum_deg: float = 0.0
    corrected_sum_deg: float = 0.0
    first_s: float = 0.0
    history: list[tuple[float, float, float]] = field(default_factory=list)
    _first_encoder_deg: float = 0.0

    def add(self, line: dict[str, Any]) -> None:
        """Add a line of `serve`; lines without an encoder angle are ignored."""
        if "encoder_deg" not in line:
            return
        t_s = float(line["t_s"])
        if self.samples:
            self.raw_deg += 0.5 * (self.rate_dps + float(line["rate_dps"])) * (t_s - self.t_s)
        else:
            self.first_s = t_s
            self._first_encoder_deg = float(line["encoder_deg"])
        self.t_s = t_s
        self.samples += 1
        self.rate_dps, self.bias_dps = float(line["rate_dps"]), float(line["bias_dps"])
        self.corrected_deg = float(line["yaw_deg"])
        self.true_deg = float(line["encoder_deg"]) - self._first_encoder_deg
        self.raw_sum_deg += abs(self.raw_error_deg)
        self.corrected_sum_deg += abs(self.corrected_error_deg)
        self.history.append((t_s, self.raw_error_deg, self.corrected_error_deg))
        if len(self.history) > 2 * HISTORY:
            self.history = self.history[::2]

    @property
    def elapsed_s(self) -> float:
        """Device time since the first sample, s."""
        return self.t_s - self.first_s

    @property
    def raw_error_deg(self) -> float:
        """Error of the integrated rate, deg."""
        return self.raw_deg - self.true_deg

    @property
    def corrected_error_deg(self) -> float:
        """Error of the corrected yaw, deg."""
        return self.corrected_deg - self.true_deg

    @property
    def raw_mean_deg(self) -> float:
        """Mean |error| of the integrated rate, deg."""
        return self.raw_sum_deg / max(1, self.samples)

    @property
    def corrected_mean_deg(self) -> float:
        """Mean |error| of the corrected yaw, deg."""
        return self.corrected_sum_deg / max(1, self.samples)


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
