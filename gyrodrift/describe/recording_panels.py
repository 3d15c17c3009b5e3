"""Panels of the recording: rate, temperature, drift against temperature, time steps, delay of arrival, noise."""

from collections.abc import Iterator

import numpy as np
from matplotlib.axes import Axes

from gyrodrift.describe.drawing import (
    DescribedSession,
    Mark,
    Panel,
    draw_parts,
    finish_axes,
    seconds_of,
    session_times,
    time_axis,
)
from gyrodrift.describe.temperature import TemperatureDrift, temperature_drift
from gyrodrift.facts.allan import Allan, allan_errors
from gyrodrift.facts.host import host_delays_s
from gyrodrift.facts.rests import RestSource
from gyrodrift.facts.session_facts import GAP_PERIODS
from gyrodrift.html.numbers import significant
from gyrodrift.html.svg import FIVE, INK, PLAIN, QUIET, THREE, label_factors, label_steps
from gyrodrift.values.arrays import Floats
from gyrodrift.values.noise import FLICKER_FLOOR, hourly_rate_text, random_walk_text

SHADES = 300
"""At most this many gaps and rests are drawn, the longest."""

GAP_MARK = 0.96
"""Gaps have a mark from this height of the axes up, because most are too short to be seen."""

LEAST_RATE_DPS = 1.0
LEAST_DRIFT_DPS = 0.02
LEAST_TEMPERATURE_C = 2.0
LEAST_DELAY_MS = 5.0
LEAST_STEP_PERIODS = 0.2
LEAST_DECADE = 10.0
"""Smallest spans of the scales: noise that does not matter for yaw looks flat."""

LEAST_CHANGE_MS = 1e-3
"""Times that change by less are constant: their panel would show a straight line."""

MARGIN = 0.05
"""Share of the delay scale below 0."""

MEASURED: Mark = ("rate", "quiet", "key", "measured rate: mean and range")


def recording_panels(described: DescribedSession) -> Iterator[Panel]:
    """The panels that have something to show."""
    description = described.description
    if description.rate is not None and np.isfinite(described.session.t_device_s).any():
        yield Panel("Rate", _rate_marks(described), lambda axes: _draw_rate(axes, described))
    yield from _temperature_panels(described)
    yield from _time_panels(described)
    if description.allan is not None and (description.allan.deviations_dps > 0.0).all():
        allan = description.allan
        yield Panel("Noise at rest", _noise_marks(allan), lambda axes: _draw_noise(axes, allan))


def _temperature_panels(described: DescribedSession) -> Iterator[Panel]:
    if described.description.temperature is None:
        return
    yield Panel("Temperature", (), lambda axes: _draw_temperature(axes, described))
    drift = temperature_drift(described.session, described.description, described.yaw)
    if drift is not None:
        yield Panel("Drift against temperature", _drift_marks(drift), lambda axes: _draw_drift(axes, drift))


def _time_panels(described: DescribedSession) -> Iterator[Panel]:
    """Time steps and delays, if they change at all."""
    rate_hz = described.description.rate_hz
    if rate_hz is not None and _changes(np.diff(seconds_of(described.session))):
        yield Panel("Time from sample to sample", (), lambda axes: _draw_steps(axes, described))
    delays_s = host_delays_s(described.session, None if rate_hz is None else 1.0 / rate_hz)
    if delays_s is not None and _changes(delays_s):
        yield Panel("Delay of arrival", (), lambda axes: _draw_delays(axes, described, delays_s))


def _changes(times_s: Floats) -> bool:
    finite_s = times_s[np.isfinite(times_s)]
    return len(finite_s) > 0 and 1e3 * float(np.ptp(finite_s)) > LEAST_CHANGE_MS


def _rate_marks(described: DescribedSession) -> tuple[Mark, ...]:
    description = described.description
    by_encoder = description.still_by is RestSource.ENCODER
    still = "at rest, by the encoder" if by_encoder else "steady rate: at rest, or a constant spin"
    marks = [MEASURED]
    marks += [("still", "three", "key", still)] * bool(description.stretches)
    marks += [("gap", "five", "key", "gap: samples are missing")] * bool(description.gaps.count)
    return tuple(marks)


def _draw_rate(axes: Axes, described: DescribedSession) -> None:
    t, label = session_times(described)
    draw_parts(axes, t, described.session.rate_dps, QUIET)
    longest = sorted(described.description.stretches, key=lambda rest: rest.start_s - rest.end_s)[:SHADES]
    for rest in longest:
        ends, _ = time_axis(np.array([rest.start_s, rest.end_s]), described.description.duration_s)
        axes.axvspan(*ends.tolist(), color=THREE, alpha=0.22, linewidth=0)
    for start, end in zip(*_gap_ends(t, described), strict=True):
        axes.axvspan(start, end, color=FIVE, alpha=0.2, linewidth=0)
        axes.axvspan(start, end, GAP_MARK, color=FIVE, linewidth=0.8)
    finish_axes(axes, label, "rate, deg/s", LEAST_RATE_DPS)


def _gap_ends(t: Floats, described: DescribedSession) -> tuple[list[float], list[float]]:
    """Starts and ends of the longest gaps on the time axis."""
    if described.description.rate_hz is None:
        return [], []
    steps_s = np.diff(seconds_of(described.session))
    before = np.flatnonzero(steps_s > GAP_PERIODS / described.description.rate_hz)
    before = before[np.argsort(-steps_s[before])[:SHADES]]
    return t[before].tolist(), t[before + 1].tolist()


def _draw_temperature(axes: Axes, described: DescribedSession) -> None:
    t, label = session_times(described)
    if described.session.temp_c is not None:
        draw_parts(axes, t, described.session.temp_c, INK)
    finish_axes(axes, label, "temperature, °C", LEAST_TEMPERATURE_C)


def _drift_marks(drift: TemperatureDrift) -> tuple[Mark, ...]:
    slope = f"{significant(drift.slope_dps_per_c, 2)} deg/s per °C".replace("-", "−")
    return ("drift", "plain", "dot", drift.source), ("slope", "ink", "key dotted", f"slope: {slope}")


def _draw_drift(axes: Axes, drift: TemperatureDrift) -> None:
    axes.plot(drift.temp_c, drift.drift_dps, ".", color=PLAIN, markersize=4.0, alpha=0.7)
    ends_c = np.array([drift.temp_c.min(), drift.temp_c.max()])
    axes.plot(ends_c, drift.line_dps(ends_c), ":", color=INK, linewidth=1.3)
    finish_axes(axes, "temperature, °C", "drift of the rate, deg/s", LEAST_DRIFT_DPS)
    label_steps(axes.xaxis, 6)


def _draw_steps(axes: Axes, described: DescribedSession) -> None:
    t, label = session_times(described)
    steps_ms = np.round(1e3 * np.diff(seconds_of(described.session)), 6)  # finer digits are rounding errors
    draw_parts(axes, t[1:], steps_ms, INK)
    period_ms = 1e3 / (described.description.rate_hz or 1.0)
    finish_axes(axes, label, "step, ms", LEAST_STEP_PERIODS * period_ms)


def _draw_delays(axes: Axes, described: DescribedSession, delays_s: Floats) -> None:
    t, label = session_times(described)
    draw_parts(axes, t, 1e3 * delays_s, INK)
    high = max(axes.get_ylim()[1], LEAST_DELAY_MS)
    axes.set_ylim(-MARGIN * high, high)
    finish_axes(axes, label, "delay above minimum, ms", LEAST_DELAY_MS)


def _noise_marks(allan: Allan) -> tuple[Mark, ...]:
    walk, instability_dps = allan.angle_random_walk_deg_rts, allan.bias_instability_dps
    marks: list[Mark] = [("allan", "ink", "key", "Allan deviation, ± 1 standard error")]
    if walk is not None:
        marks.append(("walk", "plain", "key dashed", f"angle random walk, {random_walk_text(walk)}"))
    if instability_dps is not None:
        words = f"bias instability × 0.664, {hourly_rate_text(FLICKER_FLOOR * instability_dps)}"
        marks.append(("floor", "three", "key dotted", words))
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
    """Show at least a decade, so that a flat Allan deviation looks flat."""
    low, high = axes.get_ylim()
    if high < LEAST_DECADE * low:
        middle = (low * high) ** 0.5
        axes.set_ylim(middle / LEAST_DECADE**0.5, middle * LEAST_DECADE**0.5)
    label_factors(axes.xaxis, *axes.get_xlim(), 6)
    label_factors(axes.yaxis, *axes.get_ylim(), 5)
