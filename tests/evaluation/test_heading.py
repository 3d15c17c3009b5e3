"""Heading of attitudes, on rotations of scipy."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from gyrodrift.compare.methods.six_axes import heading_deg


def test_heading_counts_whole_turns() -> None:
    yaw_deg = np.linspace(0.0, 1000.0, 2000)
    swing = Rotation.from_rotvec([0.5, -0.3, 0.0])
    q = (Rotation.from_euler("z", yaw_deg[:, np.newaxis], degrees=True) * swing).as_quat(scalar_first=True)
    assert heading_deg(q) == pytest.approx(yaw_deg)


def test_a_sign_of_the_quaternion_means_nothing() -> None:
    q = Rotation.from_euler("z", np.linspace(0.0, 300.0, 500)[:, np.newaxis], degrees=True).as_quat(scalar_first=True)
    q[::3] *= -1.0
    assert heading_deg(q) == pytest.approx(np.linspace(0.0, 300.0, 500))


@pytest.mark.parametrize("past_deg", [-0.7, 0.7])
def test_a_roll_close_to_180_deg_of_tilt_does_not_jump_by_a_turn(past_deg: float) -> None:
    """A sensor that rolls over by 360 deg, almost through 180 deg of tilt, ends at its heading."""
    roll = Rotation.from_euler("x", np.linspace(0.0, 360.0, 3000)[:, np.newaxis], degrees=True)
    q = (Rotation.from_euler("y", past_deg, degrees=True) * roll).as_quat(scalar_first=True)
    heading = heading_deg(q)
    assert np.abs(np.diff(heading)).max() < 30.0
    assert abs(heading[-1]) < 10.0
