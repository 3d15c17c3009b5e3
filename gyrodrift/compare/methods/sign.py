"""The sign integrator: the bias follows the sign of what is left of the rate, where that is small."""

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.compare.methods.method import Params
from gyrodrift.compare.methods.plain import steps_s
from gyrodrift.compile import compiled_once


def run_sign(t_s: Floats, rate_dps: Floats, params: Params) -> Floats:
    """Yaw, deg, shape (n,): b += step_dps·SIGN(w − b) while |w − b| < theta_dps, once a sample."""
    found: Floats = _walk(steps_s(t_s), rate_dps, params["step_dps"], params["theta_dps"])
    return found


@compiled_once()
def _walk(dt_s: Floats, rate_dps: Floats, step_dps: float, theta_dps: float) -> Floats:
    yaw_deg = np.zeros(len(dt_s))
    bias_dps = 0.0
    for n in range(1, len(dt_s)):
        left_dps = rate_dps[n] - bias_dps
        if abs(left_dps) < theta_dps:
            bias_dps += step_dps * np.sign(left_dps)
        yaw_deg[n] = yaw_deg[n - 1] + (rate_dps[n] - bias_dps) * dt_s[n]
    return yaw_deg
