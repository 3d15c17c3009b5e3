"""Attitude filters of other packages on three rates and accelerations: heading of their quaternions.

VQF: D. Laidig and T. Seel, Information Fusion 91, 2023. Madgwick: S. Madgwick, "An efficient orientation filter for
inertial and inertial/magnetic sensor arrays", 2010. Mahony: R. Mahony, T. Hamel and J.-M. Pflimlin, "Nonlinear
complementary filters on the special orthogonal group", IEEE Trans. Automatic Control 53(5), 2008.
"""

from collections.abc import Callable

import numpy as np

from gyrodrift.compare.methods.method import Params
from gyrodrift.compare.methods.plain import mean_step_s, steps_s
from gyrodrift.evaluation.auxiliary import InertialColumns
from gyrodrift.values.arrays import Floats
from gyrodrift.values.constants import STANDARD_GRAVITY_MPS2

REJECTION_DEG, REJECTION_TIMEOUT_S = 10.0, 5.0
"""Settings of the package's examples: accelerations that disagree by more than 10 deg are ignored for at most 5 s."""

UNEVEN = 1.5
"""Ratio of the longest step to the median above which a session is interpolated for a package that wants even steps."""

INVERTED_DEG = 150.0
"""Tilt above which the twist turns fast for small rotations; there the heading follows the rate about the vertical.

At 180 deg the twist is undefined. Measured: on recordings that turn over, the twist alone jumps in 8 of 71.
"""


def vqf_heading(t_s: Floats, axes: InertialColumns, params: Params) -> Floats:
    """Heading of VQF, deg, shape (n,), 0 at the first sample."""
    from vqf import VQF

    even_s, gyro_rps, accel_mps2 = _even(t_s, axes)
    estimate = VQF(mean_step_s(even_s), **params).updateBatch(gyro_rps, accel_mps2)
    return _interpolated(t_s, even_s, heading_deg(estimate["quat6D"]))


def vqf_offline_heading(t_s: Floats, axes: InertialColumns, params: Params) -> Floats:
    """Heading of OfflineVQF, deg, shape (n,), 0 at the first sample."""
    from vqf import offlineVQF

    even_s, gyro_rps, accel_mps2 = _even(t_s, axes)
    estimate = offlineVQF(gyro_rps, accel_mps2, None, mean_step_s(even_s), dict(params))
    return _interpolated(t_s, even_s, heading_deg(estimate["quat6D"]))


def fusion_heading(t_s: Floats, axes: InertialColumns, params: Params) -> Floats:
    """Heading of x-io Fusion with its bias estimation, deg, shape (n,), 0 at the first sample."""
    import imufusion

    step_s = mean_step_s(t_s)
    bias = imufusion.Bias().set_settings(
        imufusion.BiasSettings(1.0 / step_s, params["stationary_threshold"], params["stationary_period"])
    )
    ahrs = imufusion.Ahrs()
    settings = imufusion.AhrsSettings()
    settings.sample_rate, settings.convention = 1.0 / step_s, imufusion.CONVENTION_NWU
    settings.acceleration_rejection, settings.rejection_timeout = REJECTION_DEG, REJECTION_TIMEOUT_S
    ahrs.set_settings(settings)
    quaternions = np.empty((len(t_s), 4))
    columns = (steps_s(t_s), axes.gyro_dps, _without_gaps(axes.accel_mps2) / STANDARD_GRAVITY_MPS2)
    for row, (dt_s, gyro_dps, accel_g) in enumerate(zip(*columns, strict=True)):
        ahrs.set_sample_period(dt_s or step_s)
        ahrs.update_no_magnetometer(bias.update(gyro_dps), accel_g)
        quaternions[row] = ahrs.get_quaternion()
    return heading_deg(quaternions)


def madgwick_heading(t_s: Floats, axes: InertialColumns, params: Params) -> Floats:
    """Heading of Madgwick's filter, deg, shape (n,), 0 at the first sample."""
    from ahrs.filters import Madgwick

    return _stepped(t_s, axes, Madgwick(gain=params["gain"]).updateIMU)


def mahony_heading(t_s: Floats, axes: InertialColumns, params: Params) -> Floats:
    """Heading of Mahony's filter, deg, shape (n,), 0 at the first sample."""
    from ahrs.filters import Mahony

    return _stepped(t_s, axes, Mahony(k_P=params["k_p"], k_I=params["k_i"]).updateIMU)


def _stepped(t_s: Floats, axes: InertialColumns, update: Callable[..., Floats]) -> Floats:
    """Heading of a filter of the package `ahrs` that is called sample by sample with the step that passed."""
    from ahrs.common.orientation import acc2q

    accel_mps2 = _without_gaps(axes.accel_mps2)
    quaternions = np.empty((len(t_s), 4))
    q = quaternions[0] = acc2q(accel_mps2[0])
    columns = (steps_s(t_s), np.deg2rad(axes.gyro_dps), accel_mps2)
    for row, (dt_s, gyro_rps, accel) in enumerate(zip(*columns, strict=True)):
        if row:
            q = quaternions[row] = update(q, gyro_rps, accel, dt=float(dt_s))
    return heading_deg(quaternions)


def _even(t_s: Floats, axes: InertialColumns) -> tuple[Floats, Floats, Floats]:
    """Times in s, rates in rad/s and accelerations in m/s², interpolated to even steps if samples are missing."""
    gyro_rps, accel_mps2 = np.deg2rad(axes.gyro_dps), _without_gaps(axes.accel_mps2)
    step_s = np.diff(t_s)
    median_s = float(np.median(step_s))
    if step_s.max() <= UNEVEN * median_s:
        return t_s, gyro_rps, accel_mps2
    even_s = np.arange(t_s[0], t_s[-1] + 0.5 * median_s, median_s)
    gyro_rps, accel_mps2 = (
        np.column_stack([np.interp(even_s, t_s, column) for column in array.T]) for array in (gyro_rps, accel_mps2)
    )
    return even_s, gyro_rps, accel_mps2


def _interpolated(t_s: Floats, even_s: Floats, yaw_deg: Floats) -> Floats:
    return yaw_deg if t_s is even_s else np.interp(t_s, even_s, yaw_deg)


def _without_gaps(accel_mps2: Floats) -> Floats:
    """Accelerations with the last known value where they are missing; gravity on z before the first."""
    rows = np.arange(len(accel_mps2))
    last = np.maximum.accumulate(np.where(np.isfinite(accel_mps2).all(axis=1), rows, -1))
    filled = np.where(last[:, None] < 0, [0.0, 0.0, STANDARD_GRAVITY_MPS2], accel_mps2[np.maximum(last, 0)])
    return np.ascontiguousarray(filled)


def heading_deg(quaternions: Floats) -> Floats:
    """Unwrapped heading of attitudes (w, x, y, z) from sensor to earth, z up, deg, shape (n,), 0 at the first.

    Above `INVERTED_DEG` of tilt the heading continues by the rotation about the vertical between samples.
    """
    w, x, y, z = quaternions.T
    twist_deg = np.rad2deg(2.0 * np.arctan2(z, w))
    step_deg = np.diff(twist_deg, prepend=twist_deg[0])
    step_deg = (step_deg + 180.0) % 360.0 - 180.0
    tilt_deg = np.rad2deg(2.0 * np.arctan2(np.hypot(x, y), np.hypot(w, z)))
    inverted = (tilt_deg > INVERTED_DEG) & (np.roll(tilt_deg, 1) > INVERTED_DEG)
    inverted[0] = False
    step_deg[inverted] = vertical_turn_deg(quaternions)[inverted]
    heading: Floats = np.cumsum(step_deg)
    return heading


def vertical_turn_deg(quaternions: Floats) -> Floats:
    """Rotation about the vertical from the attitude before to each, in the earth frame, deg, shape (n,), 0 first."""
    before = np.roll(quaternions, 1, axis=0)
    w, x, y, z = quaternions.T
    bw, bx, by, bz = before.T
    turn_w = w * bw + x * bx + y * by + z * bz
    turn_z = -w * bz - x * by + y * bx + z * bw
    sign = np.where(turn_w < 0.0, -1.0, 1.0)
    turn_deg: Floats = np.rad2deg(2.0 * np.arctan2(sign * turn_z, np.abs(turn_w)))
    turn_deg[0] = 0.0
    return turn_deg
