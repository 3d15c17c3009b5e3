"""Panels of the recording: rate, temperature, drift against temperature, time steps, delay of arrival, noise."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from gyrodrift.describe.drawing import (
    DescribedSession,
    Panel,
    chart_over_time,
    noisy_line,
    seconds_of,
    session_times,
    time_axis,
)
from gyrodrift.describe.yaw import YawHistory
from gyrodrift.facts.allan import Allan, allan_errors
from gyrodrift.facts.host import host_delays_s
from gyrodrift.facts.rests import RestSource
from gyrodrift.facts.session_facts import GAP_PERIODS, SessionFacts
from gyrodrift.report.chart import (
    AxisScale,
    Chart,
    ChartSeries,
    Mark,
    Part,
    ScaleKind,
    Shape,
    line,
    log_scale,
    scale_of,
)
from gyrodrift.report.numbers import minus, significant
from gyrodrift.session.session import Session
from gyrodrift.values.arrays import Floats
from gyrodrift.values.noise import FLICKER_FLOOR, hourly_rate_text, random_walk_text

LEAST_RANGE_C = 1.0
LEAST_POINTS = 3
"""Fewer rests, or a smaller range of temperatures, show no dependence."""

WINDOW_S = 10.0
MOST_WINDOWS = 300
"""Rates are averaged over windows of at least 10 s, at most 300 of them."""

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

MEASURED = Mark("", "quiet", "key", "measured rate: mean and range")


@dataclass(frozen=True, slots=True, eq=False)
class TemperatureDrift:
    """Drift at k temperatures, k ≥ 3.

    temp_c, drift_dps
        Temperatures in °C and drift of the rate in deg/s, shape (k,).
    slope_dps_per_c, offset_dps
        Least-squares line through them, offset at 0 °C.
    source
        Words for how the drift was measured.
    """

    temp_c: Floats
    drift_dps: Floats
    slope_dps_per_c: float
    offset_dps: float
    source: str

    def line_dps(self, temp_c: Floats) -> Floats:
        """The line at some temperatures, deg/s."""
        return self.offset_dps + self.slope_dps_per_c * temp_c


def temperature_drift(session: Session, facts: SessionFacts, yaw: YawHistory | None) -> TemperatureDrift | None:
    """Mean rates at rest, or else the rate less the encoder's; None if neither spans 1 °C in 3 windows."""
    if session.temp_c is None:
        return None
    at_rest = _fitted(*_rest_points(session, session.temp_c, facts), "mean rate at rest")
    if at_rest is not None or yaw is None or not yaw.has_reference:
        return at_rest
    return _fitted(*_error_points(session, session.temp_c, yaw), "mean error of the rate, by the encoder")


def _fitted(temp_c: Floats, drift_dps: Floats, source: str) -> TemperatureDrift | None:
    is_finite = np.isfinite(temp_c) & np.isfinite(drift_dps)
    temp_c, drift_dps = temp_c[is_finite], drift_dps[is_finite]
    if len(temp_c) < LEAST_POINTS or float(np.ptp(temp_c)) < LEAST_RANGE_C:
        return None
    slope, offset = np.polyfit(temp_c, drift_dps, 1).tolist()
    return TemperatureDrift(temp_c, drift_dps, slope, offset, source)


def _rest_points(session: Session, temp_c: Floats, facts: SessionFacts) -> tuple[Floats, Floats]:
    """Mean temperature and mean rate of windows at rest."""
    rests = facts.stretches
    window_s = max(WINDOW_S, sum(rest.seconds for rest in rests) / MOST_WINDOWS)
    edges_s = [_windows(rest.start_s, rest.end_s, window_s) for rest in rests]
    windows_s = np.concatenate([np.empty((0, 2)), *edges_s])
    t_s = _seconds(session)
    return _means(t_s, temp_c, windows_s), _means(t_s, session.rate_dps, windows_s)


def _error_points(session: Session, temp_c: Floats, yaw: YawHistory) -> tuple[Floats, Floats]:
    """Mean temperature and slope of the raw yaw error, window by window."""
    span_s = float(yaw.t_s[-1])
    windows_s = _windows(0.0, span_s, max(WINDOW_S, span_s / MOST_WINDOWS))
    is_finite = np.isfinite(yaw.raw_error_deg)
    finite_s, finite_deg = yaw.t_s[is_finite], yaw.raw_error_deg[is_finite]
    error_deg = np.interp(windows_s, finite_s, finite_deg, left=np.nan, right=np.nan)
    drift_dps = np.diff(error_deg, axis=1)[:, 0] / np.diff(windows_s, axis=1)[:, 0]
    return _means(_seconds(session), temp_c, windows_s), drift_dps


def _windows(start_s: float, end_s: float, window_s: float) -> Floats:
    """Starts and ends of the k ≥ 1 equal parts of a span that are at least `window_s` long, shape (k, 2)."""
    edges_s = np.linspace(start_s, end_s, max(1, int((end_s - start_s) / window_s)) + 1)
    return np.column_stack([edges_s[:-1], edges_s[1:]])


def _seconds(session: Session) -> Floats:
    finite_s = session.t_device_s[np.isfinite(session.t_device_s)]
    return session.t_device_s - (finite_s[0] if len(finite_s) else 0.0)


def _means(t_s: Floats, values: Floats, windows_s: Floats) -> Floats:
    """Mean of the finite values in each window, shape (k,), NaN for an empty window."""
    order = np.argsort(t_s, kind="stable")
    t_s, values = t_s[order], values[order]
    is_finite = np.isfinite(values)
    counts = np.concatenate([[0], np.cumsum(is_finite)])
    sums = np.concatenate([[0.0], np.cumsum(np.where(is_finite, values, 0.0))])
    first = np.searchsorted(t_s, windows_s[:, 0])
    last = np.searchsorted(t_s, windows_s[:, 1], side="right")
    with np.errstate(invalid="ignore", divide="ignore"):
        means: Floats = (sums[last] - sums[first]) / (counts[last] - counts[first])
    return means


def recording_panels(described: DescribedSession) -> Iterator[Panel]:
    """The panels that have something to show."""
    description = described.description
    if description.rate is not None and np.isfinite(described.session.t_device_s).any():
        yield Panel("Rate", _rate_marks(described), _rate_chart(described))
    yield from _temperature_panels(described)
    yield from _time_panels(described)
    if description.allan is not None and (description.allan.deviations_dps > 0.0).all():
        yield Panel("Noise at rest", _noise_marks(description.allan), _noise_chart(description.allan))


def _temperature_panels(described: DescribedSession) -> Iterator[Panel]:
    if described.description.temperature is None:
        return
    yield Panel("Temperature", (), _temperature_chart(described))
    drift = temperature_drift(described.session, described.description, described.yaw)
    if drift is not None:
        yield Panel("Drift against temperature", _drift_marks(drift), _drift_chart(drift))


def _time_panels(described: DescribedSession) -> Iterator[Panel]:
    """Time steps and delays, if they change at all."""
    rate_hz = described.description.rate_hz
    if rate_hz is not None and _changes(np.diff(seconds_of(described.session))):
        yield Panel("Time from sample to sample", (), _steps_chart(described))
    delays_s = host_delays_s(described.session, None if rate_hz is None else 1.0 / rate_hz)
    if delays_s is not None and _changes(delays_s):
        yield Panel("Delay of arrival", (), _delays_chart(described, delays_s))


def _changes(times_s: Floats) -> bool:
    finite_s = times_s[np.isfinite(times_s)]
    return len(finite_s) > 0 and 1e3 * float(np.ptp(finite_s)) > LEAST_CHANGE_MS


def _rate_marks(described: DescribedSession) -> tuple[Mark, ...]:
    description = described.description
    by_encoder = description.still_by is RestSource.ENCODER
    still = "at rest, by the encoder" if by_encoder else "steady rate: at rest, or a constant spin"
    marks = [MEASURED]
    marks += [Mark("", "three", "key", still)] * bool(description.stretches)
    marks += [Mark("", "five", "key", "gap: samples are missing")] * bool(description.gaps.count)
    return tuple(marks)


def _rate_chart(described: DescribedSession) -> Chart:
    times = session_times(described)
    y = scale_of("rate, deg/s", [described.session.rate_dps], LEAST_RATE_DPS)
    longest = sorted(described.description.stretches, key=lambda rest: rest.start_s - rest.end_s)[:SHADES]
    rests, _ = time_axis(
        np.array([(rest.start_s, rest.end_s) for rest in longest]).reshape(-1, 2), described.description.duration_s
    )
    starts, ends = _gap_ends(times[0], described)
    marks = np.full(len(starts), y.low + GAP_MARK * (y.high - y.low))
    series = [
        *noisy_line(times[0], described.session.rate_dps, "quiet", "rate"),
        _shades(rests[:, 0], rests[:, 1], "three", 0.22),
        _shades(starts, ends, "five", 0.2),
        ChartSeries(starts, marks, "five", Shape.STROKES, starts, np.full(len(starts), np.inf)),
    ]
    return chart_over_time("Rate", times, y, series)


def _shades(starts: Floats, ends: Floats, color: str, opacity: float) -> ChartSeries:
    """Shaded times over the whole height."""
    infinite = np.full(len(starts), np.inf)
    return ChartSeries(starts, -infinite, color, Shape.BOXES, ends, infinite, opacity=opacity)


def _gap_ends(t: Floats, described: DescribedSession) -> tuple[Floats, Floats]:
    """Starts and ends of the longest gaps on the time axis."""
    if described.description.rate_hz is None:
        return np.empty(0), np.empty(0)
    steps_s = np.diff(seconds_of(described.session))
    before = np.flatnonzero(steps_s > GAP_PERIODS / described.description.rate_hz)
    before = before[np.argsort(-steps_s[before])[:SHADES]]
    return t[before], t[before + 1]


def _temperature_chart(described: DescribedSession) -> Chart:
    times, temp_c = session_times(described), described.session.temp_c
    columns = [] if temp_c is None else [temp_c]
    series = [part for column in columns for part in noisy_line(times[0], column, "ink", "temperature")]
    return chart_over_time("Temperature", times, scale_of("temperature, °C", columns, LEAST_TEMPERATURE_C), series)


def _drift_marks(drift: TemperatureDrift) -> tuple[Mark, ...]:
    slope = minus(f"{significant(drift.slope_dps_per_c, 2)} deg/s per °C")
    return Mark("", "plain", "dot", drift.source), Mark("", "ink", "key dotted", f"slope: {slope}")


def _drift_chart(drift: TemperatureDrift) -> Chart:
    ends_c = np.array([drift.temp_c.min(), drift.temp_c.max()])
    series = [
        ChartSeries(drift.temp_c, drift.drift_dps, "plain", Shape.DOTS, name="drift", width=5.0, opacity=0.7),
        ChartSeries(ends_c, drift.line_dps(ends_c), "ink", dash="dotted", width=1.7),
    ]
    y = scale_of("drift of the rate, deg/s", [drift.drift_dps, drift.line_dps(ends_c)], LEAST_DRIFT_DPS)
    return Chart("Drift against temperature", scale_of("temperature, °C", [ends_c]), [Part(y, series)])


def _steps_chart(described: DescribedSession) -> Chart:
    t, label = session_times(described)
    steps_ms = np.round(1e3 * np.diff(seconds_of(described.session)), 6)  # finer digits are rounding errors
    period_ms = 1e3 / (described.description.rate_hz or 1.0)
    y = scale_of("step, ms", [steps_ms], LEAST_STEP_PERIODS * period_ms)
    return chart_over_time("Time from sample to sample", (t, label), y, noisy_line(t[1:], steps_ms, "ink", "step"))


def _delays_chart(described: DescribedSession, delays_s: Floats) -> Chart:
    times, delays_ms = session_times(described), 1e3 * delays_s
    high = max(scale_of("", [delays_ms]).high, LEAST_DELAY_MS)
    y = AxisScale("delay above minimum, ms", -MARGIN * high, high)
    return chart_over_time("Delay of arrival", times, y, noisy_line(times[0], delays_ms, "ink", "delay"))


def _noise_marks(allan: Allan) -> tuple[Mark, ...]:
    walk, instability_dps = allan.angle_random_walk_deg_rts, allan.bias_instability_dps
    marks = [Mark("", "ink", "key", "Allan deviation, ± 1 standard error")]
    if walk is not None:
        marks.append(Mark("", "plain", "key dashed", f"angle random walk, {random_walk_text(walk)}"))
    if instability_dps is not None:
        words = f"bias instability × 0.664, {hourly_rate_text(FLICKER_FLOOR * instability_dps)}"
        marks.append(Mark("", "three", "key dotted", words))
    return tuple(marks)


def _noise_chart(allan: Allan) -> Chart:
    """The Allan deviation over at least a decade, so that a flat one looks flat."""
    taus_s, deviations_dps = allan.taus_s, allan.deviations_dps
    errors = allan_errors(taus_s, allan.stretch.end_s - allan.stretch.start_s)
    low_dps, high_dps = deviations_dps * (1.0 - errors), deviations_dps * (1.0 + errors)
    series = [
        ChartSeries(taus_s, low_dps, "ink", Shape.BAND, y_end=high_dps, opacity=0.15),
        ChartSeries(taus_s, deviations_dps, "ink", name="Allan deviation", width=1.7),
    ]
    drawn = [deviations_dps, low_dps, high_dps]
    if allan.angle_random_walk_deg_rts is not None:
        drawn.append(allan.angle_random_walk_deg_rts / np.sqrt(taus_s))
        series.append(ChartSeries(taus_s, drawn[-1], "plain", dash="dashed"))
    if allan.bias_instability_dps is not None:
        floor_dps = FLICKER_FLOOR * allan.bias_instability_dps
        drawn.append(np.array([floor_dps]))
        series.append(line(y=floor_dps, color="three", dash="dotted", width=1.8))
    x = AxisScale("averaging time, s", float(taus_s[0]), float(taus_s[-1]), ScaleKind.LOG)
    return Chart("Noise at rest", x, [Part(log_scale("Allan deviation, deg/s", drawn, LEAST_DECADE), series)])
