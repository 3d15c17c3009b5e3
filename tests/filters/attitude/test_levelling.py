"""Levelling of the attitude filter."""

import numpy as np

from gyrodrift.filters.attitude.block import Integrals
from gyrodrift.filters.attitude.hypotheses import STATES
from gyrodrift.filters.attitude.levelling import MOVING_TILT, level_start
from gyrodrift.filters.attitude.model import AttitudeState

MOVING = Integrals(
    seconds=0.1,
    rotation=np.array((1.0, 0.0, 0.0, 0.0)),
    velocity=np.array((0.1, 0.0, 0.9)),
    by_bias=0.1 * np.eye(3),
    by_scale=np.zeros((3, 9)),
    gyro=np.array((0.5, 0.0, 0.0)),
    accel=np.array((1.0, 0.0, 9.0)),
    squared_turn=0.0,
)


def test_a_first_acceleration_in_a_motion_leaves_a_covariance() -> None:
    """A tilt of two axes that are known together, and with the heading: no combination has a negative variance."""
    s = AttitudeState(tilt_sigma_deg=14.0)
    direction = np.zeros(STATES)
    direction[:3] = 0.25, -0.25, 0.3
    s.hypotheses.cov[0] = np.outer(direction, direction) + 1e-6 * np.eye(STATES)
    level_start(s, MOVING)
    assert np.linalg.eigvalsh(s.hypotheses.cov[0]).min() > 0.0
    assert np.diagonal(s.hypotheses.cov[0])[:2].min() >= MOVING_TILT**2
