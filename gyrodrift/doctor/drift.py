"""How far yaw will be off after a while without any rest, from what is known of bias and noise.

With the variance P of the bias that is left, white noise N (deg/√s) and a rate random walk K (deg/s/√s), the variance
of yaw after t seconds is P·t² + N²·t + K²·t³/3.
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
"""How long a start calibration takes: as in `compare`."""

MOST_SAMPLES = 200_000
"""Of a long recording a filter is run over the last of its samples."""


@dataclass(frozen=True, slots=True)
class YawDrift:
    """Degrees after a minute and after an hour."""

    minute_deg: float
    hour_deg: float

    def __str__(self) -> str:
        return f"{self.minute_deg:.2g} deg in a minute, {_round(self.hour_deg)} deg in an hour"


def of_bias(bias_dps: float) -> YawDrift:
    """A bias that is left as it is."""
    return YawDrift(abs(bias_dps) * MINUTE_S, abs(bias_dps) * HOUR_S)


def of_uncertainty(bias_sigma_dps: float, noise_dps_rthz: float, walk_dps_rts: float = 0.0) -> YawDrift:
    """One standard deviation of yaw where the bias is known to within its own."""

    def sigma_deg(t_s: float) -> float:
        walked_deg = walk_dps_rts * sqrt(t_s**3 / 3.0)
        return hypot(bias_sigma_dps * t_s, noise_dps_rthz * sqrt(t_s), walked_deg)

    return YawDrift(sigma_deg(MINUTE_S), sigma_deg(HOUR_S))


def of_start_calibration(at_rest: StillRate) -> YawDrift:
    """The mean of the first seconds is taken off; bias instability comes on top where the rest has shown it."""
    sigma_dps = hypot(at_rest.noise_dps_rthz / sqrt(START_S), at_rest.instability_dps or 0.0)
    return of_uncertainty(sigma_dps, at_rest.noise_dps_rthz)


def after(session: Session, chosen: Filter, params: Any) -> FilterState:
    """The state of a filter that has seen the samples."""
    kept = accepted(session.t_device_s, session.rate_dps)
    t_s, rate_dps = session.t_device_s[kept][-MOST_SAMPLES:], session.rate_dps[kept][-MOST_SAMPLES:]
    state: FilterState = chosen.state()
    coefficients, step = chosen.coefficients(params), chosen.step
    for time_s, dps in zip(t_s.tolist(), rate_dps.tolist(), strict=True):
        step(coefficients, state, time_s, dps)
    return state


def _round(degrees: float) -> str:
    return f"{degrees:.0f}" if degrees >= 100.0 else f"{degrees:.2g}"
