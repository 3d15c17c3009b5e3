"""Tilt, roll and pitch through a mount, against rotation matrices of scipy."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from gyrodrift.values.mount import AXES, Axis, Mount, vector_of
from gyrodrift.values.quaternion import Quaternion, with_heading

MOUNTS = [(up, forward) for up in AXES for forward in AXES if up[1] != forward[1]]


def quaternion(rotation: Rotation) -> Quaternion:
    x, y, z, w = rotation.as_quat().tolist()
    return w, x, y, z


@pytest.mark.parametrize(("up", "forward"), MOUNTS)
def test_roll_and_pitch_are_those_of_the_device_whatever_axis_of_the_sensor_points_up(up: Axis, forward: Axis) -> None:
    device_from_sensor = np.array([vector_of(forward), np.cross(vector_of(up), vector_of(forward)), vector_of(up)])
    device = Rotation.from_euler("ZYX", [40.0, -25.0, 70.0], degrees=True)
    sensor = device * Rotation.from_matrix(device_from_sensor)
    mount = Mount(up, forward)

    roll_deg, pitch_deg = mount.roll_pitch_deg(quaternion(sensor))

    assert (roll_deg, pitch_deg) == pytest.approx((70.0, -25.0))
    assert mount.tilt_deg(quaternion(sensor)) == pytest.approx(np.rad2deg(np.arccos(device.as_matrix()[2, 2])))


def test_the_nose_down_is_a_positive_pitch_and_the_right_side_down_a_positive_roll() -> None:
    nose_down = Rotation.from_euler("y", 10.0, degrees=True)
    right_down = Rotation.from_euler("x", 10.0, degrees=True)

    assert Mount().roll_pitch_deg(quaternion(nose_down)) == pytest.approx((0.0, 10.0))
    assert Mount().roll_pitch_deg(quaternion(right_down)) == pytest.approx((10.0, 0.0))
    assert nose_down.apply([1.0, 0.0, 0.0])[2] < 0.0
    assert right_down.apply([0.0, -1.0, 0.0])[2] < 0.0


def test_a_turn_about_the_vertical_changes_neither_tilt_nor_roll_nor_pitch() -> None:
    q = quaternion(Rotation.from_euler("ZYX", [5.0, 30.0, -120.0], degrees=True))

    turn = with_heading(q, 123.0)

    assert Mount().roll_pitch_deg(turn) == pytest.approx(Mount().roll_pitch_deg(q))
    assert turn == pytest.approx(quaternion(Rotation.from_euler("ZYX", [128.0, 30.0, -120.0], degrees=True)))


def test_up_and_forward_along_the_same_axis_are_refused() -> None:
    with pytest.raises(ValueError, match="expected two different axes"):
        Mount("+z", "-z")


@pytest.mark.parametrize(("up", "forward"), MOUNTS)
def test_attitudes_of_sensor_and_device_follow_from_each_other(up: Axis, forward: Axis) -> None:
    mount = Mount(up, forward)
    device = quaternion(Rotation.from_euler("ZYX", [70.0, -25.0, 40.0], degrees=True))
    sensor = mount.sensor_attitude(device)
    assert mount.device_attitude(sensor) == pytest.approx(device)
    assert mount.roll_pitch_deg(sensor) == pytest.approx((40.0, -25.0))
    assert mount.to_sensor(mount.to_device((1.0, 2.0, 3.0))) == pytest.approx((1.0, 2.0, 3.0))
    assert mount.to_device(vector_of(up)) == pytest.approx((0.0, 0.0, 1.0))


@pytest.mark.parametrize("forward", ["+x", "-x", "+y", "-y"])
def test_a_sensor_that_lies_flat_has_the_heading_of_its_device(forward: Axis) -> None:
    w, _, _, z = Mount("+z", forward).sensor_attitude(quaternion(Rotation.from_euler("z", 70.0, degrees=True)))
    assert np.rad2deg(2.0 * np.arctan2(z, w)) % 360.0 == pytest.approx(70.0)
