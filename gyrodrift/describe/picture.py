"""A session as a picture of one page; matplotlib comes with the workstation extra."""

from typing import BinaryIO

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from gyrodrift.describe.panels import COLOURS, Mark, Panel, Seen, recording_panels, yaw_panels
from gyrodrift.html.svg import styled

COLUMNS = 2
WIDE_IN, HIGH_IN = 13.0, 2.5

UNDATED = {"png": {"Software": None}, "svg": {"Date": None}, "pdf": {"CreationDate": None}}
"""The same session gives the same picture."""


def draw(seen: Seen, file: BinaryIO, ending: str) -> None:
    """Write all panels of a session to a file, as png, svg or pdf."""
    panels = [*yaw_panels(seen), *recording_panels(seen)]
    with styled():
        rows = max(1, -(-len(panels) // COLUMNS))
        figure = Figure(figsize=(WIDE_IN, 0.5 + HIGH_IN * rows), layout="constrained", facecolor="white")
        title = _title(seen) + ("" if panels else ": nothing in it can be drawn")
        figure.suptitle(title, fontsize=12, parse_math=False)  # names of files may hold a $
        grid = figure.add_gridspec(rows, COLUMNS)
        for at, panel in enumerate(panels):
            is_alone = at == len(panels) - 1 and at % COLUMNS == 0
            row, column = divmod(at, COLUMNS)
            _draw_panel(figure.add_subplot(grid[row, :] if is_alone else grid[row, column]), panel)
        figure.savefig(file, format=ending, dpi=110, metadata=UNDATED[ending])


def _title(seen: Seen) -> str:
    description = seen.description
    rate = "" if description.rate_hz is None else f", {description.rate_hz:.6g} Hz"
    return f"{seen.session.name}: {description.samples} samples, {description.duration_s:.6g} s{rate}"


def _draw_panel(axes: Axes, panel: Panel) -> None:
    panel.draw(axes)
    axes.set_title(panel.name, loc="left", fontsize=10)
    if panel.marks:
        handles = [_handle(mark) for mark in panel.marks]
        axes.legend(handles=handles, fontsize=8, loc="best", framealpha=0.85)


def _handle(mark: Mark) -> Line2D:
    _, colour, shape, name = mark
    handle = Line2D([], [], color=COLOURS[colour], linewidth=0.8 if "thin" in shape else 2.0, label=name)
    handle.set_linestyle(":" if "dotted" in shape else "--" if "dashed" in shape else "-")
    return handle
