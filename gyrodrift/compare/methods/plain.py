"""Methods that are written here: plain integration, start calibration, sign integrator, and zero-rate Kalman filter.

While the corrected rate is small, the sign integrator moves the bias by a fixed step in the direction of its sign.
"""

import numpy as np

from gyrodrift.compare.methods.method import Params
from gyrodrift.evaluation.integration import start_calibrated, trapezium
from gyrodrift.io.compile import compiled_once
from gyrodrift.values.arrays import Floats

REST_TAU_S = 0.5
"""Time constant of the low-pass for the detection of rest, s: chosen."""

START_DPS = 1.0
"""Standard deviation of the bias at power-on, deg/s: chosen."""


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
    corrected_dps: Floats = _by_sign(rate_dps, params["step_dps"], params["theta_dps"])
    return trapezium(steps_s(t_s), corrected_dps)


@compiled_once()
def _by_sign(rate_dps: Floats, step_dps: float, theta_dps: float) -> Floats:
    """Rate minus bias, deg/s, shape (n,)."""
    corrected_dps = rate_dps.copy()
    bias_dps = 0.0
    for n in range(1, len(rate_dps)):
        residual_dps = rate_dps[n] - bias_dps
        if abs(residual_dps) < theta_dps:
            bias_dps += step_dps * np.sign(residual_dps)
        corrected_dps[n] = rate_dps[n] - bias_dps
    return corrected_dps


def run_kalman(t_s: Floats, rate_dps: Floats, params: Params) -> Floats:
    """Yaw, deg, shape (n,), with a bias b that is updated at rest.

    Every step: P += q·T. At rest: K = P/(P + R), b += K·(w − b), P −= K·P. R is `noise_dps`², q is `walk_dps_rts`².
    The device is at rest if, for `rest_s`, the rate is within `rest_dps` of its low-pass, and the low-pass is below
    `bias_most_dps`.
    """
    names = ("rest_dps", "rest_s", "bias_most_dps", "noise_dps", "walk_dps_rts")
    dt_s = steps_s(t_s)
    corrected_dps: Floats = _by_kalman(dt_s, rate_dps, *(params[name] for name in names))
    return trapezium(dt_s, corrected_dps)


@compiled_once()
def _by_kalman(
    dt_s: Floats,
    rate_dps: Floats,
    rest_dps: float,
    rest_s: float,
    bias_most_dps: float,
    noise_dps: float,
    walk_dps_rts: float,
) -> Floats:
    corrected_dps = rate_dps.copy()
    bias_dps, variance, slow_dps, still_s = 0.0, START_DPS**2, rate_dps[0], 0.0
    for n in range(1, len(dt_s)):
        slow_dps += (rate_dps[n] - slow_dps) * dt_s[n] / (dt_s[n] + REST_TAU_S)
        is_quiet = abs(rate_dps[n] - slow_dps) < rest_dps and abs(slow_dps) < bias_most_dps
        still_s = still_s + dt_s[n] if is_quiet else 0.0
        variance += walk_dps_rts**2 * dt_s[n]
        if still_s >= rest_s:
            gain = variance / (variance + noise_dps**2)
            bias_dps += gain * (rate_dps[n] - bias_dps)
            variance -= gain * variance
        corrected_dps[n] = rate_dps[n] - bias_dps
    return corrected_dps
