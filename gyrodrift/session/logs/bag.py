"""Bags of ROS 1 (.bag) and ROS 2 (a folder with .db3 files): `sensor_msgs/Imu` through the package rosbags."""

from collections.abc import Iterator
from math import degrees
from pathlib import Path
from typing import Any

import numpy as np

from gyrodrift.errors import DataError
from gyrodrift.sample import Sample
from gyrodrift.session.foreign.columns import NS_PER_S, Decode, WrongValueError
from gyrodrift.session.foreign.read import running_clock
from gyrodrift.session.foreign.ros1 import ros1_imu_sample
from gyrodrift.session.logs.missing import packages_of
from gyrodrift.session.session import Session

IMU = "sensor_msgs/msg/Imu"
ROS1_MAGIC = b"#ROSBAG V"


def read_bag(path: Path, topic: str | None = None) -> Session:
    """Load a bag: the rates about z of its `sensor_msgs/Imu`.

    Parameters
    ----------
    path
        `.bag`, a folder of a bag, or a `.db3` in one.
    topic
        Which topic; without it the only one with such messages.

    Raises
    ------
    DataError
        Where it is no bag or damaged, no topic or more than one could be meant, or `rosbags` is missing.
    """
    place = path.parent if path.suffix.lower() == ".db3" else path
    if path.suffix.lower() == ".db3" and not (place / "metadata.yaml").is_file():
        raise DataError(f"{path}: there is no metadata.yaml beside it; give the folder of the bag as ros2 bag wrote it")
    try:
        with _reader_of(path, place) as reader:
            decode = ros1_imu_sample if path.suffix.lower() == ".bag" else _ros2_decode()
            rows = list(_samples(reader, _chosen(path, reader, topic), decode))
    except DataError:
        raise
    except MemoryError as error:
        raise DataError(f"{path}: needs more memory than there is") from error
    except Exception as error:  # bytes from anywhere
        raise DataError(f"{path}: is no bag, or damaged: {error}") from error
    if not rows:
        raise DataError(f"{path}: has no samples")
    table = np.array([(row.t_device_s, row.t_host_s, row.rate_dps) for row in rows])
    t_s, remarks = running_clock(table[:, 0], table[:, 1])
    return Session(
        path.stem, t_s, table[:, 2].copy(), t_host_s=table[:, 1].copy(), remarks=remarks, rate_scale=degrees(1.0)
    )


def _check_beginning(path: Path) -> None:
    """See that a bag of ROS 1 begins as one: its reader looks for the end of the first line in all of the file."""
    if path.suffix.lower() != ".bag":
        return
    with path.open("rb") as file:
        if file.read(len(ROS1_MAGIC)) != ROS1_MAGIC:
            raise DataError(f"{path}: is no bag of ROS 1: it does not begin with {ROS1_MAGIC.decode()}")


def _reader_of(path: Path, place: Path) -> Any:
    """A reader that leaves the message definitions of a bag unparsed: text from anywhere, of any length."""
    with packages_of(path, "ros"):
        from rosbags import rosbag1, rosbag2  # noqa: PLC0415 - an extra that few have
    _check_beginning(path)
    return rosbag1.Reader(place) if path.suffix.lower() == ".bag" else rosbag2.Reader(place)


def _chosen(path: Path, reader: Any, topic: str | None) -> list[Any]:
    """The connections to read."""
    imus = sorted({each.topic for each in reader.connections if each.msgtype == IMU and each.msgcount})
    there = ", ".join(sorted(f"{each.topic} ({each.msgtype})" for each in reader.connections)) or "nothing"
    if topic is not None and topic not in imus:
        raise DataError(f"{path}: {topic} holds no {IMU}; there are {there}")
    if not imus:
        raise DataError(f"{path}: no topic holds {IMU}; there are {there}")
    if topic is None and len(imus) > 1:
        raise DataError(f"{path}: samples may be on {', '.join(imus)}; choose one with gyrodrift convert --topic")
    wanted = topic or imus[0]
    return [each for each in reader.connections if each.topic == wanted and each.msgtype == IMU]


def _samples(reader: Any, connections: list[Any], decode: Decode) -> Iterator[Sample]:
    for _, log_ns, payload in reader.messages(connections=connections):
        yield decode(bytes(payload), log_ns)


def _ros2_decode() -> Decode:
    """What makes samples of messages in CDR, whose layout is the same in every release of ROS 2."""
    from rosbags.typesys import Stores, get_typestore  # noqa: PLC0415 - likewise

    store = get_typestore(Stores.ROS2_HUMBLE)
    return lambda payload, log_ns: _sample(store.deserialize_cdr(payload, IMU), log_ns)


def _sample(message: Any, log_ns: int) -> Sample:
    if message.angular_velocity_covariance[0] == -1.0:
        raise WrongValueError("angular_velocity_covariance begins with -1: it has no rate")
    stamp = message.header.stamp
    t_s = (stamp.sec * NS_PER_S + stamp.nanosec) / NS_PER_S
    return Sample(-1, t_s, log_ns / NS_PER_S, degrees(message.angular_velocity.z))
