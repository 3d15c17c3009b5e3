"""Update of all hypotheses at the end of a block, and the estimate that results."""

from math import degrees, sqrt

import numpy as np

from gyrodrift.filters.attitude.batch import rotation_matrices
from gyrodrift.filters.attitude.block import RAD, InertialBlock, Integrals, next_block
from gyrodrift.filters.attitude.hypotheses import (
    BIAS,
    FORCE_BIAS,
    HEADING,
    REST,
    SCALE,
    STATES,
    VELOCITY,
    Hypotheses,
    first_hypothesis,
)
from gyrodrift.filters.attitude.knowledge import (
    begin_remembered,
    drop_wrong_memory,
    follow_temperature,
    in_motion,
    learn_when_sure,
)
from gyrodrift.filters.attitude.levelling import START_TILT, UNKNOWN_TILT, find_lost_tilt, level_start
from gyrodrift.filters.attitude.mixture import moments, ordered
from gyrodrift.filters.attitude.model import AttitudeCoefficients, AttitudeState
from gyrodrift.filters.attitude.predict import GRAVITY, predict
from gyrodrift.filters.attitude.regimes import REST_BIAS
from gyrodrift.filters.attitude.rests import GYRO_SPREAD, QUIET, add_block
from gyrodrift.filters.attitude.segments import GYRO_NOISE, follow_rest, left_gradually
from gyrodrift.filters.attitude.velocity import START_SPEED, bound_velocity, forget_velocity
from gyrodrift.filters.attitude.yaw import unwrap_headings
from gyrodrift.filters.beliefs import MAJORITY, MAX_RAMP_S
from gyrodrift.values.arrays import Mask
from gyrodrift.values.quaternion import IDENTITY, heading_axis, level, product, with_heading
from gyrodrift.values.vectors import Vector

FORCE_BIAS_SIGMA = 0.3
"""Standard deviation of the bias of an accelerometer, m/s²: data sheets allow 0.4 m/s² (LSM6DS3), 0.5 (ICM-20948) and
0.5 to 0.8 (MPU-6050)."""

G_SENSITIVITY = 0.05 * RAD
"""Standard deviation of the change of a bias by gravity, rad/s per g: half of the 0.1 deg/s that the data sheet of the
MPU-6050 allows."""


def begin(c: AttitudeCoefficients, s: AttitudeState, accel: Vector) -> None:
    """First sample: level by its acceleration; heading and sigma are 0 unless an earlier filter left other ones."""
    h = first_hypothesis()
    has_accel = accel[0] == accel[0]
    s.start_q = with_heading(level(*accel) if has_accel else IDENTITY, s.yaw_deg)
    h.yaw_deg[0] = s.yaw_deg
    h.q[0] = s.start_q
    diagonal = np.zeros(STATES)
    diagonal[:2] = (START_TILT if has_accel else UNKNOWN_TILT) ** 2
    diagonal[HEADING] = (s.yaw_sigma_deg * RAD) ** 2
    diagonal[BIAS] = c.bias_sigma**2
    diagonal[VELOCITY] = START_SPEED**2
    diagonal[FORCE_BIAS] = FORCE_BIAS_SIGMA**2
    diagonal[SCALE] = (c.scale_sigma**2 * np.eye(3) + c.cross_sigma**2 * (1.0 - np.eye(3))).ravel()
    h.cov[0] = np.diag(diagonal)
    s.hypotheses, s.noise_var, s.block = h, max(GYRO_NOISE**2, s.noise_var), InertialBlock()
    begin_remembered(c, s)
    publish(s)


def end_block(c: AttitudeCoefficients, s: AttitudeState, block: Integrals) -> None:
    """Update all hypotheses by a finished block, and begin the next one."""
    h = s.hypotheses
    s.lived_s += block.seconds
    is_held = standing(c, s, block)
    h.yaw_deg = h.yaw_deg + np.where(is_held, 0.0, s.yaw_deg - s.start_yaw_deg)
    is_blind = s.block.is_clipped or not np.isfinite(block.velocity).all()
    usable = with_gravity(h, block) if is_blind else block
    predict(h, usable, c.walk_var, max(s.noise_var, GYRO_NOISE**2), is_held)
    follow_temperature(s, block.seconds)
    widen_by_tilt(s)
    widen_by_motion(s, block.seconds)
    if is_blind:
        forget_velocity(h)
    else:
        find_lost_tilt(s, block)
        level_start(s, block)
        bound_velocity(s, block.seconds, is_still=s.segment.blocks > 0)
    add_block(s.windows, block)
    follow_rest(c, s)
    drop_wrong_memory(c, s)
    s.hypotheses = ordered(s.hypotheses)
    unwrap_headings(s.hypotheses)
    publish(s)
    learn_when_sure(c, s, block.seconds)
    s.block = next_block(s.hypotheses.bias[0], s.hypotheses.scale[0])


def standing(c: AttitudeCoefficients, s: AttitudeState, block: Integrals) -> Mask:
    """Hypotheses (n) of a quiet rest whose bias this block does not leave: the device has not begun to move."""
    h = s.hypotheses
    if s.segment.blocks != QUIET.blocks:
        return np.zeros(len(h.weight), dtype=np.bool_)
    is_near = (np.abs(block.gyro - h.bias) < c.limits * GYRO_SPREAD).all(axis=1)
    is_standing: Mask = (h.regime == REST) & is_near
    return is_standing


def widen_by_motion(s: AttitudeState, seconds: float) -> None:
    """Widen the biases in motion, which differ from those at rest, for the first seconds. A slow turn is no motion."""
    h = s.hypotheses
    if left_gradually(s):
        return
    is_moving = in_motion(s) & (h.moving_s < MAX_RAMP_S)
    h.cov[is_moving, BIAS, BIAS] += REST_BIAS**2 * seconds / MAX_RAMP_S * np.eye(3)


def widen_by_tilt(s: AttitudeState) -> None:
    """Widen the biases as gravity moves in the sensor, farther than it was since the last rest."""
    m, up = s.motion, rotation_matrices(s.hypotheses.q[:1])[0, 2]
    if s.rest_probability > MAJORITY or not m.rest_up.any():
        m.rest_up, m.moved_var = up, 0.0
    moved_var = float(((up - m.rest_up) ** 2).sum())
    if moved_var > m.moved_var:
        s.hypotheses.cov[:, BIAS, BIAS] += G_SENSITIVITY**2 * (moved_var - m.moved_var) * np.eye(3)
        m.moved_var = moved_var


def with_gravity(h: Hypotheses, block: Integrals) -> Integrals:
    """The block with gravity alone as its specific force."""
    up = rotation_matrices(h.q[:1])[0, 2]
    return block._replace(velocity=GRAVITY * block.seconds * up)


def publish(s: AttitudeState) -> None:
    """Write the Gaussian sum as the estimate of the last sample."""
    h = s.hypotheses
    m = moments(h)
    half = 0.5 * m.heading
    w, x, y, z = h.q[0].tolist()
    s.start_q = s.q = product((float(np.cos(half)), 0.0, 0.0, float(np.sin(half))), (w, x, y, z))
    s.start_yaw_deg = s.yaw_deg = float(h.yaw_deg[0]) + degrees(m.heading)
    s.yaw_sigma_deg = degrees(sqrt(max(m.heading_var, 0.0)))
    s.tilt_sigma_deg = degrees(sqrt(max(m.tilt_var, 0.0)))
    axis = np.array(heading_axis(s.q))
    x, y, z = np.degrees(m.bias).tolist()
    s.bias_xyz_dps = (x, y, z)
    x, y, z = np.degrees(np.sqrt(np.maximum(np.diagonal(m.bias_cov), 0.0))).tolist()
    s.bias_sigma_xyz_dps = (x, y, z)
    s.bias_dps = degrees(float(axis @ m.bias))
    s.bias_sigma_dps = degrees(sqrt(max(float(axis @ m.bias_cov @ axis), 0.0)))
    s.rest_probability = float(h.weight[h.regime == REST].sum()) if s.segment.blocks > 0 else 0.0
    s.confidence = float(h.weight[0])
