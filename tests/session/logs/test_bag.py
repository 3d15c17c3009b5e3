"""Bags of ROS 1 and 2, written by rosbags."""

import struct
from collections.abc import Callable
from math import radians
from pathlib import Path
from typing import Any

import pytest
from tables_support import TURN_DEG, filtered_yaw_deg, samples, written

from gyrodrift.cli import main
from gyrodrift.session.files import load_session, session_paths
from gyrodrift.values.errors import DataError

rosbag1 = pytest.importorskip("rosbags.rosbag1")
rosbag2 = pytest.importorskip("rosbags.rosbag2")
typesys = pytest.importorskip("rosbags.typesys")

NS = 10**9
BEGAN_S = 1_600_000_000
IMU = "sensor_msgs/msg/Imu"


def ros1_imu(t_ns: int, rate_rads: float) -> bytes:
    nine = [0.0] * 9
    values = [0.0, 0.0, 0.0, 1.0, *nine, 0.1, 0.2, rate_rads, *nine, 0.0, 0.0, 9.8, *nine]
    return struct.pack("<IIII", 7, *divmod(t_ns, NS), 3) + b"imu" + struct.pack("<37d", *values)


def ros2_imu(t_ns: int, rate_rads: float) -> bytes:
    nine = [0.0] * 9
    values = [0.0, 0.0, 0.0, 1.0, *nine, 0.1, 0.2, rate_rads, *nine, 0.0, 0.0, 9.8, *nine]
    head = struct.pack("<iII", *divmod(t_ns, NS), 4) + b"imu\0"
    return b"\0\1\0\0" + head + struct.pack("<37d", *values)


def write_messages(writer: Any, store: Any, topics: tuple[str, ...], imu: Callable[[int, float], bytes]) -> None:
    connections = [writer.add_connection(topic, IMU, typestore=store) for topic in topics]
    for _, t_s, rate_dps in samples():
        t_ns = BEGAN_S * NS + round(t_s * NS)
        for connection in connections:
            writer.write(connection, t_ns + 1000, imu(t_ns, radians(rate_dps)))


def bag1(path: Path, *topics: str) -> Path:
    with rosbag1.Writer(path) as writer:
        write_messages(writer, typesys.get_typestore(typesys.Stores.ROS1_NOETIC), topics, ros1_imu)
    return path


def bag2(path: Path, *topics: str) -> Path:
    with rosbag2.Writer(path, version=9) as writer:
        write_messages(writer, typesys.get_typestore(typesys.Stores.ROS2_HUMBLE), topics, ros2_imu)
    return path


@pytest.mark.promise("Files of other programs")
def test_a_bag_of_ros_1_is_read(tmp_path: Path) -> None:
    """ROS 1 bags are read."""
    path = bag1(tmp_path / "robot.bag", "/imu/data")
    assert filtered_yaw_deg(path) == pytest.approx(TURN_DEG, abs=1.0)
    assert load_session(path).t_device_s[0] == BEGAN_S


@pytest.mark.promise("Files of other programs")
def test_a_bag_of_ros_2_is_read_by_its_folder_and_by_its_file(tmp_path: Path) -> None:
    """ROS 2 bags are read, as a folder and as a file."""
    folder = bag2(tmp_path / "run_1", "/imu")
    (file,) = folder.glob("*.db3")
    assert session_paths([folder]) == session_paths([tmp_path]) == [file]
    assert filtered_yaw_deg(folder) == pytest.approx(TURN_DEG, abs=1.0)
    assert filtered_yaw_deg(file) == pytest.approx(TURN_DEG, abs=1.0)
    assert main(["info", str(folder)]) == 0


@pytest.mark.parametrize(("kind", "name"), [(bag1, "robot.bag"), (bag2, "robot")])
def test_a_topic_is_chosen_where_there_are_several(tmp_path: Path, kind: Callable[..., Path], name: str) -> None:
    path = kind(tmp_path / name, "/left", "/right")
    with pytest.raises(DataError, match=r"samples may be on /left, /right; choose one with gyrodrift convert --topic"):
        load_session(path)
    assert main(["convert", str(path), str(tmp_path / "out.csv"), "--topic", "/right"]) == 0
    assert len(load_session(tmp_path / "out.csv").rate_dps) == len(list(samples()))
    assert main(["convert", str(path), str(tmp_path / "no.csv"), "--topic", "/up"]) == 4


@pytest.mark.parametrize("name", ["a.bag", "a.db3"])
def test_what_is_no_bag_is_said(tmp_path: Path, name: str) -> None:
    with pytest.raises(DataError, match=r"is no bag, or damaged|there is no metadata\.yaml beside it"):
        load_session(written(tmp_path / name, b"#ROSBAG V2.0\n" + bytes(99)))


@pytest.mark.promise("Files of other programs")
def test_message_definitions_of_a_bag_are_not_parsed(tmp_path: Path) -> None:
    """Message definitions of a bag are not parsed."""
    path, store = tmp_path / "robot.bag", typesys.get_typestore(typesys.Stores.ROS1_NOETIC)
    with rosbag1.Writer(path) as writer:
        for topic, definition in (("/a", "]" * 99), ("/b", "int32 a\n" * 100_000)):
            second = writer.add_connection(topic, "pkg/msg/Other", msgdef=definition, md5sum="0" * 32)
            writer.write(second, BEGAN_S * NS, bytes(8))
        write_messages(writer, store, ("/imu",), ros1_imu)
    assert len(load_session(path).rate_dps) == len(list(samples()))


@pytest.mark.promise("Files of other programs")
def test_a_huge_file_that_is_no_bag_is_refused_at_once(tmp_path: Path) -> None:
    """A huge file that is not a bag is refused at once."""
    path = tmp_path / "robot.bag"
    with path.open("wb") as file:
        file.truncate(1 << 40)
    with pytest.raises(DataError, match="does not begin with #ROSBAG"):
        load_session(path)


@pytest.mark.parametrize(("kind", "name"), [(bag1, "robot.bag"), (bag2, "robot")])
def test_a_bag_gives_all_axes(tmp_path: Path, kind: Callable[..., Path], name: str) -> None:
    session = load_session(kind(tmp_path / name, "/imu"))
    assert session.gyro_dps is not None
    assert session.accel_mps2 is not None
    assert session.gyro_dps[0] == pytest.approx((5.7296, 11.4592, session.rate_dps[0]), abs=1e-3)
    assert session.accel_mps2[0] == pytest.approx((0.0, 0.0, 9.8))
