"""Levelling of the attitude by the mean acceleration of the first blocks."""

import numpy as np

from gyrodrift.filters.attitude.batch import products, unit
from gyrodrift.filters.attitude.block import RAD, Integrals
from gyrodrift.filters.attitude.hypotheses import BIAS
from gyrodrift.filters.attitude.model import AttitudeState
from gyrodrift.filters.attitude.predict import GRAVITY
from gyrodrift.values.quaternion import level, rotate

START_TILT = 4.0 * RAD
"""Standard deviation of the tilt at the first sample, rad. Measured: recordings of five rigs, median heading error."""

UNKNOWN_TILT = 30.0 * RAD
"""Standard deviation of the tilt before the first acceleration, rad. Chosen: boards mostly lie flat."""

START_RATE = 3.0 * RAD
MOVING_TILT = 12.0 * RAD
"""Rate above which the first block is a motion, rad/s, and the standard deviation of its tilt, rad: accelerations of
2 m/s². Chosen."""

LOST_TILT_DEG = 15.0
"""Standard deviation of the tilt from which on the next accelerations level it, deg. Chosen: the filter is linear below
it."""

MEAN_FORCE_S, LOST_SLOPE, LEAST_SQUARED = 5.0, 1.0 / 3.0, 10.0
"""Averaging time of the specific force, s; squared slope (30°) of its mean beyond which the tilt is lost, with a margin
for free fall, (m/s²)². Chosen: no vehicle accelerates by 6 m/s² for 5 s."""

LOST_BIAS = 0.3
"""Standard deviation of what a lost tilt has done to the biases, deg/s. Chosen."""

LEVELLING_S = 0.3
"""Time whose mean acceleration levels the attitude, s. Measured: as above."""


def level_start(s: AttitudeState, block: Integrals) -> None:
    """Turn all hypotheses so that the mean specific force since the first acceleration is vertical."""
    if s.tilt_sigma_deg > LOST_TILT_DEG:
        restart(s)
    if s.motion.level_s >= LEVELLING_S - 1e-9:
        return
    if s.motion.level_s == 0.0 and float(np.abs(block.gyro).max()) > START_RATE:
        cov, tilt = s.hypotheses.cov, [0, 1]
        cov[:, tilt, tilt] = np.maximum(cov[:, tilt, tilt], MOVING_TILT**2)
    x, y, z = block.velocity.tolist()
    fx, fy, fz = rotate(s.start_q, (x, y, z))
    lx, ly, lz = s.motion.level_force
    force = (lx + fx, ly + fy, lz + fz)
    turn = level(*force)
    h = s.hypotheses
    h.q = unit(products(np.array((turn,)), h.q))
    h.velocity = np.zeros_like(h.velocity)
    s.motion.level_s += block.seconds
    s.motion.level_force = rotate(turn, force)


def find_lost_tilt(s: AttitudeState, block: Integrals) -> None:
    """Begin levelling again if the mean specific force of the last seconds is far from the vertical."""
    x, y, z = (block.velocity / block.seconds).tolist()
    force = rotate(s.start_q, (x, y, z))
    share = min(1.0, block.seconds / MEAN_FORCE_S)
    mx, my, mz = (mean + share * (now - mean) for mean, now in zip(s.motion.mean_force, force, strict=True))
    s.motion.mean_force = (mx, my, mz)
    if mx * mx + my * my > LOST_SLOPE * mz * abs(mz) + LEAST_SQUARED:
        restart(s)
        s.motion.mean_force = (0.0, 0.0, GRAVITY)
        h = s.hypotheses
        h.cov[:, :2, :2] = MOVING_TILT**2 * np.eye(2)
        h.cov[:, BIAS, BIAS] += (LOST_BIAS * RAD) ** 2 * np.eye(3)


def restart(s: AttitudeState) -> None:
    """Begin levelling again, with the tilt of a first sample."""
    s.motion.level_s, s.motion.level_force = 0.0, (0.0, 0.0, 0.0)
    cov = s.hypotheses.cov
    cov[:, :2, :] = 0.0
    cov[:, :, :2] = 0.0
    cov[:, :2, :2] = START_TILT**2 * np.eye(2)
