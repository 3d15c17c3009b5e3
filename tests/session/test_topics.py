"""Reference angles of odometry, poses and joints, in bags of ROS 1 and 2 and in MCAP, beside the samples of an Imu."""

import io
from collections.abc import Callable
from math import cos, radians, sin
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from mcap.writer import Writer as McapWriter
from support import quick

import gyrodrift
from gyrodrift.cli import main
from gyrodrift.session.files import load_session
from gyrodrift.session.foreign.reference import ORIENTATIONS, at_samples, question_of
from gyrodrift.values.errors import DataError, UsageError

rosbag1 = pytest.importorskip("rosbags.rosbag1")
rosbag2 = pytest.importorskip("rosbags.rosbag2")
typesys = pytest.importorskip("rosbags.typesys")

ROS1, ROS2 = (typesys.get_typestore(typesys.Stores[name]) for name in ("ROS1_NOETIC", "ROS2_HUMBLE"))
NS = 10**9
BEGAN_S = 1_700_000_000
IMU_HZ, SECONDS = 100.0, 12.0
NINE, MANY = np.zeros(9), np.zeros(36)
ODOMETRY, JOINTS = "nav_msgs/msg/Odometry", "sensor_msgs/msg/JointState"


class Message(NamedTuple):
    """A message of a topic, with its stamp after the beginning."""

    topic: str
    kind: str
    t_s: float
    value: Any


def angle_deg(t_s: float) -> float:
    """Turns there and back, three of them."""
    return 540.0 * (1.0 - cos(2.0 * np.pi * t_s / SECONDS))


def rate_dps(t_s: float) -> float:
    return 540.0 * 2.0 * np.pi / SECONDS * sin(2.0 * np.pi * t_s / SECONDS)


def make(store: Any, kind: str, t_s: float, frame: str = "odom") -> Any:
    """A message of a type at a time."""
    types = store.types
    vector, quaternion, point = (types[f"geometry_msgs/msg/{name}"] for name in ("Vector3", "Quaternion", "Point"))
    sec, nanosec = divmod(BEGAN_S * NS + round(t_s * NS), NS)
    stamp = types["builtin_interfaces/msg/Time"](sec=sec, nanosec=nanosec)
    extra = {"seq": 0} if store is ROS1 else {}
    header = types["std_msgs/msg/Header"](stamp=stamp, frame_id=frame, **extra)
    half = radians(angle_deg(t_s)) / 2.0
    heading = quaternion(0.0, 0.0, sin(half), cos(half))
    pose = types["geometry_msgs/msg/Pose"](point(0.0, 0.0, 0.0), heading)
    covered = types["geometry_msgs/msg/PoseWithCovariance"](pose, MANY)
    none = vector(0.0, 0.0, 0.0)
    match kind:
        case "sensor_msgs/msg/Imu":
            rate = vector(0.0, 0.0, radians(rate_dps(t_s)))
            return types[kind](header, heading, NINE, rate, NINE, vector(0.0, 0.0, 9.8), NINE)
        case "nav_msgs/msg/Odometry":
            twist = types["geometry_msgs/msg/TwistWithCovariance"](types["geometry_msgs/msg/Twist"](none, none), MANY)
            return types[kind](header, "base", covered, twist)
        case "geometry_msgs/msg/PoseStamped":
            return types[kind](header, pose)
        case "geometry_msgs/msg/PoseWithCovarianceStamped":
            return types[kind](header, covered)
        case "geometry_msgs/msg/TransformStamped":
            return types[kind](header, "base", types["geometry_msgs/msg/Transform"](none, heading))
        case _:
            empty = np.array([])
            positions = np.array([1.5, radians(angle_deg(t_s))])
            return types[kind](header, ["arm", "table"], positions, empty, empty)


def messages(store: Any, *references: tuple[str, str, float]) -> list[Message]:
    """Messages of an Imu, and of references by topic, type and rate, which begin a little later."""
    topics = [("/imu", "sensor_msgs/msg/Imu", IMU_HZ, 0.0), *((*reference, 0.0037) for reference in references)]
    result = [
        Message(topic, kind, t_s, make(store, kind, t_s))
        for topic, kind, hz, first_s in topics
        for t_s in np.arange(first_s, SECONDS, 1.0 / hz).tolist()
    ]
    return sorted(result, key=lambda message: message.t_s)


def bag1(folder: Path, *references: tuple[str, str, float]) -> Path:
    path = folder / "robot.bag"
    with rosbag1.Writer(path) as writer:
        _written(writer, ROS1, ROS1.serialize_ros1, references)
    return path


def bag2(folder: Path, *references: tuple[str, str, float]) -> Path:
    path = folder / "robot"
    with rosbag2.Writer(path, version=9) as writer:
        _written(writer, ROS2, ROS2.serialize_cdr, references)
    return path


def _written(writer: Any, store: Any, serialize: Callable[[Any, str], Any], references: Any) -> None:
    connections: dict[str, Any] = {}
    for topic, kind, t_s, value in messages(store, *references):
        if topic not in connections:
            connections[topic] = writer.add_connection(topic, kind, typestore=store)
        writer.write(connections[topic], BEGAN_S * NS + round(t_s * NS) + 1000, bytes(serialize(value, kind)))


def mcap2(folder: Path, *references: tuple[str, str, float]) -> Path:
    return _mcap(folder / "robot.mcap", ROS2, ROS2.serialize_cdr, ("ros2msg", "cdr"), references)


def mcap1(folder: Path, *references: tuple[str, str, float]) -> Path:
    return _mcap(folder / "robot.mcap", ROS1, ROS1.serialize_ros1, ("ros1msg", "ros1"), references)


def _mcap(path: Path, store: Any, serialize: Any, forms: tuple[str, str], references: Any) -> Path:
    stream = io.BytesIO()
    writer = McapWriter(stream)
    writer.start("ros", "somebody")
    channels: dict[str, int] = {}
    for topic, kind, t_s, value in messages(store, *references):
        if topic not in channels:
            text = store.generate_msgdef(kind, ros_version=1 if store is ROS1 else 2)[0]
            name = kind.replace("/msg/", "/") if store is ROS1 else kind
            schema = writer.register_schema(name, forms[0], text.encode())
            channels[topic] = writer.register_channel(topic, forms[1], schema)
        logged_ns = BEGAN_S * NS + round(t_s * NS) + 1000
        writer.add_message(channels[topic], logged_ns, bytes(serialize(value, kind)), logged_ns)
    writer.finish()  # type: ignore[no-untyped-call]  # the package leaves it unannotated
    path.write_bytes(stream.getvalue())
    return path


@pytest.mark.parametrize("record", [bag1, bag2, mcap1, mcap2])
def test_the_heading_of_odometry_is_the_reference(tmp_path: Path, record: Callable[..., Path]) -> None:
    path = record(tmp_path, ("/odom", ODOMETRY, 30.0))
    session = load_session(path, reference="/odom")
    assert session.encoder_deg is not None
    is_known = np.isfinite(session.encoder_deg)
    assert np.count_nonzero(is_known) == pytest.approx(30.0 * SECONDS, abs=1)
    t_s = session.t_device_s - BEGAN_S
    truth_deg = [angle_deg(item) for item in t_s[is_known]]
    np.testing.assert_allclose(session.encoder_deg[is_known], truth_deg, atol=0.02)
    assert np.nanmax(session.encoder_deg) > 1079.0
    assert session.remarks[-1] == f"its reference angle is that of /odom ({ODOMETRY})"


@pytest.mark.parametrize("kind", ORIENTATIONS)
@pytest.mark.parametrize("hz", quick([20.0, 100.0, 400.0], 20.0, 400.0))
def test_each_message_with_an_orientation_is_read_at_any_rate(tmp_path: Path, kind: str, hz: float) -> None:
    """A faster reference has an angle in every sample."""
    session = load_session(mcap2(tmp_path, ("/pose", kind, hz)), reference="/pose")
    assert session.encoder_deg is not None
    is_known = np.isfinite(session.encoder_deg)
    assert np.mean(is_known) == pytest.approx(min(1.0, hz / IMU_HZ), abs=0.01)
    truth_deg = [angle_deg(item) for item in (session.t_device_s - BEGAN_S)[is_known]]
    np.testing.assert_allclose(session.encoder_deg[is_known], truth_deg, atol=0.05)


@pytest.mark.parametrize("record", [bag1, bag2, mcap1, mcap2])
def test_a_joint_is_chosen_by_its_name(tmp_path: Path, record: Callable[..., Path]) -> None:
    path = record(tmp_path, ("/joints", JOINTS, 100.0))
    with pytest.raises(DataError, match="has the joints arm, table; choose one as TOPIC:JOINT"):
        load_session(path, reference="/joints")
    with pytest.raises(DataError, match="has the joints arm, table"):
        load_session(path, reference="/joints:wheel")
    session = load_session(path, reference="/joints:table")
    assert session.encoder_deg is not None
    assert np.nanmax(session.encoder_deg) == pytest.approx(1080.0, abs=0.1)


@pytest.mark.parametrize("record", [bag1, bag2, mcap1, mcap2])
def test_a_wrong_topic_is_answered_with_those_that_have_an_angle(tmp_path: Path, record: Callable[..., Path]) -> None:
    path = record(tmp_path, ("/odom", ODOMETRY, 10.0))
    for topic in ("/imu", "/no"):
        with pytest.raises(DataError, match=rf"{topic} has no reference angle.*topics with one: /odom"):
            load_session(path, reference=topic)
    assert question_of(path) == f"choose its reference with --reference TOPIC: /odom ({ODOMETRY})"


def test_a_table_has_no_topics(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("t_device_s,rate_dps\n" + "".join(f"{0.01 * i},1.5\n" for i in range(50)))
    with pytest.raises(UsageError, match="has no topics; name the angle of a table with --columns"):
        load_session(tmp_path / "a.csv", reference="/odom")
    assert question_of(tmp_path / "a.csv") == ""


def test_a_table_keeps_its_angle_beside_a_bag(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("t_device_s,rate_dps,encoder_deg\n0.0,1.5,3\n0.01,1.5,4\n")
    session = load_session(tmp_path / "a.csv", reference="/odom")
    assert session.encoder_deg is not None
    assert session.encoder_deg.tolist() == [3.0, 4.0]
    assert session.remarks[-1] == "it has no topic /odom: its own angle is the reference"


@pytest.mark.parametrize("record", [bag2, mcap2])
def test_diagnose_asks_for_the_topic(
    tmp_path: Path, record: Callable[..., Path], capsys: pytest.CaptureFixture[str]
) -> None:
    path = record(tmp_path, ("/odom", ODOMETRY, 30.0))
    assert main(["diagnose", str(path), "--out", str(tmp_path / "out")]) == 4
    assert f"choose its reference with --reference TOPIC: /odom ({ODOMETRY})" in capsys.readouterr().err


def test_convert_writes_the_angle_beside_the_samples(tmp_path: Path) -> None:
    path = mcap2(tmp_path, ("/odom", ODOMETRY, 30.0), ("/other", "sensor_msgs/msg/Imu", 10.0))
    words = ["--topic", "/imu", "--reference", "/odom"]
    assert main(["convert", str(path), str(tmp_path / "out.csv"), *words]) == 0
    written = load_session(tmp_path / "out.csv")
    assert written.encoder_deg is not None
    alone = tmp_path / "alone"
    alone.mkdir()
    read = gyrodrift.load_session(mcap2(alone, ("/odom", ODOMETRY, 30.0)), reference="/odom")
    assert read.encoder_deg is not None
    np.testing.assert_allclose(written.encoder_deg, read.encoder_deg, atol=1e-6)


@pytest.mark.parametrize("away_s", [0.004, 0.0051])
def test_a_reading_counts_half_a_sample_around(away_s: float) -> None:
    t_s = np.arange(0.0, 1.0, 0.01)
    read_s = np.arange(0.1, 0.9, 0.1) + away_s
    found_deg = at_samples(t_s, read_s, 90.0 * read_s)
    is_known = np.isfinite(found_deg)
    assert np.count_nonzero(is_known) == len(read_s)
    np.testing.assert_allclose(found_deg[is_known], 90.0 * t_s[is_known])
    assert (np.flatnonzero(is_known) % 10 == (0 if away_s < 0.005 else 1)).all()
