"""The board that is laid on its sides: its attitudes, rests, rates and forces."""

import numpy as np
import pytest
from scipy.integrate import cumulative_simpson
from scipy.spatial.transform import Rotation

from firmware_sim.motion.attitude.kinematics import Kinematics
from firmware_sim.motion.attitude.profile import AttitudeProfile
from firmware_sim.motion.attitude.sides import Sides
from firmware_sim.motion.profile import load_motion

GRAVITY = 9.81
REST_S, MOVE_S = 4.0, 2.0


def attitudes_of(motion: Kinematics) -> Rotation:
    return Rotation.from_quat(np.roll(motion.quaternion, -1, axis=1))


def test_each_side_is_up_at_rest_and_each_axis_makes_a_turn_there_and_back() -> None:
    """z, y, −z, −y, z, x, −x and z again; gravity is measured along the axis that is up."""
    motion = Sides(kind="sides")
    t_s = np.arange(0.0, motion.seconds, 0.01)
    kinematics = motion.kinematics_at(t_s)
    force = kinematics.specific_force_mps2(GRAVITY)
    still = kinematics.is_still()
    ups = np.rint(force[still] / GRAVITY).astype(int)
    assert np.abs(force[still] - GRAVITY * ups).max() < 1e-9
    changes = [tuple(ups[0].tolist())]
    changes += [tuple(up.tolist()) for up, before in zip(ups[1:], ups, strict=False) if (up != before).any()]
    z, y, x = (0, 0, 1), (0, 1, 0), (1, 0, 0)
    assert changes == [z, y, (0, 0, -1), (0, -1, 0), z, x, (-1, 0, 0), z]
    assert np.ptp(kinematics.heading_deg) == 360.0
    assert motion.seconds == REST_S + 7 * (MOVE_S + REST_S) + 6 * (6.0 + REST_S)


def test_without_turns_only_the_sides_remain() -> None:
    motion = Sides(kind="sides", turns=0)
    kinematics = motion.kinematics_at(np.arange(0.0, motion.seconds, 0.1))
    assert np.ptp(kinematics.heading_deg) == 0.0
    assert motion.seconds == REST_S + 7 * (MOVE_S + REST_S)


def test_rates_are_those_of_the_attitude_and_the_velocity_that_of_the_force() -> None:
    """Differences over a millisecond, and Simpson's rule, agree; the attitude does not jump when z points down."""
    motion = Sides(kind="sides", rest_s=0.5, sensor_m=(0.1, -0.2, 0.3))
    t_s = np.arange(0.0, motion.seconds, 1e-3)
    kinematics = motion.kinematics_at(t_s)
    attitudes = attitudes_of(kinematics)
    steps_dps = (attitudes[:-2].inv() * attitudes[2:]).as_rotvec(degrees=True) / 2e-3
    assert np.abs(steps_dps - kinematics.rates_dps[1:-1]).max() < 0.01
    velocity = cumulative_simpson(kinematics.acceleration_mps2, x=t_s, axis=0, initial=0.0)
    assert np.abs(velocity - kinematics.velocity_mps).max() < 1e-5
    assert np.abs(kinematics.velocity_mps).max() > 0.5


@pytest.mark.parametrize("passes", [1, 5])
def test_a_pass_repeats_the_first(passes: int) -> None:
    profile = load_motion("six-sides")
    assert isinstance(profile, AttitudeProfile)
    t_s = np.arange(0.0, profile.seconds, 0.5)
    first, later = profile.kinematics_at(t_s), profile.kinematics_at(t_s + passes * profile.seconds)
    assert np.abs(first.rates_dps - later.rates_dps).max() < 1e-6
    assert np.abs(first.heading_deg - later.heading_deg).max() < 1e-6
