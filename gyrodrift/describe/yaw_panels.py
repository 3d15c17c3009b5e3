"""Panels of yaw: raw and corrected yaw, their error against an encoder, and the estimated bias."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from gyrodrift.describe.drawing import (
    DescribedSession,
    Mark,
    Panel,
    draw_curve,
    finish_axes,
    label_times,
    time_axis,
)
from gyrodrift.describe.yaw import YawHistory
from gyrodrift.facts.rests import RestSource
from gyrodrift.html.numbers import factor_label, significant
from gyrodrift.html.svg import THREE, TUNED, label_steps, switched
from gyrodrift.values.arrays import Floats

LEAST_YAW_DEG = 2.0
LEAST_BIAS_DPS = 0.1
"""Smallest spans of the scales; 0.1 deg/s is 6 degrees of yaw a minute."""

LINEAR_DEG = 1.0
"""The error scale is linear within this error and logarithmic beyond it."""

SIGMAS = 2.0
BINS = 40
LEAST_HISTOGRAM_DEG = 0.02
"""A histogram is at least this wide; an encoder of 4096 counts resolves 0.09 degrees."""

CENTRAL_SHARE = 0.95
OUTSIDE_SHARE = 0.01
"""Share of the samples outside of the histogram, counted in its end bins: a few large errors would hide its shape."""

RAW: Mark = ("raw", "plain", "key", "raw: the integrated rate")
ENCODER: Mark = ("encoder", "ink", "key dotted", "encoder")


def error_panel(described: DescribedSession) -> Panel | None:
    """The yaw error over time; None without an encoder."""
    yaw = described.yaw
    if yaw is None or not yaw.has_reference:
        return None
    marks = (RAW, corrected_mark(yaw), *_band_mark(yaw))
    return Panel("Yaw error", marks, lambda axes: _draw_error(axes, yaw))


def yaw_panels(described: DescribedSession) -> list[Panel]:
    """Yaw, raw and corrected, and the bias that the filter estimates."""
    yaw = described.yaw
    if yaw is None:
        return []
    marks = (RAW, corrected_mark(yaw), *_band_mark(yaw), *[ENCODER] * yaw.has_reference)
    has_rests = described.description.still_by is RestSource.ENCODER and bool(described.description.stretches)
    rests: Mark = ("still", "three", "key", "mean rate while the encoder stands still")
    bias_marks = (_bias_mark(yaw), *[rests] * has_rests)
    return [
        Panel("Yaw", marks, lambda axes: _draw_yaw(axes, yaw)),
        Panel("Bias", bias_marks, lambda axes: _draw_bias(axes, described, yaw, has_rests=has_rests)),
    ]


def histogram_panel(described: DescribedSession) -> Panel | None:
    """Shares of the samples by their corrected yaw error; None without an encoder."""
    yaw = described.yaw
    if yaw is None or not yaw.has_reference:
        return None
    errors_deg = yaw.corrected_error_deg[np.isfinite(yaw.corrected_error_deg)]
    tail = 0.5 * (1.0 - CENTRAL_SHARE)
    low_deg, high_deg = np.quantile(errors_deg, [tail, 1.0 - tail]).tolist()
    span = f"{significant(low_deg, 3)} to {significant(high_deg, 3)}°".replace("-", "−")
    marks: tuple[Mark, ...] = (
        ("share", "tuned", "key", f"samples, by the error of {yaw.filter_name}"),
        ("central", "three", "key dotted", f"95 % of the samples: {span}"),
    )
    return Panel("Histogram of errors", marks, lambda axes: _draw_histogram(axes, errors_deg, (low_deg, high_deg)))


def corrected_mark(yaw: YawHistory) -> Mark:
    """Legend entry of the corrected yaw."""
    return ("corrected", "tuned", "key", f"corrected by {yaw.filter_name}")


def _bias_mark(yaw: YawHistory) -> Mark:
    return ("bias", "tuned", "key", f"bias that {yaw.filter_name} estimates")


def _band_mark(yaw: YawHistory) -> tuple[Mark, ...]:
    """Legend entry of the band that the filter states for its yaw; empty if it states none."""
    has_sigma = bool(np.isfinite(yaw.sigma_deg).any())
    return (("band", "tuned", "key thin", f"± {SIGMAS:g} σ that {yaw.filter_name} states"),) * has_sigma


def _yaw_times(yaw: YawHistory) -> tuple[Floats, str]:
    return time_axis(yaw.t_s, float(yaw.t_s[-1]))


def _draw_yaw(axes: Axes, yaw: YawHistory) -> None:
    t, label = _yaw_times(yaw)
    draw_curve(axes, RAW, t, yaw.raw_deg)
    _draw_band(axes, yaw, t, yaw.corrected_deg)
    draw_curve(axes, corrected_mark(yaw), t, yaw.corrected_deg)
    if yaw.has_reference:
        draw_curve(axes, ENCODER, t, yaw.reference_deg)
    finish_axes(axes, label, "yaw, deg", LEAST_YAW_DEG)


def _draw_band(axes: Axes, yaw: YawHistory, t: Floats, middle_deg: Floats) -> None:
    for mark in _band_mark(yaw):
        for sign in (-SIGMAS, SIGMAS):
            draw_curve(axes, mark, t, middle_deg + sign * yaw.sigma_deg)


def _draw_error(axes: Axes, yaw: YawHistory) -> None:
    t, label = _yaw_times(yaw)
    raw_deg, corrected_deg = yaw.raw_error_deg, yaw.corrected_error_deg
    _draw_band(axes, yaw, t, np.zeros_like(t))
    draw_curve(axes, RAW, t, raw_deg)
    draw_curve(axes, corrected_mark(yaw), t, corrected_deg)
    _scale_errors(axes, np.concatenate([raw_deg, corrected_deg]))
    label_times(axes, label)
    axes.set_ylabel("yaw error, deg")


def _scale_errors(axes: Axes, errors_deg: Floats) -> None:
    """Scale linearly within a degree and by decades beyond it, as far as there are errors."""
    finite_deg = errors_deg[np.isfinite(errors_deg)]
    low, high = float(finite_deg.min(initial=-LINEAR_DEG)), float(finite_deg.max(initial=LINEAR_DEG))
    axes.set_yscale("symlog", linthresh=LINEAR_DEG)
    axes.set_ylim(1.3 * low, 1.3 * high)
    decades = 10.0 ** np.arange(0, np.ceil(np.log10(max(-low, high))) + 1)
    every = decades[:: max(1, len(decades) // 3)]
    axes.yaxis.set_major_locator(FixedLocator([*(-every[::-1]), 0.0, *every]))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: _signed(value)))


def _signed(value: float) -> str:
    return f"−{factor_label(-value)}" if value < 0.0 else factor_label(value)


def _draw_bias(axes: Axes, described: DescribedSession, yaw: YawHistory, *, has_rests: bool) -> None:
    t, label = _yaw_times(yaw)
    draw_curve(axes, _bias_mark(yaw), t, yaw.bias_dps)
    for rest in described.description.stretches if has_rests else ():
        ends, _ = time_axis(np.array([rest.start_s, rest.end_s]), float(yaw.t_s[-1]))
        (line,) = axes.plot(ends, [rest.mean_dps] * 2, color=THREE, linewidth=3.0, solid_capstyle="butt")
        switched(line, "still")
    finish_axes(axes, label, "bias, deg/s", LEAST_BIAS_DPS)


def _draw_histogram(axes: Axes, errors_deg: Floats, central_deg: tuple[float, float]) -> None:
    low_deg, high_deg = np.quantile(errors_deg, [0.5 * OUTSIDE_SHARE, 1.0 - 0.5 * OUTSIDE_SHARE]).tolist()
    middle_deg, half_deg = 0.5 * (low_deg + high_deg), 0.5 * max(high_deg - low_deg, LEAST_HISTOGRAM_DEG)
    ends_deg = (middle_deg - half_deg, middle_deg + half_deg)
    counts, edges_deg = np.histogram(np.clip(errors_deg, *ends_deg), BINS, ends_deg)
    axes.stairs(100.0 * counts / len(errors_deg), edges_deg, fill=True, color=TUNED, alpha=0.6)
    for edge_deg in central_deg:
        axes.axvline(edge_deg, color=THREE, linestyle=":", linewidth=1.4)
    label_steps(axes.xaxis, 5)
    label_steps(axes.yaxis, 5)
    axes.set_xlabel("corrected yaw error, deg", labelpad=1.0)
    axes.set_ylabel("samples, %")
