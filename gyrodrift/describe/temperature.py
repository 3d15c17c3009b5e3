"""Drift of the rate against the temperature of the sensor."""

from dataclasses import dataclass

import numpy as np

from gyrodrift.describe.yaw import YawHistory
from gyrodrift.facts.session_facts import SessionFacts
from gyrodrift.session.session import Session
from gyrodrift.values.arrays import Floats

LEAST_RANGE_C = 1.0
LEAST_POINTS = 3
"""Fewer rests, or a smaller range of temperatures, show no dependence."""

WINDOW_S = 10.0
MOST_WINDOWS = 300
"""Rates are averaged over windows of at least 10 s, at most 300 of them."""


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
