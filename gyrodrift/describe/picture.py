"""A session as a picture of one page; matplotlib comes with `[lab]`."""

from typing import Any, BinaryIO, Literal

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter

from gyrodrift.describe.drawing import DescribedSession, Panel
from gyrodrift.describe.recording_panels import recording_panels
from gyrodrift.describe.yaw_panels import error_panel, histogram_panel, yaw_panels
from gyrodrift.report.chart import LINEAR_LIMIT, AxisScale, ChartSeries, Mark, ScaleKind, Shape
from gyrodrift.report.numbers import minus
from gyrodrift.values.arrays import Floats

COLUMNS = 2
WIDE_IN, HIGH_IN = 13.0, 2.5

POINTS_PER_PX = 0.75
"""A CSS pixel is 1/96 in, a point 1/72 in."""

UNDATED = {"png": {"Software": None}, "svg": {"Date": None}, "pdf": {"CreationDate": None}}
"""Without dates the same session gives the same bytes."""

COLORS = {
    "ink": "#101112",
    "quiet": "#606162",
    "plain": "#c05012",
    "tuned": "#1060b2",
    "three": "#1f7a4c",
    "five": "#b0226e",
}
"""Variables of the style sheet of pages as colors."""

DASHES: dict[str, Literal["--", ":", "-"]] = {"dashed": "--", "dotted": ":", "": "-"}

STYLE: dict[Any, Any] = {
    "svg.fonttype": "none",
    "font.size": 8.0,
    "axes.edgecolor": COLORS["quiet"],
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "axes.grid": True,
    "grid.color": "#d0d1d2",
    "grid.linewidth": 0.6,
}


def draw(described: DescribedSession, file: BinaryIO, ending: str) -> None:
    """Write all panels of a session to a file, as png, svg or pdf; the yaw error takes the whole width."""
    error, histogram = error_panel(described), histogram_panel(described)
    small = [*yaw_panels(described), *([histogram] if histogram else []), *recording_panels(described)]
    with mpl.rc_context({**mpl.rcParamsDefault, **STYLE}):
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
    (part,) = panel.chart.parts
    x, y = panel.chart.x, part.y
    for series in part.series:
        _draw_series(axes, series, x, y)
    linear = {"linthresh": LINEAR_LIMIT} if y.kind is ScaleKind.SYMLOG else {}
    axes.set_xscale(x.kind.value)
    axes.set_yscale(y.kind.value, **linear)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(FuncFormatter(lambda value, _: minus(f"{value:g}")))
    axes.set(xlim=(x.low, x.high), ylim=(y.low, y.high), xlabel=x.label, ylabel=y.label)
    axes.set_title(panel.name, loc="left", fontsize=10)
    if panel.marks:
        axes.legend(handles=[_handle(mark) for mark in panel.marks], fontsize=8, loc="best", framealpha=0.85)


def _draw_series(axes: Axes, series: ChartSeries, x: AxisScale, y: AxisScale) -> None:
    color, width = COLORS[series.color], POINTS_PER_PX * series.width
    style: dict[str, Any] = {"color": color, "alpha": series.opacity}
    match series.shape:
        case Shape.LINE:
            axes.plot(series.x, series.y, DASHES[series.dash], linewidth=width, **style)
        case Shape.DOTS:
            axes.plot(series.x, series.y, ".", markersize=1.8 * width, markeredgewidth=0, **style)
        case Shape.BAND:
            axes.fill_between(series.x, series.y, _ends(series.y_end), linewidth=0.0, **style)
        case _:
            x_low, x_high = _within(series.x, x), _within(_ends(series.x_end), x)
            y_low, y_high = _within(series.y, y), _within(_ends(series.y_end), y)
            if series.shape is Shape.BOXES:
                corners = np.array([[x_low, y_low], [x_high, y_low], [x_high, y_high], [x_low, y_high]]).transpose(
                    2, 0, 1
                )
                axes.add_collection(PolyCollection(list(corners), linewidth=0.0, **style))
            else:
                ends = np.array([[x_low, y_low], [x_high, y_high]]).transpose(2, 0, 1)
                lines = LineCollection(list(ends), linewidth=width, linestyle=DASHES[series.dash], **style)
                axes.add_collection(lines)


def _ends(values: Floats | None) -> Floats:
    return np.empty(0) if values is None else values


def _within(values: Floats, scale: AxisScale) -> Floats:
    """Coordinates with the ends of the scale for infinite ones."""
    within: Floats = np.nan_to_num(values, nan=np.nan, posinf=scale.high, neginf=scale.low)
    return within


def _handle(mark: Mark) -> Line2D:
    color, shapes = COLORS[mark.color], mark.shape.split()
    if "dot" in shapes:
        return Line2D([], [], color=color, linestyle="", marker=".", label=mark.name)
    handle = Line2D([], [], color=color, linewidth=0.8 if "thin" in shapes else 2.0, label=mark.name)
    handle.set_linestyle(next((line for name, line in DASHES.items() if name in shapes), "-"))
    return handle
