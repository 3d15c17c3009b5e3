"""Longest rest of a recording: its samples, bias with uncertainty, and noise."""

from dataclasses import dataclass
from math import sqrt

import numpy as np

from gyrodrift.describe.arrays import smallest_step
from gyrodrift.doctor.evidence import DeviceEvidence
from gyrodrift.values.arrays import Floats

RAIL_MIN_DPS = 20.0
"""Smallest rate that may be the end of a range, deg/s."""


@dataclass(frozen=True, slots=True)
class StillRate:
    """Rate at rest.

    bias_dps, bias_sigma_dps
        Mean rate, and its standard deviation by white noise.
    noise_dps_rthz
        Angle random walk N, deg/s/√Hz (= deg/√s), from the Allan deviation; from the scatter below 30 s of rest.
    std_dps
        Standard deviation of single samples.
    instability_dps
        Bias instability B (IEEE Std 952); None if the rest is too short.
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
    """Measure the longest rest; None without one, or if the rates have another unit."""
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
    """Step of the rate, deg/s: the stated one, or the measured one if it is coarser; None without both."""
    if evidence.session is None:
        return None
    measured_dps, stated_dps = smallest_step(evidence.session.rate_dps), evidence.device.dps_per_lsb
    return max(stated_dps, measured_dps or 0.0) if stated_dps else measured_dps
