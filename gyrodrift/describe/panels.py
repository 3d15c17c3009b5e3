"""What there is to draw of a session, panel by panel, for a picture and for a page; matplotlib comes with `[lab]`.

A panel that would be empty is none. No scale is narrower than what matters: what is negligible should look so.
"""

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator, NullLocator

from gyrodrift.arrays import Floats
from gyrodrift.describe.allan import FLICKER_FLOOR, allan_errors
from gyrodrift.describe.describe import GAP_PERIODS
from gyrodrift.describe.host import host_delays_s
from gyrodrift.describe.values import Allan, RestSource, SessionDescription
from gyrodrift.describe.yaw import YawHistory
from gyrodrift.html.numbers import factor_label, significant
from gyrodrift.html.svg import (
    FIVE,
    INK,
    PLAIN,
    QUIET,
    STEPS,
    THREE,
    TUNED,
    label_factors,
    label_steps,
    switched,
    thinned,
)
from gyrodrift.session.session import Session

PARTS = 400
"""A noisy line is drawn as its mean within its range, in at most so many parts, so that spikes stay."""

SHADES = 300
"""So many gaps and stretches are drawn, the longest ones."""

MARK = 0.96
"""Gaps are marked from this height of the axes up: in time most of them are too short to be seen."""

LEAST_YAW_DEG = 2.0
LEAST_RATE_DPS = 1.0
LEAST_BIAS_DPS = 0.1
"""6 degrees of yaw a minute."""
LEAST_TEMPERATURE_C = 2.0
LEAST_DELAY_MS = 5.0
MARGIN = 0.05
"""Below a delay of 0, which would else lie on the edge."""

LEAST_STEP = 0.2
"""Of the step of time, in periods."""
LEAST_DECADE = 10.0
"""A flat Allan deviation should look flat."""

LINEAR_DEG = 1.0
"""Errors within a degree are drawn to scale, larger ones by factors of ten."""

SIGMAS = 2.0
MINUTES_FROM_S = 300.0
"""Longer sessions are told in minutes."""

Mark = tuple[str, str, str, str]
"""Of a curve: its key for switching, its colour and its shape as classes of the style sheet, and its name."""

RAW: Mark = ("raw", "plain", "key", "raw: the rate, integrated")
ENCODER: Mark = ("encoder", "ink", "key dotted", "encoder")
MEASURED: Mark = ("rate", "quiet", "key", "measured rate: mean within its range")
COLOURS = {"plain": PLAIN, "tuned": TUNED, "ink": INK, "three": THREE, "five": FIVE, "quiet": QUIET}


class Panel(NamedTuple):
    """A panel: its name, what its marks are, and how it is drawn."""

    name: str
    marks: tuple[Mark, ...]
    draw: Callable[[Axes], None]


class Seen(NamedTuple):
    """All that panels are drawn from."""

    session: Session
    description: SessionDescription
    yaw: YawHistory | None


def yaw_panels(seen: Seen) -> list[Panel]:
    """Yaw, raw and corrected; its error, where an encoder tells it; the bias that was taken out."""
    yaw = seen.yaw
    if yaw is None:
        return []
    corrected, band = corrected_mark(yaw), _band_mark(yaw)
    marks = (RAW, corrected, *band, *[ENCODER] * yaw.has_reference)
    panels = [Panel("Yaw", marks, lambda axes: _draw_yaw(axes, yaw))]
    if yaw.has_reference:
        panels.append(Panel("Yaw error", (RAW, corrected, *band), lambda axes: _draw_error(axes, yaw)))
    still = seen.description.still_by is RestSource.ENCODER and bool(seen.description.stretches)
    rests: Mark = ("still", "three", "key", "mean rate while the encoder stands still")
    bias: Mark = (corrected[0], corrected[1], corrected[2], f"bias that {yaw.filter_name} estimates")
    panels.append(Panel("Bias", (bias, *[rests] * still), lambda axes: _draw_bias(axes, seen, yaw, has_rests=still)))
    return panels


def recording_panels(seen: Seen) -> Iterator[Panel]:
    """The rate, and how the recording came about: temperature, time, arrival, noise."""
    session, description = seen.session, seen.description
    if description.rate is not None and np.isfinite(session.t_device_s).any():
        yield Panel("Rate", _rate_marks(seen), lambda axes: _draw_rate(axes, seen))
    if description.temperature is not None:
        yield Panel("Temperature", (), lambda axes: _draw_temperature(axes, seen))
    if description.rate_hz is not None:
        yield Panel("Time from sample to sample", (), lambda axes: _draw_steps(axes, seen))
    delays_s = host_delays_s(session, None if description.rate_hz is None else 1.0 / description.rate_hz)
    if delays_s is not None and np.isfinite(delays_s).any():
        yield Panel("Delay of arrival", (), lambda axes: _draw_delays(axes, seen, delays_s))
    if description.allan is not None and (description.allan.deviations_dps > 0.0).all():
        allan = description.allan
        yield Panel("Noise at rest", _noise_marks(allan), lambda axes: _draw_noise(axes, allan))


def corrected_mark(yaw: YawHistory) -> Mark:
    """Of what the filter gives."""
    return ("corrected", "tuned", "key", f"corrected by {yaw.filter_name}")


def _band_mark(yaw: YawHistory) -> tuple[Mark, ...]:
    """Of the band that the filter states for its yaw; empty where it states none."""
    known = bool(np.isfinite(yaw.sigma_deg).any())
    return (("band", "tuned", "key thin", f"± {SIGMAS:g} σ as {yaw.filter_name} states it"),) * known


def _times(seen: Seen, t_s: Floats) -> tuple[Floats, str]:
    """Times from seconds to what a reader takes in at a glance, and the label of their axis."""
    if seen.description.duration_s > MINUTES_FROM_S:
        return t_s / 60.0, "device time, min"
    return t_s, "device time, s"


def _seconds(session: Session) -> Floats:
    """Device time after the first sample, s."""
    finite = session.t_device_s[np.isfinite(session.t_device_s)]
    return session.t_device_s - (finite[0] if len(finite) else 0.0)


class Thinned(NamedTuple):
    """A line in parts, every array of the shape (m,): where each begins, its range and its mean."""

    x: Floats
    low: Floats
    mean: Floats
    high: Floats


def in_parts(x: Floats, y: Floats) -> Thinned:
    """The line in at most `PARTS` parts of equally many samples; what is no number is passed over."""
    starts = np.arange(0, len(y), max(1, -(-len(y) // PARTS)))
    y = np.where(np.isfinite(y), y, np.nan)
    if len(starts) == len(y):
        return Thinned(x, y, y, y)
    counts = np.add.reduceat(np.isfinite(y), starts, dtype=np.float64)
    sums = np.add.reduceat(np.nan_to_num(y), starts)
    means = np.where(counts > 0.0, sums / np.maximum(counts, 1.0), np.nan)
    return Thinned(x[starts], np.fmin.reduceat(y, starts), means, np.fmax.reduceat(y, starts))


def _draw_parts(axes: Axes, x: Floats, y: Floats, colour: str) -> None:
    parts = in_parts(x, y)
    if len(parts.x) < len(x):
        axes.fill_between(parts.x, parts.low, parts.high, color=colour, alpha=0.35, linewidth=0.6)
    marker = "." if len(x) < 2 else ""  # a line through one point is invisible
    axes.plot(parts.x, parts.mean, color=colour, linewidth=1.0, marker=marker)


def _finish(axes: Axes, x_label: str, y_label: str, least_span: float) -> None:
    """Labels, and a vertical scale that spans so much at least."""
    low, high = axes.get_ylim()
    if high - low < least_span:
        middle = 0.5 * (low + high)
        axes.set_ylim(middle - 0.5 * least_span, middle + 0.5 * least_span)
    label_steps(axes.yaxis, 5)
    _label_times(axes, x_label)
    axes.set_ylabel(y_label)


def _label_times(axes: Axes, x_label: str) -> None:
    axes.xaxis.set_major_locator(MaxNLocator(6, steps=STEPS))
    axes.set_xlabel(x_label, labelpad=1.0)


def _draw_curve(axes: Axes, mark: Mark, x: Floats, y: Floats) -> None:
    """A curve that its name switches; wild values are left out rather than drawn."""
    key, colour, shape, _ = mark
    style = ":" if "dotted" in shape else "-"
    wide = 0.7 if "thin" in shape else 1.3
    (line,) = axes.plot(*thinned(x, y), color=COLOURS[colour], linestyle=style, linewidth=wide)
    switched(line, key)


def _draw_yaw(axes: Axes, yaw: YawHistory) -> None:
    t, label = _yaw_times(yaw)
    _draw_curve(axes, RAW, t, yaw.raw_deg)
    _draw_band(axes, yaw, t, yaw.corrected_deg)
    _draw_curve(axes, corrected_mark(yaw), t, yaw.corrected_deg)
    if yaw.has_reference:
        _draw_curve(axes, ENCODER, t, yaw.reference_deg)
    _finish(axes, label, "yaw, deg", LEAST_YAW_DEG)


def _yaw_times(yaw: YawHistory) -> tuple[Floats, str]:
    if yaw.t_s[-1] > MINUTES_FROM_S:
        return yaw.t_s / 60.0, "device time, min"
    return yaw.t_s, "device time, s"


def _draw_band(axes: Axes, yaw: YawHistory, t: Floats, middle_deg: Floats) -> None:
    for mark in _band_mark(yaw):
        for sign in (-SIGMAS, SIGMAS):
            _draw_curve(axes, mark, t, middle_deg + sign * yaw.sigma_deg)


def _draw_error(axes: Axes, yaw: YawHistory) -> None:
    t, label = _yaw_times(yaw)
    raw_deg, corrected_deg = yaw.raw_error_deg, yaw.corrected_error_deg
    _draw_band(axes, yaw, t, np.zeros_like(t))
    _draw_curve(axes, RAW, t, raw_deg)
    _draw_curve(axes, corrected_mark(yaw), t, corrected_deg)
    _scale_errors(axes, np.concatenate([raw_deg, corrected_deg]))
    _label_times(axes, label)
    axes.set_ylabel("yaw error, deg")


def _scale_errors(axes: Axes, errors_deg: Floats) -> None:
    """To scale within a degree, and beyond it by decades, as far as there are errors."""
    known = errors_deg[np.isfinite(errors_deg)]
    low, high = float(known.min(initial=-LINEAR_DEG)), float(known.max(initial=LINEAR_DEG))
    axes.set_yscale("symlog", linthresh=LINEAR_DEG)
    axes.set_ylim(1.3 * low, 1.3 * high)
    decades = 10.0 ** np.arange(0, np.ceil(np.log10(max(-low, high))) + 1)
    every = decades[:: max(1, len(decades) // 3)]
    axes.yaxis.set_major_locator(FixedLocator([*(-every[::-1]), 0.0, *every]))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: _signed(value)))


def _signed(value: float) -> str:
    return f"−{factor_label(-value)}" if value < 0.0 else factor_label(value)


def _draw_bias(axes: Axes, seen: Seen, yaw: YawHistory, *, has_rests: bool) -> None:
    t, label = _yaw_times(yaw)
    _draw_curve(axes, corrected_mark(yaw), t, yaw.bias_dps)
    for one in seen.description.stretches if has_rests else ():
        ends, _ = _times(seen, np.array([one.start_s, one.end_s]))
        (line,) = axes.plot(ends, [one.mean_dps] * 2, color=THREE, linewidth=3.0, solid_capstyle="butt")
        switched(line, "still")
    _finish(axes, label, "bias, deg/s", LEAST_BIAS_DPS)


def _rate_marks(seen: Seen) -> tuple[Mark, ...]:
    description = seen.description
    by_encoder = description.still_by is RestSource.ENCODER
    still = "standing still, by the encoder" if by_encoder else "steady rate: at rest, or an even spin"
    marks = [MEASURED]
    marks += [("still", "three", "key", still)] * bool(description.stretches)
    marks += [("gap", "five", "key", "gap: samples are missing")] * bool(description.gaps.count)
    return tuple(marks)


def _draw_rate(axes: Axes, seen: Seen) -> None:
    t, label = _times(seen, _seconds(seen.session))
    _draw_parts(axes, t, seen.session.rate_dps, QUIET)
    longest = sorted(seen.description.stretches, key=lambda one: one.start_s - one.end_s)[:SHADES]
    for one in longest:
        ends, _ = _times(seen, np.array([one.start_s, one.end_s]))
        axes.axvspan(*ends.tolist(), color=THREE, alpha=0.22, linewidth=0)
    for start, end in zip(*_gaps(t, seen), strict=True):
        axes.axvspan(start, end, color=FIVE, alpha=0.2, linewidth=0)
        axes.axvspan(start, end, MARK, color=FIVE, linewidth=0.8)
    _finish(axes, label, "rate, deg/s", LEAST_RATE_DPS)


def _gaps(t: Floats, seen: Seen) -> tuple[list[float], list[float]]:
    """Where the longest gaps begin and end, on the axis of time."""
    if seen.description.rate_hz is None:
        return [], []
    steps_s = np.diff(_seconds(seen.session))
    before = np.flatnonzero(steps_s > GAP_PERIODS / seen.description.rate_hz)
    before = before[np.argsort(-steps_s[before])[:SHADES]]
    return t[before].tolist(), t[before + 1].tolist()


def _draw_temperature(axes: Axes, seen: Seen) -> None:
    t, label = _times(seen, _seconds(seen.session))
    if seen.session.temp_c is not None:
        _draw_parts(axes, t, seen.session.temp_c, INK)
    _finish(axes, label, "temperature, °C", LEAST_TEMPERATURE_C)


def _draw_steps(axes: Axes, seen: Seen) -> None:
    t_s = _seconds(seen.session)
    t, label = _times(seen, t_s)
    steps_ms = np.round(1e3 * np.diff(t_s), 6)  # finer is what is left of rounding
    _draw_parts(axes, t[1:], steps_ms, INK)
    period_ms = 1e3 / (seen.description.rate_hz or 1.0)
    _finish(axes, label, "step, ms", LEAST_STEP * period_ms)


def _draw_delays(axes: Axes, seen: Seen, delays_s: Floats) -> None:
    """How much later than the soonest possible each sample arrived."""
    t, label = _times(seen, _seconds(seen.session))
    _draw_parts(axes, t, 1e3 * delays_s, INK)
    high = max(axes.get_ylim()[1], LEAST_DELAY_MS)
    axes.set_ylim(-MARGIN * high, high)
    _finish(axes, label, "later than soonest, ms", LEAST_DELAY_MS)


def _noise_marks(allan: Allan) -> tuple[Mark, ...]:
    walk, floor_dps = allan.angle_random_walk_deg_rts, allan.bias_instability_dps
    marks: list[Mark] = [("allan", "ink", "key", "Allan deviation, ± 1 standard error")]
    if walk is not None:
        marks.append(("walk", "plain", "key dashed", f"angle random walk, {significant(walk, 3)} deg/√s"))
    if floor_dps is not None:
        marks.append(("floor", "three", "key dotted", f"bias instability, {significant(floor_dps, 3)} deg/s"))
    return tuple(marks)


def _draw_noise(axes: Axes, allan: Allan) -> None:
    taus_s, deviations_dps = allan.taus_s, allan.deviations_dps
    errors = allan_errors(taus_s, allan.stretch.end_s - allan.stretch.start_s)
    axes.set(xscale="log", yscale="log")
    band = (deviations_dps * (1.0 - errors), deviations_dps * (1.0 + errors))
    axes.fill_between(taus_s, *band, color=INK, alpha=0.15, linewidth=0)
    axes.plot(taus_s, deviations_dps, color=INK, linewidth=1.3)
    if allan.angle_random_walk_deg_rts is not None:
        axes.plot(taus_s, allan.angle_random_walk_deg_rts / np.sqrt(taus_s), "--", color=PLAIN, linewidth=1.1)
    if allan.bias_instability_dps is not None:
        axes.axhline(FLICKER_FLOOR * allan.bias_instability_dps, color=THREE, linestyle=":", linewidth=1.4)
    _scale_noise(axes)
    axes.set_xlabel("averaging time, s", labelpad=1.0)
    axes.set_ylabel("Allan deviation, deg/s")


def _scale_noise(axes: Axes) -> None:
    """A decade at least."""
    low, high = axes.get_ylim()
    if high < LEAST_DECADE * low:
        middle = (low * high) ** 0.5
        axes.set_ylim(middle / LEAST_DECADE**0.5, middle * LEAST_DECADE**0.5)
    label_factors(axes.xaxis, *axes.get_xlim(), 6)
    label_factors(axes.yaxis, *axes.get_ylim(), 5)
