"""The one integration of a rate to yaw: `trapezium`. Every compared method uses it, except HDR.

HDR defines its yaw by equation 8, rate times step. That is off by w·T/2 at a rate w and a step T.
"""

import numpy as np

from gyrodrift.values.arrays import Floats

CALIBRATION_S = 3.0
"""Length of a start calibration, s: chosen, the usual rest at power-on."""


def trapezium(dt_s: Floats, rate_dps: Floats) -> Floats:
    """Integral of the rate by the trapezoidal rule, deg, shape (n,), 0 at the first sample.

    The rule avoids the error w·T/2 of rate times step at a rate w and a step T: 0.5 deg at 100 deg/s and 100 Hz.
    """
    step_deg = np.zeros(len(rate_dps))
    with np.errstate(over="ignore", invalid="ignore"):
        step_deg[1:] = 0.5 * (rate_dps[1:] + rate_dps[:-1]) * dt_s[1:]
        return np.cumsum(step_deg)


def start_calibrated(t_s: Floats, rate_dps: Floats, calibration_s: float = CALIBRATION_S) -> Floats:
    """Integral of the rate minus its mean over the first seconds, deg, shape (n,).

    The mean is subtracted from all samples, as in a device that calibrates before it reports yaw.
    """
    is_first = t_s - t_s[0] < calibration_s
    return trapezium(np.diff(t_s, prepend=t_s[0]), rate_dps - float(np.mean(rate_dps[is_first])))
