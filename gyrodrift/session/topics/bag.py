"""Reference angles in bags of ROS 1 and ROS 2, through the package rosbags."""

from pathlib import Path
from typing import Any

from gyrodrift.session.foreign.columns import WrongValueError
from gyrodrift.session.logs.bag import deserializer, is_ros1, opened_bag
from gyrodrift.session.topics.messages import TYPES, AngleReading, no_such_topic, reading_of
from gyrodrift.values.errors import DataError


def bag_topics(path: Path) -> list[str]:
    """Topics of a bag with a reference angle, each with its type; none of a bag that cannot be read."""
    try:
        with opened_bag(path) as reader:
            return _listed(reader)
    except DataError:  # the reader of the samples reports it
        return []


def bag_readings(path: Path, topic: str, joint: str) -> tuple[str, list[AngleReading]]:
    """Type of the messages on a topic, and their readings.

    Raises
    ------
    DataError
        The bag is damaged, or the topic has no reference angle.
    """
    with opened_bag(path) as reader:
        chosen = _chosen(path, reader, topic)
        kind, decode = chosen[0].msgtype, deserializer(is_ros1=is_ros1(path))
        try:
            return kind, [
                reading_of(decode(bytes(payload), kind), kind, joint, log_ns)
                for _, log_ns, payload in reader.messages(connections=chosen)
            ]
        except WrongValueError as error:
            raise DataError(f"{path}: {topic}: a message {error}") from error


def _chosen(path: Path, reader: Any, topic: str) -> list[Any]:
    """Connections of the topic, which have one type."""
    chosen = [connection for connection in _with_angle(reader) if connection.topic == topic]
    if len({connection.msgtype for connection in chosen}) != 1:
        raise no_such_topic(path, topic, _listed(reader))
    return chosen


def _listed(reader: Any) -> list[str]:
    return sorted({f"{connection.topic} ({connection.msgtype})" for connection in _with_angle(reader)})


def _with_angle(reader: Any) -> list[Any]:
    """Connections with a type that has a reference angle."""
    return [connection for connection in reader.connections if connection.msgtype in TYPES]
