"""Rest detection and bias estimation on one axis by other packages: VQF, in real time and offline, and x-io Fusion.

Source: D. Laidig and T. Seel, "VQF: Highly accurate IMU orientation estimation with bias estimation and magnetic
disturbance rejection", Information Fusion 91, 2023, DOI 10.1016/j.inffus.2022.10.014.
"""

import numpy as np

from gyrodrift.compare.methods.method import Params
from gyrodrift.compare.methods.plain import mean_step_s, steps_s
from gyrodrift.evaluation.integration import trapezium
from gyrodrift.values.arrays import Floats

GRAVITY_MSS = 9.81
"""Gravity on a level device, m/s². Without an accelerometer VQF detects no rest."""


def run_vqf(t_s: Floats, rate_dps: Floats, params: Params) -> Floats:
    """Integral of the rate minus the bias that VQF estimates from (0, 0, rate), deg, shape (n,).

    The package assumes equal steps, so it would make an error at lost samples. The integral here uses the real steps.
    """
    from vqf import VQF

    estimate = VQF(mean_step_s(t_s), **params).updateBatch(*_as_imu(rate_dps))
    return _without(t_s, rate_dps, estimate["bias"])


def run_vqf_offline(t_s: Floats, rate_dps: Floats, params: Params) -> Floats:
    """Integral of the rate minus a bias estimated forward and backward in time, deg, shape (n,)."""
    from vqf import offlineVQF

    estimate = offlineVQF(*_as_imu(rate_dps), None, mean_step_s(t_s), dict(params))
    return _without(t_s, rate_dps, estimate["bias"])


def _as_imu(rate_dps: Floats) -> tuple[Floats, Floats]:
    """Gyroscope in rad/s and accelerometer in m/s², shape (n, 3), of a device that turns only about the vertical."""
    gyroscope, accelerometer = np.zeros((2, len(rate_dps), 3))
    gyroscope[:, 2] = np.deg2rad(rate_dps)
    accelerometer[:, 2] = GRAVITY_MSS
    return gyroscope, accelerometer


def _without(t_s: Floats, rate_dps: Floats, bias_rps: Floats) -> Floats:
    return trapezium(steps_s(t_s), rate_dps - np.rad2deg(bias_rps[:, 2]))


def run_fusion(t_s: Floats, rate_dps: Floats, params: Params) -> Floats:
    """Yaw of the rates that `imufusion.Bias` returns for (0, 0, rate), deg, shape (n,)."""
    from imufusion import Bias, BiasSettings

    settings = BiasSettings(1.0 / mean_step_s(t_s), params["stationary_threshold"], params["stationary_period"])
    bias = Bias().set_settings(settings)
    axes = np.zeros((len(rate_dps), 3))
    axes[:, 2] = rate_dps
    # The package returns 32-bit floats. Only the small bias comes from them, so the rate keeps its precision.
    bias_dps = np.array([given[2] - float(bias.update(given)[2]) for given in axes])
    return trapezium(steps_s(t_s), rate_dps - bias_dps)
