"""Attitude of a device from that of its sensor, against rotations of scipy."""

from itertools import product
from math import acos, degrees

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from outputs_support import tilted
from scipy.spatial.transform import Rotation

from gyrodrift.outputs.device_frame import DeviceFrame
from gyrodrift.values.quaternion import Quaternion, angles_rad, frd
from gyrodrift.values.sample import Attitude

SIGNED_AXES = [sign + axis for sign in "+-" for axis in "xyz"]
MOUNTS = [(up, forward) for up, forward in product(SIGNED_AXES, SIGNED_AXES) if up[1] != forward[1]]

angle = st.floats(-179.0, 179.0)


def rotation(q: Quaternion) -> Rotation:
    w, *vector = q
    return Rotation.from_quat([*vector, w])


def twist_deg(turn: Rotation) -> float:
    """About the vertical."""
    *_, z, w = turn.as_quat()
    return 2.0 * degrees(np.arctan2(z, w))


def frame_of(mount: tuple[str, str]) -> tuple[DeviceFrame, Rotation]:
    """Its axes, and the rotation from device to sensor."""
    frame = DeviceFrame.of({"up": mount[0], "forward": mount[1]})
    return frame, Rotation.from_matrix(np.array(frame.mount.axes).T)


@pytest.mark.parametrize("mount", MOUNTS)
def test_axes_of_a_mount_are_right_handed(mount: tuple[str, str]) -> None:
    frame, turn = frame_of(mount)
    assert np.linalg.det(turn.as_matrix()) == pytest.approx(1.0)
    assert np.allclose(rotation(frame.mount.quaternion).as_matrix(), turn.as_matrix())
    assert np.allclose(frame.mount.to_device((1.0, 2.0, 3.0)), turn.inv().apply([1.0, 2.0, 3.0]))


@pytest.mark.promise("Clients of outputs")
@given(st.sampled_from(MOUNTS), angle, st.floats(-80.0, 80.0), st.floats(-60.0, 60.0), angle)
def test_a_device_has_its_tilt_and_the_heading(
    mount: tuple[str, str], yaw_deg: float, pitch_deg: float, roll_deg: float, heading_deg: float
) -> None:
    """A device has its tilt and heading however its sensor is mounted."""
    frame, turn = frame_of(mount)
    level = Rotation.from_euler("ZYX", [0.0, pitch_deg, roll_deg], degrees=True)
    device = Rotation.from_euler("z", yaw_deg - twist_deg(level), degrees=True) * level
    x, y, z, w = (device * turn.inv()).as_quat()
    attitude = Attitude(w, x, y, z, 0.0, roll_deg, pitch_deg, 0.0, 0.0, 0.0, 0.0)
    north = Rotation.from_euler("z", heading_deg - yaw_deg, degrees=True)
    result = rotation(frame.attitude(attitude, yaw_deg, heading_deg))
    assert (result * (north * device).inv()).magnitude() < 1e-7


@pytest.mark.parametrize("mount", MOUNTS)
def test_upside_down_the_attitude_is_that_of_the_sensor(mount: tuple[str, str]) -> None:
    frame, _ = frame_of(mount)
    device = Rotation.from_euler("ZYX", [40.0, 5.0, 175.0], degrees=True)
    w, x, y, z = device.as_quat(scalar_first=True).tolist()
    attitude = Attitude(*frame.mount.sensor_attitude((w, x, y, z)), 0.0, 175.0, 5.0, 0.0, 0.0, 0.0, 0.0)
    result = rotation(frame.attitude(attitude, 10.0, 10.0))
    assert (result * device.inv()).magnitude() < 1e-7


@given(angle, st.floats(-89.0, 89.0), angle)
def test_angles_are_those_of_the_rotation(yaw_deg: float, pitch_deg: float, roll_deg: float) -> None:
    x, y, z, w = Rotation.from_euler("ZYX", [yaw_deg, pitch_deg, roll_deg], degrees=True).as_quat()
    assert np.degrees(angles_rad((w, x, y, z))) == pytest.approx([roll_deg, pitch_deg, yaw_deg], abs=1e-6)


@given(angle, st.floats(-89.0, 89.0), angle)
def test_forward_right_down_turns_pitch_and_yaw_round(yaw_deg: float, pitch_deg: float, roll_deg: float) -> None:
    x, y, z, w = Rotation.from_euler("ZYX", [yaw_deg, pitch_deg, roll_deg], degrees=True).as_quat()
    assert np.degrees(angles_rad(frd((w, x, y, z)))) == pytest.approx([roll_deg, -pitch_deg, -yaw_deg], abs=1e-6)


def test_the_support_of_tests_agrees() -> None:
    attitude = tilted(0).attitude
    assert attitude is not None
    turn = rotation(attitude[:4])
    assert twist_deg(turn) == pytest.approx(30.0)
    assert turn.as_euler("ZYX", degrees=True)[1:] == pytest.approx([-20.0, 10.0])
    assert degrees(acos(rotation(attitude[:4]).as_matrix()[2, 2])) == pytest.approx(attitude.tilt_deg, abs=1e-4)
