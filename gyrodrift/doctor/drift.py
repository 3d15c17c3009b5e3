"""Expected error of yaw after a time without any rest, from bias and noise.

The variance of yaw after t seconds is P·t² + N²·t + K²·t³/3. P is the variance of the remaining bias, N white noise
(deg/√s), and K a rate random walk (deg/s/√s).
"""

from dataclasses import dataclass
from math import hypot, sqrt
from typing import Any

from gyrodrift.doctor.still import StillRate
from gyrodrift.evaluation.reference import accepted
from gyrodrift.filters.filter import Filter, FilterState
from gyrodrift.session.session import Session

MINUTE_S, HOUR_S = 60.0, 3600.0
START_S = 3.0
"""Length of a start calibration, s, as in `compare`."""

SAMPLES_MAX = 200_000
"""A filter runs over the last samples of a long recording only."""


@dataclass(frozen=True, slots=True)
class YawDrift:
    """Drift of yaw after a minute and after an hour, degrees."""

    minute_deg: float
    hour_deg: float

    def __str__(self) -> str:
        return f"{self.minute_deg:.2g} deg in a minute, {_round(self.hour_deg)} deg in an hour"


def of_bias(bias_dps: float) -> YawDrift:
    """Drift by a constant bias."""
    return YawDrift(abs(bias_dps) * MINUTE_S, abs(bias_dps) * HOUR_S)


def of_uncertainty(bias_sigma_dps: float, noise_dps_rthz: float, walk_dps_rts: float = 0.0) -> YawDrift:
    """Standard deviation of yaw for a bias of known standard deviation."""

    def sigma_deg(t_s: float) -> float:
        walked_deg = walk_dps_rts * sqrt(t_s**3 / 3.0)
        return hypot(bias_sigma_dps * t_s, noise_dps_rthz * sqrt(t_s), walked_deg)

    return YawDrift(sigma_deg(MINUTE_S), sigma_deg(HOUR_S))


def of_start_calibration(at_rest: StillRate) -> YawDrift:
    """Standard deviation of yaw after subtracting the mean of the first seconds, with a known bias instability."""
    sigma_dps = hypot(at_rest.noise_dps_rthz / sqrt(START_S), at_rest.instability_dps or 0.0)
    return of_uncertainty(sigma_dps, at_rest.noise_dps_rthz)


def after(session: Session, chosen: Filter, params: Any) -> FilterState:
    """State of a filter after the samples of a session."""
    kept = accepted(session.t_device_s, session.rate_dps)
    t_s, rate_dps = session.t_device_s[kept][-SAMPLES_MAX:], session.rate_dps[kept][-SAMPLES_MAX:]
    state: FilterState = chosen.state()
    coefficients, step = chosen.coefficients(params), chosen.step
    for time_s, dps in zip(t_s.tolist(), rate_dps.tolist(), strict=True):
        step(coefficients, state, time_s, dps)
    return state


def _round(degrees: float) -> str:
    return f"{degrees:.0f}" if degrees >= 100.0 else f"{degrees:.2g}"
