"""The live view: where the table is, where raw and corrected yaw are, and how their errors grow."""

from rich.console import Group, RenderableType
from rich.panel import Panel
from rich.table import Table
from rich.text import Text

from gyrodrift.demo.yaw_error import YawError

PLOT_COLUMNS = 68
PLOT_ROWS = 9
DIAL_COLUMNS = 37
RAW, CORRECTED = "red", "green"
DOTS = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))
"""Bits of the braille dots of a character, by row and column."""


def draw(error: YawError, duration_s: float, port: str) -> RenderableType:
    """The whole view at this moment."""
    head = Text.assemble(
        ("● ", "green"),
        f"{port}   {error.elapsed_s:5.1f} of {duration_s:g} s   {error.samples} samples   ",
        f"rate {error.rate_dps:+8.2f} deg/s   drift estimate {error.bias_dps:+.3f} deg/s",
    )
    return Panel(Group(head, Text(), _angles(error), Text(), _plot(error, duration_s)), title="gyrodrift demo")


def summary(error: YawError) -> list[str]:
    """What the demo ends with, a line each."""
    return [
        f"{error.samples} samples in {error.elapsed_s:.1f} s of device time; yaw against the encoder of the table:",
        _summed_up("raw integration", error.raw_mean_deg, error.raw_error_deg),
        _summed_up("gyrodrift", error.corrected_mean_deg, error.corrected_error_deg),
    ]


def _summed_up(name: str, mean_deg: float, last_deg: float) -> str:
    return f"  {name:16} mean |error| {mean_deg:8.3f} deg   at the end {last_deg:+9.3f} deg"


def _angles(error: YawError) -> Table:
    table = Table(box=None, pad_edge=False)
    for name in ("yaw", "degrees", "+180° … -180°", "error"):
        table.add_column(name, justify="left" if name in ("yaw", "+180° … -180°") else "right")
    rows = (
        ("table (encoder)", error.true_deg, None, "white"),
        ("raw integration", error.raw_deg, error.raw_error_deg, RAW),
        ("gyrodrift", error.corrected_deg, error.corrected_error_deg, CORRECTED),
    )
    for name, angle_deg, error_deg, colour in rows:
        shown = "" if error_deg is None else f"{error_deg:+.3f}°"
        table.add_row(Text(name, colour), f"{angle_deg:+.2f}°", Text(_dial(angle_deg), colour), Text(shown, colour))
    return table


def _dial(angle_deg: float) -> str:
    """Where the angle points, laid out flat; counter-clockwise is to the left, as seen from above."""
    turn = (180.0 - angle_deg) % 360.0 / 360.0
    at = min(DIAL_COLUMNS - 1, int(turn * DIAL_COLUMNS))
    return "─" * at + "┃" + "─" * (DIAL_COLUMNS - 1 - at)


def _plot(error: YawError, duration_s: float) -> RenderableType:
    """Both errors over time, in braille dots."""
    reach_deg = max([1.0, *(abs(value) for _, raw, corrected in error.history for value in (raw, corrected))])
    cells: dict[tuple[int, int], tuple[int, str]] = {}
    for t_s, raw_deg, corrected_deg in error.history:
        x = min(2 * PLOT_COLUMNS - 1, int((t_s - error.first_s) / duration_s * 2 * PLOT_COLUMNS))
        for value_deg, colour in ((raw_deg, RAW), (corrected_deg, CORRECTED)):
            y = min(4 * PLOT_ROWS - 1, int((0.5 - 0.5 * value_deg / reach_deg) * (4 * PLOT_ROWS - 1) + 0.5))
            bits, _ = cells.get((y // 4, x // 2), (0, ""))
            cells[y // 4, x // 2] = (bits | DOTS[y % 4][x % 2], colour)
    lines = []
    for row in range(PLOT_ROWS):
        label = {0: f"{reach_deg:+7.1f}°", PLOT_ROWS // 2: "      0°", PLOT_ROWS - 1: f"{-reach_deg:+7.1f}°"}
        line = Text(label.get(row, " " * 8) + " ", "dim")
        for column in range(PLOT_COLUMNS):
            bits, colour = cells.get((row, column), (0, "dim"))
            line.append(chr(0x2800 + bits) if bits else ("┈" if row == PLOT_ROWS // 2 else " "), colour)
        lines.append(line)
    legend = Text.assemble("         yaw error over time: ", ("raw", RAW), ", ", ("gyrodrift", CORRECTED))
    return Group(*lines, legend)
