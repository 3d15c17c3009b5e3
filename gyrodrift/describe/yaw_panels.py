"""Panels of yaw: raw and corrected yaw, their error against an encoder, and the estimated bias."""

import numpy as np

from gyrodrift.describe.drawing import DescribedSession, Panel, chart_over_time, curve, time_axis
from gyrodrift.describe.yaw import YawHistory
from gyrodrift.facts.rests import RestSource
from gyrodrift.report.chart import Chart, ChartSeries, Mark, Part, Shape, error_scale, line, scale_of
from gyrodrift.report.numbers import minus, significant
from gyrodrift.values.arrays import Floats

LEAST_YAW_DEG = 2.0
LEAST_BIAS_DPS = 0.1
"""Smallest spans of the scales; 0.1 deg/s is 6 degrees of yaw a minute."""

SIGMAS = 2.0
BINS = 40
LEAST_HISTOGRAM_DEG = 0.02
"""A histogram is at least this wide; an encoder of 4096 counts resolves 0.09 degrees."""

CENTRAL_SHARE = 0.95
OUTSIDE_SHARE = 0.01
"""Share of the samples outside of the histogram, counted in its end bins: a few large errors would hide its shape."""

RAW = Mark("raw", "plain", "key", "raw: the integrated rate")
ENCODER = Mark("encoder", "ink", "key dotted", "encoder")


def error_panel(described: DescribedSession) -> Panel | None:
    """The yaw error over time; None without an encoder."""
    yaw = described.yaw
    if yaw is None or not yaw.has_reference:
        return None
    marks = (RAW, corrected_mark(yaw), *_band_mark(yaw))
    return Panel("Yaw error", marks, _error_chart(yaw))


def yaw_panels(described: DescribedSession) -> list[Panel]:
    """Yaw, raw and corrected, and the bias that the filter estimates."""
    yaw = described.yaw
    if yaw is None:
        return []
    marks = (RAW, corrected_mark(yaw), *_band_mark(yaw), *[ENCODER] * yaw.has_reference)
    has_rests = described.description.still_by is RestSource.ENCODER and bool(described.description.stretches)
    rests = Mark("still", "three", "key", "mean rate while the encoder stands still")
    bias_marks = (_bias_mark(yaw), *[rests] * has_rests)
    return [
        Panel("Yaw", marks, _yaw_chart(yaw)),
        Panel("Bias", bias_marks, _bias_chart(described, yaw, has_rests=has_rests)),
    ]


def histogram_panel(described: DescribedSession) -> Panel | None:
    """Shares of the samples by their corrected yaw error; None without an encoder."""
    yaw = described.yaw
    if yaw is None or not yaw.has_reference:
        return None
    errors_deg = yaw.corrected_error_deg[np.isfinite(yaw.corrected_error_deg)]
    tail = 0.5 * (1.0 - CENTRAL_SHARE)
    low_deg, high_deg = np.quantile(errors_deg, [tail, 1.0 - tail]).tolist()
    span = minus(f"{significant(low_deg, 3)} to {significant(high_deg, 3)}°")
    marks = (
        Mark("", "tuned", "key", f"samples, by the error of {yaw.filter_name}"),
        Mark("", "three", "key dotted", f"95 % of the samples: {span}"),
    )
    return Panel("Histogram of errors", marks, _histogram_chart(errors_deg, (low_deg, high_deg)))


def corrected_mark(yaw: YawHistory) -> Mark:
    """Legend entry of the corrected yaw."""
    return Mark("corrected", "tuned", "key", f"corrected by {yaw.filter_name}")


def _bias_mark(yaw: YawHistory) -> Mark:
    return Mark("bias", "tuned", "key", f"bias that {yaw.filter_name} estimates")


def _band_mark(yaw: YawHistory) -> tuple[Mark, ...]:
    """Legend entry of the band that the filter states for its yaw; empty if it states none."""
    has_sigma = bool(np.isfinite(yaw.sigma_deg).any())
    return (Mark("band", "tuned", "key thin", f"± {SIGMAS:g} σ that {yaw.filter_name} states"),) * has_sigma


def _yaw_times(yaw: YawHistory) -> tuple[Floats, str]:
    return time_axis(yaw.t_s, float(yaw.t_s[-1]))


def _yaw_chart(yaw: YawHistory) -> Chart:
    t = _yaw_times(yaw)[0]
    curves = [
        curve(RAW, t, yaw.raw_deg, "raw"),
        *_band(yaw, t, yaw.corrected_deg),
        curve(corrected_mark(yaw), t, yaw.corrected_deg, "corrected"),
        *[curve(ENCODER, t, yaw.reference_deg, "encoder")] * yaw.has_reference,
    ]
    y = scale_of("yaw, deg", [series.y for series in curves], LEAST_YAW_DEG)
    return chart_over_time("Yaw", _yaw_times(yaw), y, curves)


def _band(yaw: YawHistory, t: Floats, middle_deg: Floats) -> list[ChartSeries]:
    return [
        curve(mark, t, middle_deg + sign * yaw.sigma_deg, "") for mark in _band_mark(yaw) for sign in (-SIGMAS, SIGMAS)
    ]


def _error_chart(yaw: YawHistory) -> Chart:
    t, raw_deg, corrected_deg = _yaw_times(yaw)[0], yaw.raw_error_deg, yaw.corrected_error_deg
    curves = [
        *_band(yaw, t, np.zeros_like(t)),
        curve(RAW, t, raw_deg, "raw"),
        curve(corrected_mark(yaw), t, corrected_deg, "corrected"),
    ]
    return chart_over_time(
        "Yaw error", _yaw_times(yaw), error_scale("yaw error, deg", [raw_deg, corrected_deg]), curves, 300
    )


def _bias_chart(described: DescribedSession, yaw: YawHistory, *, has_rests: bool) -> Chart:
    times, label = _yaw_times(yaw)
    bias = curve(_bias_mark(yaw), times, yaw.bias_dps, "bias")
    stretches = described.description.stretches if has_rests else ()
    ends, _ = time_axis(np.array([(rest.start_s, rest.end_s) for rest in stretches]).reshape(-1, 2), float(yaw.t_s[-1]))
    means_dps = np.array([rest.mean_dps for rest in stretches])
    rests = ChartSeries(
        ends[:, 0], means_dps, "three", Shape.STROKES, ends[:, 1], means_dps, key="still", name="at rest", width=4.0
    )
    y = scale_of("bias, deg/s", [bias.y, means_dps], LEAST_BIAS_DPS)
    return chart_over_time("Bias", (times, label), y, [bias, *[rests] * has_rests])


def _histogram_chart(errors_deg: Floats, central_deg: tuple[float, float]) -> Chart:
    low_deg, high_deg = np.quantile(errors_deg, [0.5 * OUTSIDE_SHARE, 1.0 - 0.5 * OUTSIDE_SHARE]).tolist()
    middle_deg, half_deg = 0.5 * (low_deg + high_deg), 0.5 * max(high_deg - low_deg, LEAST_HISTOGRAM_DEG)
    ends_deg = (middle_deg - half_deg, middle_deg + half_deg)
    counts, edges_deg = np.histogram(np.clip(errors_deg, *ends_deg), BINS, ends_deg)
    shares, bottom = 100.0 * counts / len(errors_deg), np.zeros(BINS)
    series = [
        ChartSeries(edges_deg[:-1], bottom, "tuned", Shape.BOXES, edges_deg[1:], shares, opacity=0.6),
        *(line(x=edge_deg, color="three", dash="dotted", width=1.8) for edge_deg in central_deg),
    ]
    y = scale_of("samples, %", [np.array([0.0, 1.05 * shares.max()])], margin=0.0)
    return Chart("Histogram of errors", scale_of("corrected yaw error, deg", [edges_deg]), [Part(y, series)])
