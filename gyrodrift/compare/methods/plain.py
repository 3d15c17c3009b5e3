"""Plain integration and start calibration."""

import numpy as np

from gyrodrift.compare.methods.method import Params
from gyrodrift.evaluation.integration import start_calibrated, trapezium
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
