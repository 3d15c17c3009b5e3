"""Checks of the drift to expect: of plain integration, of a start calibration, and of each filter."""

from functools import partial
from math import isfinite

from gyrodrift.doctor.check import Check
from gyrodrift.doctor.drift import START_S, after, of_bias, of_start_calibration, of_uncertainty
from gyrodrift.doctor.evidence import DeviceEvidence
from gyrodrift.doctor.finding import DeviceFinding, note, ok
from gyrodrift.doctor.still import still_rate
from gyrodrift.filters.filter import Filter
from gyrodrift.filters.registry import FILTERS
from gyrodrift.values.noise import hourly_rate_text

UNIT = "deg/h"

UNSURE_DPS = 0.1
"""Uncertainty of the bias above which a filter has not found a rest."""


def plain(evidence: DeviceEvidence) -> DeviceFinding | None:
    """Drift of plain integration, which keeps the bias."""
    at_rest = still_rate(evidence)
    if at_rest is None:
        return None
    drift = of_bias(at_rest.bias_dps)
    return ok(f"Plain integration drifts {drift}.", drift.hour_deg, UNIT)


def start_calibration(evidence: DeviceEvidence) -> DeviceFinding | None:
    """Drift after a start calibration, which subtracts the mean of the first seconds."""
    at_rest = still_rate(evidence)
    if at_rest is None:
        return None
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
    at_rest = still_rate(evidence)
    if at_rest is None or evidence.session is None:
        return None
    params = chosen.params()
    state = after(evidence.session, chosen, params)
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
            sigma_dps * 3600.0,
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
    Check("drift_plain", "plain integration, in a minute and in an hour", plain),
    Check("drift_start_calibration", "the same after subtracting the mean of the first 3 s", start_calibration),
    *(
        Check(f"drift_{name}", f"the same with {name} at its defaults", partial(of_filter, chosen))
        for name, chosen in FILTERS.items()
    ),
)
