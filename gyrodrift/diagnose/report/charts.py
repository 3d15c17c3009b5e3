"""Charts of a diagnosis: features by session, rate errors against other quantities, over time, and as spectra."""

from collections.abc import Sequence
from typing import TypeVar

import numpy as np

from gyrodrift.diagnose.predictive_checks.feature_comparison import Band, FeatureComparison
from gyrodrift.diagnose.predictive_checks.rate_errors import Dependence, ResidualSeries, Spectra, Trend
from gyrodrift.report.chart import (
    AxisScale,
    Chart,
    ChartSeries,
    Part,
    ScaleKind,
    Shape,
    line,
    log_scale,
    scale_of,
    thinned,
)
from gyrodrift.values.arrays import Floats

T = TypeVar("T")

REAL, BEFORE, AFTER, RESIDUAL = "ink", "plain", "tuned", "two"
"""Colors, which are the keys of the legend, too."""

DOTS = 350
"""Largest number of dots in a scatter plot. Chosen: more would hide each other and make the page larger."""

SHOWN = (2.0, 98.0)
"""Percentiles of the values of a scatter plot that its scale includes. Chosen: a few outliers should not flatten the
rest."""

LEAST_DPS = 0.01
"""Least range of a scale on either side of 0, deg/s. Chosen: smaller errors should look small."""

UNITS = {
    "times its middle": "variance, over that of 4- to 8-sample means at rest",
    "times as by chance": "share of the variance, over that by chance",
    "times as at rest": "scatter, over that at rest",
    "times its neighbors": "power, over that of neighboring frequencies",
    "times as usual": "variance of the noisiest seconds, over the median",
    "of the encoder's": "largest rate, over that of the encoder",
    "jumps": "jumps of the angle",
    "samples": "samples missing in a row",
}
"""Titles of axes, by the unit of a feature, for units that say too little."""

SMOOTH_SECONDS = 5
"""Length of the running medians of rate errors over time. Chosen: single outliers go, and steps remain."""

WIDE_BAR, NARROW_BAR = 0.64, 0.36
"""Widths of the bars of the simulator as it is and corrected, in sessions. Chosen: both are visible one above the
other."""

ERRORS = 2.0
"""Standard errors of a median that its band spans on either side. Chosen: by chance, 19 of 20 medians lie within."""

FEW = 4
"""Least number of medians that are joined by a line. Chosen: a line through fewer looks like a slope."""

DECADE = 10.0
"""Least ratio of the ends of the scale of a spectrum. Chosen: white noise should look level in spite of its scatter."""

TWO_PARTS_PX = 290
"""Height of a chart of the error above and the residual below. Chosen: each part is readable."""


def feature_chart(compared: FeatureComparison, *, has_causes: bool) -> Chart:
    """A feature session by session: recordings as dots, expected values of the simulator as bars."""
    sessions = np.arange(1.0, len(compared.real) + 1.0)
    bands = [(compared.before, BEFORE, WIDE_BAR), *[(compared.after, AFTER, NARROW_BAR)] * has_causes]
    series = [bar for band, color, width in bands for bar in _bars(sessions, band, color, width)]
    series.append(ChartSeries(sessions, compared.real, REAL, Shape.DOTS, name="recordings", width=5.0))
    values = [compared.real, *(end for band, _, _ in bands for end in (band.low, band.high))]
    y = scale_of(UNITS.get(compared.unit, compared.unit), values)
    x = AxisScale("session", 0.4, len(sessions) + 0.6, least_step=1.0)
    return Chart("A feature by session, real and simulated", x, [Part(y, series)], 180)


def _bars(x: Floats, band: Band, color: str, width: float) -> list[ChartSeries]:
    low, high = x - width / 2.0, x + width / 2.0
    return [
        ChartSeries(low, band.low, color, Shape.BOXES, high, band.high, opacity=0.25),
        ChartSeries(low, band.middle, color, Shape.STROKES, high, band.middle, width=2.2),
    ]


def dependence_chart(dependence: Dependence, *, has_causes: bool) -> Chart:
    """Above, the rate errors against a regressor; below, the residual against it."""
    x, errors = dependence.x, dependence.errors
    real, before, after, remaining = dependence.trends
    lines = _lines(real, before, after, has_causes=has_causes)
    above = _cloud_scale("error, deg/s", errors.real, [trend.y for trend, _ in lines])
    below = _cloud_scale("residual, deg/s", errors.unexplained, [remaining.y])
    parts = [
        Part(above, [_cloud(x, errors.real, above), *(_trend(*trend) for trend in lines)], 5.0),
        Part(
            below,
            [
                line(y=0.0, color="quiet", width=0.8),
                _cloud(x, errors.unexplained, below),
                _errors(remaining),
                _trend(remaining, RESIDUAL),
            ],
            4.0,
        ),
    ]
    scale = scale_of(f"{dependence.name}, {dependence.unit}", [x])
    return Chart(f"Rate error against {dependence.name}", scale, parts, TWO_PARTS_PX)


def _lines(real: T, before: T, after: T, *, has_causes: bool) -> list[tuple[T, str]]:
    """Curves with their colors, the recordings lowest; without causes there is no corrected curve."""
    return [(real, REAL), (before, BEFORE), *[(after, AFTER)] * has_causes]


def _curve(x: Floats, y: Floats, color: str, key: str = "") -> ChartSeries:
    """A curve; recordings are wide, so that they show under a simulator that agrees with them."""
    width, opacity = (4.2, 0.55) if color == REAL else (1.6, 1.0)
    return ChartSeries(x, y, color, key=key, name=NAMES[color], width=width, opacity=opacity)


NAMES = {REAL: "recordings", BEFORE: "simulator", AFTER: "corrected", RESIDUAL: "residual"}
"""Names beside values under the pointer."""


def _cloud_scale(label: str, y: Floats, lines: Sequence[Floats]) -> AxisScale:
    """A scale that includes SHOWN of the points and all of the lines."""
    return scale_of(label, [np.percentile(y, SHOWN), *lines, np.array([-LEAST_DPS, LEAST_DPS])])


def _cloud(x: Floats, y: Floats, scale: AxisScale) -> ChartSeries:
    """At most DOTS points within the scale."""
    shown = np.unique(np.linspace(0, len(x) - 1, min(len(x), DOTS)).round().astype(int))
    limited = np.where((y >= scale.low) & (y <= scale.high), y, np.nan)
    return ChartSeries(x[shown], limited[shown], "quiet", Shape.DOTS, width=3.0, opacity=0.55)


def _errors(trend: Trend) -> ChartSeries:
    """Standard errors of medians as a band, or as bars if there are few medians."""
    wide = ERRORS * trend.error
    shape, opacity = (Shape.STROKES, 1.0) if len(trend.x) < FEW else (Shape.BAND, 0.22)
    return ChartSeries(trend.x, trend.y - wide, RESIDUAL, shape, trend.x, trend.y + wide, width=1.8, opacity=opacity)


def _trend(trend: Trend, color: str) -> ChartSeries:
    if len(trend.x) >= FEW:
        return _curve(trend.x, trend.y, color)
    return ChartSeries(trend.x, trend.y, color, Shape.DOTS, name=NAMES[color], width=5.5)


def over_time_chart(session: ResidualSeries, *, has_causes: bool) -> Chart:
    """Running medians of the recorded and simulated rate errors, and of the residual."""
    smooth = [(_smooth(values), color) for values, color in _lines(*session.errors[:3], has_causes=has_causes)]
    remaining = _smooth(session.errors.unexplained)
    limits = np.array([-LEAST_DPS, LEAST_DPS])
    parts = [
        Part(
            scale_of("error, deg/s", [*(values for values, _ in smooth), limits]),
            [_curve(*thinned(session.minutes, values), color, color) for values, color in smooth],
            5.0,
        ),
        Part(
            scale_of("residual, deg/s", [remaining, limits]),
            [
                line(y=0.0, color="quiet", width=0.8),
                _curve(*thinned(session.minutes, remaining), RESIDUAL, RESIDUAL),
            ],
            4.0,
        ),
    ]
    x = scale_of("time, min", [session.minutes], margin=0.0)
    return Chart(f"Rate error of session {session.number} over time", x, parts, TWO_PARTS_PX)


def _smooth(values: Floats) -> Floats:
    """Running medians, which keep steps sharp."""
    half = SMOOTH_SECONDS // 2
    padded = np.pad(values, half, mode="edge")
    smooth: Floats = np.median(np.lib.stride_tricks.sliding_window_view(padded, SMOOTH_SECONDS), axis=1)
    return smooth


def spectrum_chart(spectra: Spectra, *, has_causes: bool) -> Chart:
    """Recorded and simulated amplitude spectral densities at rest."""
    curves = _lines(*spectra[1:], has_causes=has_causes)
    y = log_scale("rate, deg/s/√Hz", [values for values, _ in curves], DECADE)
    x = AxisScale("frequency, Hz", float(spectra.hz[0]), float(spectra.hz[-1]), ScaleKind.LOG)
    shown = [_curve(spectra.hz, np.where(values > 0.0, values, np.nan), color, color) for values, color in curves]
    return Chart("Spectrum of the rate at rest", x, [Part(y, shown)], 220)
