"""Levelling of the attitude by the mean acceleration of the first blocks."""

import numpy as np

from gyrodrift.filters.attitude.batch import products, unit
from gyrodrift.filters.attitude.block import Integrals
from gyrodrift.filters.attitude.model import RAD, AttitudeState
from gyrodrift.filters.attitude.quaternion import level, rotate

START_TILT = 4.0 * RAD
"""Standard deviation of the tilt at the first sample, rad. Measured: recordings of five rigs, median heading error."""

UNKNOWN_TILT = 30.0 * RAD
"""Standard deviation of the tilt before the first acceleration, rad. Chosen: boards mostly lie flat."""

LOST_TILT_DEG = 15.0
"""Standard deviation of the tilt from which on the next accelerations level it, deg: the filter is linear below it."""

LEVELLING_S = 0.3
"""Time whose mean acceleration levels the attitude, s. Measured: as above."""


def level_start(s: AttitudeState, block: Integrals) -> None:
    """Turn all hypotheses so that the mean specific force since the first acceleration is vertical."""
    if s.tilt_sigma_deg > LOST_TILT_DEG:
        restart(s)
    if s.level_s >= LEVELLING_S - 1e-9:
        return
    x, y, z = block.velocity.tolist()
    fx, fy, fz = rotate(s.start_q, (x, y, z))
    lx, ly, lz = s.level_force
    force = (lx + fx, ly + fy, lz + fz)
    turn = level(*force)
    h = s.hypotheses
    h.q = unit(products(np.array((turn,)), h.q))
    h.velocity = np.zeros_like(h.velocity)
    s.level_s += block.seconds
    s.level_force = rotate(turn, force)


def restart(s: AttitudeState) -> None:
    """Begin levelling again, with the tilt of a first sample."""
    s.level_s, s.level_force = 0.0, (0.0, 0.0, 0.0)
    cov = s.hypotheses.cov
    cov[:, :2, :] = 0.0
    cov[:, :, :2] = 0.0
    cov[:, :2, :2] = START_TILT**2 * np.eye(2)
