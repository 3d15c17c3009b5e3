"""The longest rest of a recording as numbers: bias with its uncertainty, white noise, the samples themselves."""

from dataclasses import dataclass
from math import sqrt

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.describe.arrays import smallest_step
from gyrodrift.doctor.evidence import DeviceEvidence

RAIL_MIN_DPS = 20.0
"""A largest rate below that is no end of a range."""


@dataclass(frozen=True, slots=True)
class StillRate:
    """The rate while nothing moved.

    bias_dps, bias_sigma_dps
        Mean rate, and what white noise alone leaves open of it.
    noise_dps_rthz
        Angle random walk N, deg/s/√Hz (that is deg/√s): by the Allan deviation, in less than 30 s by the scatter.
    std_dps
        Scatter of single samples.
    instability_dps
        Bias instability B, where the rest is long enough to show it.
    """

    t_s: Floats
    rate_dps: Floats
    seconds: float
    bias_dps: float
    bias_sigma_dps: float
    noise_dps_rthz: float
    std_dps: float
    instability_dps: float | None


def still_rate(evidence: DeviceEvidence) -> StillRate | None:
    """Of the longest rest; None without one, and where the rates have another unit."""
    rest, session, about = evidence.rest, evidence.session, evidence.description
    if rest is None or session is None or about is None or about.rate_hz is None or not evidence.is_in_deg_s:
        return None
    t_s = session.t_device_s - session.t_device_s[np.isfinite(session.t_device_s)][0]
    inside = (t_s >= rest.start_s) & (t_s <= rest.end_s) & np.isfinite(session.rate_dps)
    allan = about.allan
    walk = allan.angle_random_walk_deg_rts if allan is not None else None
    noise_dps_rthz = walk if walk is not None else rest.std_dps / sqrt(about.rate_hz)
    seconds = rest.end_s - rest.start_s
    return StillRate(
        t_s=t_s[inside],
        rate_dps=session.rate_dps[inside],
        seconds=seconds,
        bias_dps=rest.mean_dps,
        bias_sigma_dps=noise_dps_rthz / sqrt(seconds),
        noise_dps_rthz=noise_dps_rthz,
        std_dps=rest.std_dps,
        instability_dps=allan.bias_instability_dps if allan is not None else None,
    )


def step_of(evidence: DeviceEvidence) -> float | None:
    """The step of the rate, deg/s: what the device states, or what is seen where that is coarser; None without one."""
    if evidence.session is None:
        return None
    seen, told = smallest_step(evidence.session.rate_dps), evidence.device.dps_per_lsb
    return max(told, seen or 0.0) if told else seen
