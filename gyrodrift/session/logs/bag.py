"""Bags of ROS 1 (.bag) and ROS 2 (a folder with .db3 files): `sensor_msgs/Imu` through the package rosbags."""

from collections.abc import Iterator
from math import degrees
from pathlib import Path
from typing import Any

import numpy as np

from gyrodrift.errors import DataError
from gyrodrift.sample import Sample
from gyrodrift.session.foreign.columns import NS_PER_S, WrongValueError
from gyrodrift.session.foreign.read import running_clock
from gyrodrift.session.foreign.ros1 import ros1_imu_sample
from gyrodrift.session.logs.missing import packages_of
from gyrodrift.session.session import Session

IMU = "sensor_msgs/msg/Imu"


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
    with packages_of(path, "ros"):
        from rosbags.highlevel import AnyReader  # noqa: PLC0415 - an extra that few have
        from rosbags.typesys import Stores, get_typestore  # noqa: PLC0415
    try:
        with AnyReader([place], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as reader:
            rows = list(_samples(reader, _chosen(path, reader, topic)))
    except (DataError, MemoryError):
        raise
    except Exception as error:  # bytes from anywhere
        raise DataError(f"{path}: is no bag, or damaged: {error}") from error
    if not rows:
        raise DataError(f"{path}: has no samples")
    table = np.array([(row.t_device_s, row.t_host_s, row.rate_dps) for row in rows])
    t_s, remarks = running_clock(table[:, 0], table[:, 1])
    return Session(
        path.stem, t_s, table[:, 2].copy(), t_host_s=table[:, 1].copy(), remarks=remarks, rate_scale=degrees(1.0)
    )


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


def _samples(reader: Any, connections: list[Any]) -> Iterator[Sample]:
    for connection, log_ns, payload in reader.messages(connections=connections):
        if reader.is2:
            yield _sample(reader.deserialize(payload, connection.msgtype), log_ns)
        else:
            yield ros1_imu_sample(bytes(payload), log_ns)


def _sample(message: Any, log_ns: int) -> Sample:
    if message.angular_velocity_covariance[0] == -1.0:
        raise WrongValueError("angular_velocity_covariance begins with -1: it has no rate")
    stamp = message.header.stamp
    t_s = (stamp.sec * NS_PER_S + stamp.nanosec) / NS_PER_S
    return Sample(-1, t_s, log_ns / NS_PER_S, degrees(message.angular_velocity.z))
