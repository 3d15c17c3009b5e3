"""Clock of the device against the clock of the host."""

from dataclasses import dataclass
from math import ceil, inf, sqrt

import numpy as np

from gyrodrift.facts.arrays import blocks_of, only
from gyrodrift.session.session import Session
from gyrodrift.values.arrays import Floats

WINDOW_S = 1.0
WINDOW_SAMPLES = 20
WINDOWS_LEAST = 10
WINDOWS_MOST = 60
"""Delays of a link are one-sided: only the earliest sample of a window shows the host clock."""

STOPPED = -0.999
"""Change of host − device time over device time of a host clock that moves by less than 0.1 % of the device clock."""

QUANTILE_VALUES = 1_000_000
"""Quantiles of more values than this use an evenly spaced selection."""


@dataclass(frozen=True, slots=True)
class HostClock:
    """The device clock against the host's.

    drift_ppm, drift_sd_ppm
        Rate of the device clock against the host clock, parts per million, and its standard error; None if the session
        is too short.
    delay_p95_s
        95 % of the samples arrived within this time of the minimum delay, s.
    """

    drift_ppm: float | None
    drift_sd_ppm: float | None
    delay_p95_s: float


def host_clock(session: Session, period_s: float | None) -> HostClock | None:
    """Drift and delays of the host clock; None without host times."""
    delays_s, drift = _against_host(session, period_s)
    if delays_s is None:
        return None
    sample_s = delays_s[:: len(delays_s) // QUANTILE_VALUES + 1]
    sample_s = sample_s[np.isfinite(sample_s)]
    if not len(sample_s):
        return None
    delay_p95_s = float(np.quantile(sample_s, 0.95))
    slope, slope_sd = drift or (-1.0, 0.0)
    if slope <= STOPPED:  # a host clock that stands still says nothing
        return HostClock(None, None, delay_p95_s)
    return HostClock(-1e6 * slope / (1.0 + slope), 1e6 * slope_sd, delay_p95_s)


def host_delays_s(session: Session, period_s: float | None) -> Floats | None:
    """Delay of each sample above the minimum, s, shape (n,); None without host times.

    The minimum is the line under (device time, host time), or the earliest sample if there are too few for a line.
    """
    return _against_host(session, period_s)[0]


def _against_host(session: Session, period_s: float | None) -> tuple[Floats | None, tuple[float, float] | None]:
    """Delays, and the slope of the line under host − device time over device time with its standard error."""
    if session.t_host_s is None:
        return None, None
    is_timed = np.isfinite(session.t_host_s) & np.isfinite(session.t_device_s)
    if not is_timed.any():
        return None, None
    first = int(is_timed.argmax())
    device_s = session.t_device_s - session.t_device_s[first]
    behind_s = (session.t_host_s - session.t_host_s[first]) - device_s
    minimum = _minimum_line(only(device_s, is_timed), only(behind_s, is_timed), period_s)
    if minimum is None:
        return behind_s - behind_s[is_timed].min(), None
    (slope, intercept_s), slope_sd = minimum
    return behind_s - (intercept_s + slope * device_s), (slope, slope_sd)


def _minimum_line(
    device_s: Floats, behind_s: Floats, period_s: float | None
) -> tuple[tuple[float, float], float] | None:
    """((slope, intercept), standard error of the slope) of the least-squares line through the window minima.

    The errors of neighboring windows are correlated when bunches beat with the period. The standard error therefore
    counts only as many independent windows as the first-order autocorrelation leaves.
    """
    if period_s is None:
        return None
    size = max(WINDOW_SAMPLES, ceil(min(WINDOW_S / period_s, 1e9)), len(device_s) // WINDOWS_MOST)
    windows_s = blocks_of(behind_s, size)
    if len(windows_s) < WINDOWS_LEAST:
        return None
    lowest = windows_s.argmin(axis=1) + size * np.arange(len(windows_s))
    x, y = device_s[lowest], behind_s[lowest]
    dx = x - x.mean()
    spread = float(dx @ dx)
    if not 0.0 < spread < inf:
        return None
    slope = float(dx @ y) / spread
    residuals = y - y.mean() - slope * dx
    square = float(residuals @ residuals)
    correlation = min(max(float(residuals[1:] @ residuals[:-1]) / square, 0.0), 0.9) if square else 0.0
    slope_sd = sqrt(square / (len(x) - 2) / spread * (1.0 + correlation) / (1.0 - correlation))
    return (slope, float(y.mean() - slope * x.mean())), slope_sd
