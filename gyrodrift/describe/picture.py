"""A session as a picture of one page; matplotlib comes with `[lab]`."""

from typing import BinaryIO

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from gyrodrift.describe.drawing import COLORS, DescribedSession, Mark, Panel
from gyrodrift.describe.recording_panels import recording_panels
from gyrodrift.describe.yaw_panels import error_panel, histogram_panel, yaw_panels
from gyrodrift.html.svg import styled

COLUMNS = 2
WIDE_IN, HIGH_IN = 13.0, 2.5

UNDATED = {"png": {"Software": None}, "svg": {"Date": None}, "pdf": {"CreationDate": None}}
"""Without dates the same session gives the same bytes."""


def draw(described: DescribedSession, file: BinaryIO, ending: str) -> None:
    """Write all panels of a session to a file, as png, svg or pdf; the yaw error takes the whole width."""
    error, histogram = error_panel(described), histogram_panel(described)
    small = [*yaw_panels(described), *([histogram] if histogram else []), *recording_panels(described)]
    with styled():
        first = 1 if error else 0
        rows = max(1, first + -(-len(small) // COLUMNS))
        figure = Figure(figsize=(WIDE_IN, 0.5 + HIGH_IN * rows), layout="constrained", facecolor="white")
        title = _title(described) + ("" if small else ": nothing in it can be drawn")
        figure.suptitle(title, fontsize=12, parse_math=False)  # names of files may hold a $
        grid = figure.add_gridspec(rows, COLUMNS)
        if error:
            _draw_panel(figure.add_subplot(grid[0, :]), error)
        for index, panel in enumerate(small):
            is_alone = index == len(small) - 1 and index % COLUMNS == 0
            row, column = divmod(index, COLUMNS)
            _draw_panel(figure.add_subplot(grid[first + row, :] if is_alone else grid[first + row, column]), panel)
        figure.savefig(file, format=ending, dpi=110, metadata=UNDATED[ending])


def _title(described: DescribedSession) -> str:
    description = described.description
    rate = "" if description.rate_hz is None else f", {description.rate_hz:.6g} Hz"
    return f"{described.session.name}: {description.samples} samples, {description.duration_s:.6g} s{rate}"


def _draw_panel(axes: Axes, panel: Panel) -> None:
    panel.draw(axes)
    axes.set_title(panel.name, loc="left", fontsize=10)
    if panel.marks:
        handles = [_handle(mark) for mark in panel.marks]
        axes.legend(handles=handles, fontsize=8, loc="best", framealpha=0.85)


def _handle(mark: Mark) -> Line2D:
    _, color, shape, name = mark
    if "dot" in shape.split():
        return Line2D([], [], color=COLORS[color], linestyle="", marker=".", label=name)
    handle = Line2D([], [], color=COLORS[color], linewidth=0.8 if "thin" in shape else 2.0, label=name)
    handle.set_linestyle(":" if "dotted" in shape else "--" if "dashed" in shape else "-")
    return handle
