"""A chart as data: scales and series. A page draws it with uPlot, a picture with matplotlib."""

import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from math import ceil, log10
from typing import Any, NamedTuple

import numpy as np

from gyrodrift.values.arrays import Floats

LINE_PARTS = 300
"""A long curve is drawn as the lowest and the highest value of so many parts: two or three points per pixel."""

DIGITS = 5
"""Digits of coordinates, of the range of a linear scale or of the value: chosen, for a zoom of 100."""

MARGIN = 0.05
"""Margin of a scale on either side, as a share of its range."""

LARGEST = 1e300
"""Largest end of a scale, so that its margin is finite."""

LINEAR_LIMIT = 1.0
"""A symmetric logarithmic scale is linear up to this value."""


class Mark(NamedTuple):
    """Legend entry.

    key
        Key of the curves that the entry switches; empty for an entry that switches nothing.
    color, shape
        Classes of the style sheet.
    """

    key: str
    color: str
    shape: str
    name: str


class ScaleKind(StrEnum):
    """Kind of a scale; SYMLOG is linear near 0 and logarithmic beyond."""

    LINEAR = "linear"
    LOG = "log"
    SYMLOG = "symlog"


@dataclass(frozen=True, slots=True)
class AxisScale:
    """Scale of an axis with its label, which has the unit; `least_step` is the least distance of its ticks."""

    label: str
    low: float
    high: float
    kind: ScaleKind = ScaleKind.LINEAR
    least_step: float = 0.0


class Shape(StrEnum):
    """Drawing of a series.

    BAND is the area between y and y_end; BOXES are rectangles and STROKES are lines from (x, y) to (x_end, y_end).
    """

    LINE = "line"
    BAND = "band"
    DOTS = "dots"
    BOXES = "boxes"
    STROKES = "strokes"


@dataclass(frozen=True, slots=True, eq=False)
class ChartSeries:
    """Points with one color.

    x, y, x_end, y_end
        Coordinates of shape (n,). NaN interrupts a line; an infinite corner of a box or stroke is at the edge.
    color
        Variable of the style sheet.
    key
        Key of the legend entry that switches the series; empty for none.
    name
        Name beside the values under the pointer; empty to leave them out.
    width
        Width of lines and diameter of dots, in CSS pixels.
    dash
        `dashed`, `dotted` or empty.
    """

    x: Floats
    y: Floats
    color: str
    shape: Shape = Shape.LINE
    x_end: Floats | None = None
    y_end: Floats | None = None
    key: str = ""
    name: str = ""
    width: float = 1.5
    dash: str = ""
    opacity: float = 1.0


@dataclass(frozen=True, slots=True)
class Part:
    """Series on a vertical scale; `share` is the part's share of the height of its chart, relative to other parts."""

    y: AxisScale
    series: Sequence[ChartSeries]
    share: float = 1.0


@dataclass(frozen=True, slots=True)
class Chart:
    """Parts below each other with a common horizontal scale.

    says
        Description for screen readers.
    height_px
        Height on a page.
    """

    says: str
    x: AxisScale
    parts: Sequence[Part]
    height_px: int = 200

    def json(self) -> str:
        """The chart for chart.js; equal coordinates are stated once."""
        arrays: dict[str, int] = {}
        whole = sum(part.share for part in self.parts)
        parts = [
            {
                "y": _scale(part.y),
                "share": round(part.share / whole, 4),
                "series": [_series(series, self.x, part.y, arrays) for series in part.series],
            }
            for part in self.parts
        ]
        content = {"x": _scale(self.x), "height": self.height_px, "parts": parts}
        return f'{json.dumps(content, separators=(",", ":"))[:-1]},"arrays":[{",".join(arrays)}]}}'


def _scale(scale: AxisScale) -> dict[str, Any]:
    ends = {name: float(f"{value:.7g}") for name, value in (("low", scale.low), ("high", scale.high))}
    return {"label": scale.label, **ends, "kind": scale.kind.value, "step": scale.least_step}


def _series(series: ChartSeries, x: AxisScale, y: AxisScale, arrays: dict[str, int]) -> dict[str, Any]:
    """Series with indices of its coordinates; new coordinates are added to `arrays`."""
    style = {"shape": series.shape.value, "color": series.color, "width": series.width}
    optional = {"key": series.key, "name": series.name, "dash": series.dash}
    coordinates = {"x": (series.x, x), "y": (series.y, y), "xEnd": (series.x_end, x), "yEnd": (series.y_end, y)}
    return {
        **style,
        **{name: value for name, value in optional.items() if value},
        **({} if series.opacity == 1.0 else {"opacity": series.opacity}),
        **{
            name: arrays.setdefault(_numbers(values, scale), len(arrays))
            for name, (values, scale) in coordinates.items()
            if values is not None
        },
    }


def _numbers(values: Floats, scale: AxisScale) -> str:
    """Coordinates as JSON, rounded for their scale; null for values that are not finite."""
    drawn = np.where(np.abs(values) < LARGEST, values, np.nan)
    if scale.kind is ScaleKind.LINEAR:
        rounded = np.round(drawn, DIGITS - ceil(log10(max(scale.high - scale.low, 1e-300)))) + 0.0
        numbers = [f"{value:.12g}" for value in rounded.tolist()]
    else:
        numbers = [f"{value:.{DIGITS}g}" for value in drawn.tolist()]
    return f"[{','.join(numbers)}]".replace("nan", "null")


def thinned(x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """Reduce a curve to the lowest and the highest value of each of `LINE_PARTS` parts, so that peaks stay.

    Curves with the same x are reduced to the same x.
    """
    y = np.where(np.isfinite(y), y, np.nan)
    if len(y) <= 2 * LINE_PARTS:
        return x, y
    inside = np.array_split(np.arange(1, len(y) - 1), LINE_PARTS)
    rows = [row for part in inside for row in _extremes(y, part)]
    places = [part[index] for part in inside for index in (0, -1)]
    return x[[0, *places, len(x) - 1]], y[[0, *rows, len(y) - 1]]


def _extremes(y: Floats, part: np.ndarray) -> list[int]:
    """Indices of the lowest and the highest value in their order; twice the first index if no value is finite."""
    if not np.isfinite(y[part]).any():
        return [int(part[0])] * 2
    return sorted((int(part[np.nanargmin(y[part])]), int(part[np.nanargmax(y[part])])))


def scale_of(label: str, values: Iterable[Floats], least_span: float = 0.0, *, margin: float = MARGIN) -> AxisScale:
    """A linear scale over all finite values with a margin, at least `least_span` wide."""
    low, high = _ends(values)
    extra = max(margin * (high - low), 0.5 * (least_span - (high - low)), 0.0) or 0.5
    return AxisScale(label, low - extra, high + extra)


def error_scale(label: str, values: Iterable[Floats]) -> AxisScale:
    """A symmetric logarithmic scale over all finite values and its linear part."""
    low, high = _ends([*values, np.array([-LINEAR_LIMIT, LINEAR_LIMIT])])
    return AxisScale(label, 1.3 * low, 1.3 * high, ScaleKind.SYMLOG)


def log_scale(label: str, values: Iterable[Floats], least_factor: float) -> AxisScale:
    """A logarithmic scale over all positive values, at least `least_factor` from end to end."""
    low, high = _ends([np.where(array > 0.0, array, np.nan) for array in values])
    low, high = (low, high) if low > 0.0 else (0.1, 1.0)
    margin = (high / low) ** MARGIN
    low, high = low / margin, high * margin
    missing = max(least_factor / (high / low), 1.0) ** 0.5
    return AxisScale(label, low / missing, high * missing, ScaleKind.LOG)


def _ends(values: Iterable[Floats]) -> tuple[float, float]:
    """Lowest and highest finite value; 0 and 0 without any."""
    finite = [value[np.isfinite(value)] for value in values]
    everything = np.clip(np.concatenate([np.empty(0), *finite]), -LARGEST, LARGEST)
    return (float(everything.min()), float(everything.max())) if len(everything) else (0.0, 0.0)


def line(x: float | None = None, y: float | None = None, *, color: str, **style: Any) -> ChartSeries:
    """A straight line across the chart, at an x or at a y."""
    infinite = np.array([np.inf])
    if x is not None:
        return ChartSeries(np.array([x]), -infinite, color, Shape.STROKES, np.array([x]), infinite, **style)
    level = np.array([0.0 if y is None else y])
    return ChartSeries(-infinite, level, color, Shape.STROKES, infinite, level, **style)
