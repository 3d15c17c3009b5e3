"""Figures as inline SVG, with the colors of the page; matplotlib comes with `[lab]`."""

import json
import re
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from io import StringIO
from typing import Any, NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.axis import Axis as Scale
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullLocator
from numpy.typing import NDArray

from gyrodrift.html.numbers import factor_label

Floats = NDArray[np.float64]

INK, QUIET, GRID, PLAIN, TUNED, TWO = "#101112", "#606162", "#d0d1d2", "#c05012", "#1060b2", "#703092"
THREE, FOUR, FIVE, SIX = "#1f7a4c", "#94740e", "#b0226e", "#0b7285"
ROLES = {
    INK: "ink",
    QUIET: "quiet",
    GRID: "grid",
    PLAIN: "plain",
    TUNED: "tuned",
    TWO: "two",
    THREE: "three",
    FOUR: "four",
    FIVE: "five",
    SIX: "six",
}
"""Every color stands for a variable of the style sheet, so that figures follow light, dark and paper."""

STYLE: dict[Any, Any] = {
    "svg.fonttype": "none",
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],
    "font.size": 8.0,
    "text.color": INK,
    "axes.labelcolor": QUIET,
    "axes.edgecolor": QUIET,
    "axes.linewidth": 0.6,
    "axes.facecolor": "none",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "axes.grid": True,
    "grid.color": GRID,
    "grid.linewidth": 0.6,
    "xtick.color": QUIET,
    "ytick.color": QUIET,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "path.simplify_threshold": 0.3,
}

UNDATED = {"Date": None, "Creator": None, "Format": None, "Type": None}
"""Without dates, the same figure gives the same bytes."""

LINE_POINTS = 600
"""Points of a curve: two or three per pixel of a small panel."""

STEPS = (1, 2, 5, 10)
"""Steps between ticks of a linear scale, times a power of ten."""


CURVE, LINE = "curve.", "line."
"""Prefixes of the ids of switched curves and of other lines; keys consist of letters, digits, _ and -."""


@contextmanager
def styled() -> Iterator[None]:
    """Use the style of the pages, and restore the settings of matplotlib afterwards."""
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(STYLE)
        yield


def canvas(wide_in: float, high_in: float, *, inset: float, bottom: float, top: float, right: float = 0.99) -> Figure:
    """An empty figure; `inset` (left), bottom, top and right are the edges of its axes as shares of its size."""
    figure = Figure(figsize=(wide_in, high_in), facecolor="none")
    figure.subplots_adjust(left=inset, right=right, bottom=bottom, top=top, hspace=0.14)
    return figure


def label_steps(scale: Scale, labels: int) -> None:
    """Label a scale in plain steps, at most about `labels` of them."""
    scale.set_major_locator(MaxNLocator(labels, steps=STEPS))
    scale.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}".replace("-", "−")))


def label_factors(scale: Scale, low: float, high: float, labels: int) -> None:
    """Label a logarithmic scale by decades, or in plain steps if it spans less than one and a half."""
    if high < 30.0 * low:
        scale.set_major_locator(MaxNLocator(labels, steps=STEPS))
    else:
        scale.set_major_locator(LogLocator(numticks=labels + 1))
    scale.set_minor_locator(NullLocator())
    scale.set_major_formatter(FuncFormatter(lambda value, _: factor_label(value)))


def switched(curve: Artist, key: str) -> None:
    """Let legend entries with this key (see `html.switches`) switch a curve; its panel can be zoomed."""
    curve.set_gid(f"{CURVE}{key}")


def follows(line: Artist) -> None:
    """Let a line that is no curve, such as the zero line, follow the zoom of its panel."""
    line.set_gid(f"{LINE}0")


class Polyline(NamedTuple):
    """Drawn points of a curve, shape (m,)."""

    x: Floats
    y: Floats


def thinned(x: Floats, y: Floats) -> Polyline:
    """Reduce a curve to about `LINE_POINTS` points: the lowest and the highest of each part, so that peaks stay."""
    y = np.where(np.isfinite(y), y, np.nan)
    pieces = np.array_split(np.arange(len(y)), LINE_POINTS // 2)
    if len(y) <= LINE_POINTS:
        return Polyline(x, y)
    ends = {0, len(y) - 1}
    kept = np.array(sorted(ends | {int(piece[k]) for piece in pieces for k in _extremes(y[piece])}))
    return Polyline(x[kept], y[kept])


def _extremes(y: Floats) -> Iterable[int]:
    """Indices of the lowest and the highest value; the middle if none is finite."""
    if not np.isfinite(y).any():
        return (len(y) // 2,)
    return (int(np.nanargmin(y)), int(np.nanargmax(y)))


def as_svg(figure: Figure, name: str, says: str) -> str:
    """The figure as an element of a page; call it within `styled`.

    The class `chart` gives it the buttons of chart.js: copy, or save as SVG or PNG. They serve every `<svg>` of this
    class with a `viewBox` and with colors as `var(--role)` in its attributes.

    Parameters
    ----------
    figure
        Drawn in the colors above.
    name
        Unique within the page, because ids are made from it.
    says
        Description for screen readers.
    """
    svg = _named(_armed(_saved(figure, name), figure))
    svg = re.sub(r'(?<= d=")[^"]+', lambda path: re.sub(r"(\.\d\d)\d+", r"\1", path[0]), svg)  # 0.01 pt
    svg = re.sub(r"\s*\n\s*", "\n", svg)
    for color, role in ROLES.items():
        svg = svg.replace(color, f"var(--{role})")
    return svg.replace("<svg", f'<svg role="img" aria-label="{says}" class="chart"', 1).strip()


def _saved(figure: Figure, name: str) -> str:
    """The element alone, without comments, dates, and a style that would apply to the whole page."""
    mpl.rcParams["svg.hashsalt"] = name
    file = StringIO()
    figure.savefig(file, format="svg", metadata=UNDATED)
    svg = file.getvalue()
    svg = svg[svg.index("<svg") :]
    return re.sub(r"<!--.*?-->|<defs>\s*<style.*?</style>\s*</defs>", "", svg, flags=re.DOTALL)


def _named(svg: str) -> str:
    """Remove ids that nothing refers to, because they are the same in every figure."""
    called = set(re.findall(r"#([\w-]+)[\")]", svg))
    return re.sub(r' id="([\w.-]+)"', lambda match: match[0] if match[1] in called else "", svg)


def _armed(svg: str, figure: Figure) -> str:
    """Add the attributes that the script of the page needs: scales, axes, ticks and curves."""
    wide_pt, high_pt = (72.0 * float(inches) for inches in figure.get_size_inches())
    for number, axes in enumerate(figure.axes, 1):
        if any((line.get_gid() or "").startswith(CURVE) for line in axes.lines):
            scales = json.dumps(_scales(axes, wide_pt, high_pt), separators=(",", ":")).replace('"', "&quot;")
            svg = svg.replace(f' id="axes_{number}"', f' data-scales="{scales}"', 1)
    for number in range(1, 2 * len(figure.axes) + 1):
        name = "x" if number % 2 else "y"
        svg = svg.replace(f' id="matplotlib.axis_{number}"', f' data-axis="{name}"', 1)
    svg = re.sub(r' id="[xy]tick_\d+"', ' class="tick"', svg)
    svg = re.sub(rf' id="{re.escape(LINE)}([\w-]+)"', r' data-line="\1"', svg)
    return re.sub(rf' id="{re.escape(CURVE)}([\w-]+)"', r' data-curve="\1"', svg)


def _scales(axes: Axes, wide_pt: float, high_pt: float) -> dict[str, Any]:
    """Edges of a panel in units of the drawing (left, top, right, bottom), and its two scales."""
    edges = axes.get_position()
    box = (edges.x0 * wide_pt, high_pt * (1.0 - edges.y1), edges.x1 * wide_pt, high_pt * (1.0 - edges.y0))
    return {
        "box": [round(edge_pt, 3) for edge_pt in box],
        "x": _scale(axes.get_xscale(), axes.get_xlim()),
        "y": _scale(axes.get_yscale(), axes.get_ylim()),
    }


def _scale(kind: str, ends: tuple[float, float]) -> dict[str, Any]:
    return {"kind": kind, "low": float(f"{ends[0]:.7g}"), "high": float(f"{ends[1]:.7g}")}
