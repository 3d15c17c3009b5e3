"""Messages of ROS 2 and 1 that others wrote: turns about z, and schemas that are not to be believed."""

import math
import struct
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pytest
from foreign_support import SAMPLE_TEXT, Recorder, imu, refused, ros, written

from gyrodrift.session.files import load_session
from gyrodrift.session.foreign.read import read_foreign
from gyrodrift.values.errors import DataError


@pytest.mark.parametrize("name", ["sensor_msgs/msg/Imu", "sensor_msgs/Imu"])
def test_an_imu_gives_its_turn_about_z_in_degrees(tmp_path: Path, name: str) -> None:
    """Device time from the stamp, host time from the log; there is no angle, temperature or counter."""
    session = read_foreign(written(tmp_path, ros(map(imu, range(60)), name=name)))
    assert session.t_device_s.tolist() == [1_700_000_000.500000001 + i for i in range(60)]
    assert session.rate_dps.tolist() == [math.degrees(0.01 * i) for i in range(60)]
    assert session.t_host_s is not None
    assert session.t_host_s.tolist() == [(5_000_000 + i) / 1e6 for i in range(60)]
    assert (session.seq, session.encoder_deg, session.temp_c) == (None, None, None)


def test_an_imu_without_a_rate_is_told(tmp_path: Path) -> None:
    lacking = imu(3, angular_velocity_covariance=[-1.0] + [0.0] * 8)
    text = refused(tmp_path, ros([imu(0), imu(1), lacking]))
    assert text == "/imu/data: message 3 has no rate: angular_velocity_covariance begins with -1"


@pytest.mark.parametrize(
    ("name", "schema", "payload", "message"),
    [
        ("gyrodrift/Sample", SAMPLE_TEXT, b"\0\1\0\0\0", "message 1 does not fit its schema gyrodrift/Sample"),
        ("gyrodrift/Sample", "float64 x", b"\0\1\0\0" + b"\0" * 8, "message 1 has no t_device_s, which is required"),
        (
            "gyrodrift/Sample",
            "float64 t_device_s\nstring rate_dps",
            b"\0\1\0\0" + b"\0" * 8 + b"\3\0\0\0up\0",
            "message 1 has 'up' as rate_dps, expected a number",
        ),
        ("gyrodrift/Sample", "not a ! field", b"", "the schema gyrodrift/Sample cannot be parsed"),
        ("gyrodrift/Sample", "other/Part x", b"\0\1\0\0", "message 1 does not fit its schema gyrodrift/Sample"),
        ("gyrodrift/Sample", "gyrodrift/Sample x", b"\0\1\0\0", "does not fit its schema gyrodrift/Sample"),
        ("sensor_msgs/msg/Imu", "float64 x", b"\0\1\0\0" + b"\0" * 8, "message 1 lacks header.stamp, angular_velocity"),
    ],
)
def test_a_schema_that_lies_is_told(
    tmp_path: Path, name: str, schema: str, payload: bytes, message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    recorder = Recorder()
    recorder.add(recorder.channel("/a", "cdr", (name, "ros2msg", schema)), [payload])
    text = refused(tmp_path, recorder.content())
    assert text.startswith("/a: ")
    assert message in text
    assert capsys.readouterr() == ("", "")


def test_a_schema_of_very_many_fields_is_refused(tmp_path: Path) -> None:
    many = SAMPLE_TEXT + "".join(f"int32 a{number}\n" for number in range(40_000))
    recorder = Recorder()
    recorder.add(recorder.channel("/a", "cdr", ("gyrodrift/Sample", "ros2msg", many)), [b"\0\1\0\0"])
    text = refused(tmp_path, recorder.content())
    assert "has 400" in text
    assert "at most 2000" in text


def ros1_imu(stamp: tuple[int, int], rate_rads: float, frame: bytes = b"imu_link", covariance: float = 0.0) -> bytes:
    """`sensor_msgs/Imu` as roscpp lays it out."""
    nine = [0.0] * 9
    values = [0.0, 0.0, 0.0, 1.0, *nine, 0.1, 0.2, rate_rads, covariance, *nine[1:], 0.0, 0.0, 9.8, *nine]
    return struct.pack("<IIII", 7, *stamp, len(frame)) + frame + struct.pack("<37d", *values)


def in_ros1(payloads: Iterable[bytes]) -> bytes:
    recorder = Recorder()
    recorder.add(recorder.channel("/imu/data", "ros1", ("sensor_msgs/Imu", "ros1msg", "Header header\n")), payloads)
    return recorder.content()


@pytest.mark.promise("Files of other programs")
def test_an_imu_of_ros_1_is_read_as_one_of_ros_2(tmp_path: Path) -> None:
    """An Imu of ROS 1 in MCAP is read like an Imu of ROS 2."""
    path = written(
        tmp_path, in_ros1(ros1_imu((1_600_000_000, 250_000_000 + 10**7 * i), math.radians(i)) for i in range(5))
    )
    session = load_session(path)
    assert session.rate_dps == pytest.approx(np.arange(5.0))
    assert session.t_device_s[0] == 1_600_000_000.25
    assert session.remarks == ()


@pytest.mark.parametrize(
    ("payload", "message"),
    [
        (ros1_imu((1, 0), 0.1)[:-1], "message 1 does not fit its schema sensor_msgs/Imu"),
        (b"\0" * 7, "message 1 does not fit its schema sensor_msgs/Imu"),
        (ros1_imu((1, 0), 0.1, covariance=-1.0), "message 1 has no rate: angular_velocity_covariance begins with -1"),
    ],
)
def test_an_imu_of_ros_1_that_is_none_is_named(tmp_path: Path, payload: bytes, message: str) -> None:
    with pytest.raises(DataError, match=message):
        load_session(written(tmp_path, in_ros1([payload])))


@pytest.mark.promise("Files of other programs")
@pytest.mark.parametrize("stamp", [0, 1_600_000_000])
def test_stamps_that_stand_still_give_way_to_the_time_of_the_log(tmp_path: Path, stamp: int) -> None:
    """Stamps that stand still are replaced by the log time, with a message."""
    session = load_session(written(tmp_path, in_ros1(ros1_imu((stamp, 0), 0.1) for _ in range(4))))
    assert session.t_device_s == pytest.approx([0.0, 0.01, 0.02, 0.03], abs=1e-6)
    assert "the times of logging are used" in session.remarks[0]
