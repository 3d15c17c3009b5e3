"""VQF's rest detection and bias estimation, by its own package `vqf`, as it streams and as it looks back.

Source: D. Laidig and T. Seel, "VQF: Highly accurate IMU orientation estimation with bias estimation and magnetic
disturbance rejection", Information Fusion 91, 2023, DOI 10.1016/j.inffus.2022.10.014.
"""

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.compare.methods.method import Params
from gyrodrift.compare.methods.plain import mean_step_s, steps_s
from gyrodrift.evaluation.integration import trapezium

GRAVITY_MSS = 9.81
"""Of a device that lies level. Without an accelerometer VQF detects no rest."""


def run_vqf(t_s: Floats, rate_dps: Floats, params: Params) -> Floats:
    """Yaw of the rates less the newest bias that the filter has learnt from (0, 0, rate), deg, shape (n,).

    The rates are added up here and not in the package, which takes all samples to be equally far apart: samples that
    were lost are no fault of its estimate.
    """
    from vqf import VQF  # noqa: PLC0415 - not everybody has it

    learnt = VQF(mean_step_s(t_s), **params).updateBatch(*_as_imu(rate_dps))
    return _without(t_s, rate_dps, learnt["bias"])


def run_vqf_offline(t_s: Floats, rate_dps: Floats, params: Params) -> Floats:
    """The same with a bias that was learnt forwards and backwards."""
    from vqf import offlineVQF  # noqa: PLC0415

    learnt = offlineVQF(*_as_imu(rate_dps), None, mean_step_s(t_s), dict(params))
    return _without(t_s, rate_dps, learnt["bias"])


def _as_imu(rate_dps: Floats) -> tuple[Floats, Floats]:
    """Gyroscope in rad/s and accelerometer in m/s², shape (n, 3), of a device that turns about the vertical alone."""
    gyroscope, accelerometer = np.zeros((2, len(rate_dps), 3))
    gyroscope[:, 2] = np.deg2rad(rate_dps)
    accelerometer[:, 2] = GRAVITY_MSS
    return gyroscope, accelerometer


def _without(t_s: Floats, rate_dps: Floats, bias_rps: Floats) -> Floats:
    return trapezium(steps_s(t_s), rate_dps - np.rad2deg(bias_rps[:, 2]))
