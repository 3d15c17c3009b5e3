"""Plain integration, start calibration, and the sign integrator.

While the corrected rate is small, the sign integrator moves the bias by a fixed step in the direction of its sign.
"""

import numpy as np

from gyrodrift.compare.methods.method import Params
from gyrodrift.evaluation.integration import start_calibrated, trapezium
from gyrodrift.io.compile import compiled_once
from gyrodrift.values.arrays import Floats


def steps_s(t_s: Floats) -> Floats:
    """Step before each sample, s, shape (n,), 0 for the first; bit for bit as in `Reference.dt_s`."""
    return np.diff(t_s, prepend=t_s[0])


def mean_step_s(t_s: Floats) -> float:
    """Mean step, s, for packages that assume equal steps."""
    return float(t_s[-1] - t_s[0]) / (len(t_s) - 1)


def run_euler(t_s: Floats, rate_dps: Floats, _params: Params) -> Floats:
    """Integral of the rate, deg, shape (n,)."""
    return trapezium(steps_s(t_s), rate_dps)


def run_start_calibration(t_s: Floats, rate_dps: Floats, params: Params) -> Floats:
    """Integral of the rate minus its mean over the first `calibration_s`, deg, shape (n,)."""
    return start_calibrated(t_s, rate_dps, params["calibration_s"])


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
