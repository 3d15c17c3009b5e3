"""Checks of the drift to expect without any rest: of plain integration, of a start calibration, and of each filter.

The variance of yaw after t seconds is P·t² + N²·t + K²·t³/3. P is the variance of the remaining bias, N white noise
(deg/√s), and K a rate random walk (deg/s/√s).
"""

from dataclasses import dataclass
from functools import partial
from math import hypot, isfinite, sqrt
from typing import Any

from gyrodrift.doctor.evidence import Check, DeviceEvidence, checks_of, rest_of
from gyrodrift.doctor.finding import DeviceFinding, note, ok
from gyrodrift.evaluation.reference import accepted
from gyrodrift.facts.session_facts import StillRate
from gyrodrift.filters.filter import Filter, FilterState
from gyrodrift.filters.registry import FILTERS
from gyrodrift.session.session import Session
from gyrodrift.values.constants import SECONDS_PER_HOUR, SECONDS_PER_MINUTE
from gyrodrift.values.noise import hourly_rate_text

UNIT = "deg/h"

UNSURE_DPS = 0.1
"""Uncertainty of the bias above which a filter has not found a rest."""

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
    return YawDrift(abs(bias_dps) * SECONDS_PER_MINUTE, abs(bias_dps) * SECONDS_PER_HOUR)


def of_uncertainty(bias_sigma_dps: float, noise_dps_rthz: float, walk_dps_rts: float = 0.0) -> YawDrift:
    """Standard deviation of yaw for a bias of known standard deviation."""

    def sigma_deg(t_s: float) -> float:
        walked_deg = walk_dps_rts * sqrt(t_s**3 / 3.0)
        return hypot(bias_sigma_dps * t_s, noise_dps_rthz * sqrt(t_s), walked_deg)

    return YawDrift(sigma_deg(SECONDS_PER_MINUTE), sigma_deg(SECONDS_PER_HOUR))


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


def drift_plain(_evidence: DeviceEvidence, at_rest: StillRate) -> DeviceFinding | None:
    """Plain integration, in a minute and in an hour."""
    drift = of_bias(at_rest.bias_dps)
    return ok(f"Plain integration drifts {drift}.", drift.hour_deg, UNIT)


def drift_start_calibration(_evidence: DeviceEvidence, at_rest: StillRate) -> DeviceFinding | None:
    """Drift after subtracting the mean of the first 3 s."""
    drift = of_start_calibration(at_rest)
    says = f"A start calibration of {START_S:g} s drifts ±{drift} (one standard deviation)"
    if at_rest.instability_dps is None:
        return ok(f"{says} by white noise alone. Later changes of the bias come on top.", drift.hour_deg, UNIT)
    return ok(
        f"{says}, by white noise and a bias instability of {hourly_rate_text(at_rest.instability_dps)}.",
        drift.hour_deg,
        UNIT,
    )


def of_filter(chosen: Filter, evidence: DeviceEvidence) -> DeviceFinding | None:
    """Drift of a filter at its defaults, after the samples of the evidence."""
    at_rest = evidence.at_rest
    if at_rest is None or evidence.facts is None:
        return None
    params = chosen.params()
    state = after(evidence.facts.session, chosen, params)
    if isfinite(state.bias_sigma_dps):
        return _of_sigma(
            chosen.name, state.bias_sigma_dps, at_rest.noise_dps_rthz, getattr(params, "walk_dps_rts", 0.0)
        )
    drift = of_bias(at_rest.bias_dps - state.bias_dps)
    return ok(
        f"{chosen.name} has learned {state.bias_dps:+.4f} of {at_rest.bias_dps:+.4f} deg/s; with that it drifts "
        f"{drift}. It learns the remaining bias from turns.",
        drift.hour_deg,
        UNIT,
    )


def _of_sigma(name: str, sigma_dps: float, noise_dps_rthz: float, walk_dps_rts: float) -> DeviceFinding:
    """Finding about a filter that states the standard deviation of its bias."""
    if sigma_dps > UNSURE_DPS:
        return note(
            f"{name} has not found a rest yet: its bias is uncertain by ±{sigma_dps:.2g} deg/s.",
            "Leave the device still for five seconds after power-on, with its motors off.",
            sigma_dps * SECONDS_PER_HOUR,
            UNIT,
        )
    drift = of_uncertainty(sigma_dps, noise_dps_rthz, walk_dps_rts)
    walk = f" and an assumed bias walk of {walk_dps_rts:g} deg/s/√s" if walk_dps_rts else ""
    return ok(
        f"{name} does not drift at rest. In motion without any rest it drifts ±{drift} (one standard deviation, from "
        f"a bias known to ±{sigma_dps:.2g} deg/s{walk}). Each rest corrects the bias again.",
        drift.hour_deg,
        UNIT,
    )


CHECKS = (
    *checks_of(rest_of, drift_plain, drift_start_calibration),
    *(
        Check(f"drift_{name}", f"drift with {name} at its defaults", partial(of_filter, chosen))
        for name, chosen in FILTERS.items()
    ),
)
