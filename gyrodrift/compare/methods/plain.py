"""The simplest of all: adding up, and taking off what the first seconds say."""

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.compare.methods.method import Params
from gyrodrift.evaluation.integration import start_calibrated, trapezium


def steps_s(t_s: Floats) -> Floats:
    """Distance of each sample from the one before, s, shape (n,); 0 for the first; the bits of `Reference.dt_s`."""
    return np.diff(t_s, prepend=t_s[0])


def mean_step_s(t_s: Floats) -> float:
    """Mean distance of the samples, s: for packages that take all to be equally far apart."""
    return float(t_s[-1] - t_s[0]) / (len(t_s) - 1)


def run_euler(t_s: Floats, rate_dps: Floats, _params: Params) -> Floats:
    """Yaw of the rate as it is, deg, shape (n,)."""
    return trapezium(steps_s(t_s), rate_dps)


def run_start_calibration(t_s: Floats, rate_dps: Floats, params: Params) -> Floats:
    """Yaw of the rate less its mean over the first `calibration_s`, deg, shape (n,).

    The mean is taken off from the first sample on, as a device does that keeps its first seconds until it knows.
    """
    return start_calibrated(t_s, rate_dps, params["calibration_s"])
