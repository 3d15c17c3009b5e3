"""What drift to expect: of plain integration, of a start calibration, and of each filter."""

from functools import partial
from math import isfinite

from gyrodrift.doctor.check import Check
from gyrodrift.doctor.drift import START_S, after, of_bias, of_start_calibration, of_uncertainty
from gyrodrift.doctor.evidence import DeviceEvidence
from gyrodrift.doctor.finding import DeviceFinding, note, ok
from gyrodrift.doctor.still import still_rate
from gyrodrift.filters.filter import Filter
from gyrodrift.filters.registry import FILTERS

UNIT = "deg/h"
LONG_S = 600
"""A rest that shows where the Allan deviation of a cheap gyro has its floor."""

UNSURE_DPS = 0.1
"""A filter that is no surer of the bias has found no rest."""


def plain(evidence: DeviceEvidence) -> DeviceFinding | None:
    """Plain integration: the bias is left in."""
    at_rest = still_rate(evidence)
    if at_rest is None:
        return None
    drift = of_bias(at_rest.bias_dps)
    return ok(f"Plain integration drifts {drift}.", drift.hour_deg, UNIT)


def start_calibration(evidence: DeviceEvidence) -> DeviceFinding | None:
    """The mean of the first seconds is taken off."""
    at_rest = still_rate(evidence)
    if at_rest is None:
        return None
    drift = of_start_calibration(at_rest)
    says = f"A start calibration of {START_S:g} s leaves ±{drift} (one standard deviation)"
    if at_rest.floor_dps is not None:
        return ok(f"{says}, bias instability of {at_rest.floor_dps:.2g} deg/s included.", drift.hour_deg, UNIT)
    known = evidence.sensor.in_run_dps if evidence.sensor else None
    sheet = f" The data sheet has {known:.2g} deg/s of it, {known * 3600:.2g} deg/h." if known else ""
    return ok(
        f"{says} by noise alone. How far the bias wanders cannot be known from {at_rest.seconds:.0f} s of rest.{sheet}",
        drift.hour_deg,
        UNIT,
        do=f"--seconds {LONG_S} at rest shows it." if at_rest.seconds < LONG_S else "",
    )


def of_filter(chosen: Filter, evidence: DeviceEvidence) -> DeviceFinding | None:
    """A filter at its defaults, run over what was heard."""
    at_rest = still_rate(evidence)
    if at_rest is None or evidence.session is None:
        return None
    params = chosen.params()
    state = after(evidence.session, chosen, params)
    if isfinite(state.bias_sigma_dps):
        return _of_certain(
            chosen.name, state.bias_sigma_dps, at_rest.noise_dps_rthz, getattr(params, "walk_dps_rts", 0.0)
        )
    left_dps = at_rest.bias_dps - state.bias_dps
    drift = of_bias(left_dps)
    return ok(
        f"{chosen.name} has taken {state.bias_dps:+.4f} of {at_rest.bias_dps:+.4f} deg/s out; at that it drifts "
        f"{drift}. What turns will teach it cannot be known from a rest.",
        drift.hour_deg,
        UNIT,
    )


def _of_certain(name: str, sigma_dps: float, noise_dps_rthz: float, walk_dps_rts: float) -> DeviceFinding:
    """Of a filter that states how certain it is."""
    if sigma_dps > UNSURE_DPS:
        return note(
            f"{name} has found no rest yet: its bias is open by ±{sigma_dps:.2g} deg/s.",
            "Leave the device still for five seconds when it is switched on.",
            sigma_dps * 3600.0,
            UNIT,
        )
    drift = of_uncertainty(sigma_dps, noise_dps_rthz, walk_dps_rts)
    walk = f", a bias walk of {walk_dps_rts:g} deg/s/√s assumed" if walk_dps_rts else ""
    return ok(
        f"{name} stands still at rest. On the move without any rest it leaves ±{drift} (one standard deviation by its "
        f"own bias of ±{sigma_dps:.2g} deg/s{walk}); each rest begins that anew.",
        drift.hour_deg,
        UNIT,
    )


CHECKS = (
    Check("drift_plain", "plain integration in a minute and an hour", plain),
    Check("drift_start_calibration", "the same where the mean of the first 3 s is taken off", start_calibration),
    *(
        Check(f"drift_{name}", f"the same with {name} at its defaults", partial(of_filter, one))
        for name, one in FILTERS.items()
    ),
)
