"""Sign integrator: while the corrected rate is small, its sign moves the bias by a fixed step."""

import numpy as np

from gyrodrift.compare.methods.method import Params
from gyrodrift.compare.methods.plain import steps_s
from gyrodrift.evaluation.integration import trapezium
from gyrodrift.io.compile import compiled_once
from gyrodrift.values.arrays import Floats


def run_sign(t_s: Floats, rate_dps: Floats, params: Params) -> Floats:
    """Yaw, deg, shape (n,): b += step_dps·SIGN(w − b) while |w − b| < theta_dps, once a sample."""
    corrected_dps: Floats = _corrected(rate_dps, params["step_dps"], params["theta_dps"])
    return trapezium(steps_s(t_s), corrected_dps)


@compiled_once()
def _corrected(rate_dps: Floats, step_dps: float, theta_dps: float) -> Floats:
    """Rate minus bias, deg/s, shape (n,)."""
    corrected_dps = rate_dps.copy()
    bias_dps = 0.0
    for n in range(1, len(rate_dps)):
        residual_dps = rate_dps[n] - bias_dps
        if abs(residual_dps) < theta_dps:
            bias_dps += step_dps * np.sign(residual_dps)
        corrected_dps[n] = rate_dps[n] - bias_dps
    return corrected_dps
