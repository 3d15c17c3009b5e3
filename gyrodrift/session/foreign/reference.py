"""A session with the reference angle of another topic of its recording."""

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from operator import attrgetter
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from mcap.well_known import MessageEncoding, SchemaEncoding

from gyrodrift.io.installation import packages_of
from gyrodrift.session.foreign.channels import Messages, contents_of
from gyrodrift.session.foreign.columns import WrongValueError, number, whole
from gyrodrift.session.foreign.read import opened_file
from gyrodrift.session.foreign.records import messages, records
from gyrodrift.session.foreign.ros import fitting, parsed
from gyrodrift.session.logs.bag import deserializer, is_ros1, opened_bag
from gyrodrift.session.session import Session
from gyrodrift.values.arrays import Floats
from gyrodrift.values.constants import NS_PER_S
from gyrodrift.values.errors import DataError, UsageError
from gyrodrift.values.quaternion import yaw_of

ORIENTATIONS = {
    "nav_msgs/msg/Odometry": attrgetter("pose.pose.orientation"),
    "geometry_msgs/msg/PoseStamped": attrgetter("pose.orientation"),
    "geometry_msgs/msg/PoseWithCovarianceStamped": attrgetter("pose.pose.orientation"),
    "geometry_msgs/msg/TransformStamped": attrgetter("transform.rotation"),
}
"""Quaternion of a message, by its type."""

JOINTS = "sensor_msgs/msg/JointState"

TYPES = (*ORIENTATIONS, JOINTS)
"""Types of messages with a reference angle."""

FORMS = {(MessageEncoding.CDR, SchemaEncoding.ROS2), (MessageEncoding.ROS1, SchemaEncoding.ROS1)}
"""Encodings of messages and schemas in MCAP that can be read."""

LEAST_READINGS = 3
"""Least number of readings that tell the rate at which a reading is moved to its sample."""


class AngleReading(NamedTuple):
    """Reference angle of a message in degrees, with its stamp and the time of logging in s."""

    stamp_s: float
    logged_s: float
    angle_deg: float


def type_of(name: str) -> str:
    """Name of a type in the form of ROS 2; ROS 1 leaves out `msg`."""
    package, _, kind = name.partition("/")
    return name if kind.startswith("msg/") else f"{package}/msg/{kind}"


def reading_of(message: Any, kind: str, joint: str, log_ns: int) -> AngleReading:
    """Reading of a message of one of TYPES.

    joint
        Name of the joint; empty for the only one of a message.

    Raises
    ------
    WrongValueError
        The message has no stamp, no orientation, or no such joint.
    """
    try:
        stamp = message.header.stamp
        sec, nanosec = whole("header.stamp.sec", stamp.sec), whole("header.stamp.nanosec", stamp.nanosec)
        angle_deg = _joint_deg(message, joint) if kind == JOINTS else _heading_deg(ORIENTATIONS[kind](message))
    except (AttributeError, IndexError, TypeError) as error:
        raise WrongValueError(f"does not fit its type {kind}") from error
    return AngleReading((sec * NS_PER_S + nanosec) / NS_PER_S, log_ns / NS_PER_S, angle_deg)


def _heading_deg(quaternion: Any) -> float:
    """Heading of an orientation, degrees: the last of its three turns about z, y and x of the body."""
    x, y, z, w = (number(f"orientation.{name}", getattr(quaternion, name)) for name in "xyzw")
    if not math.hypot(x, y, z, w) > 0.0:
        raise WrongValueError("has no orientation: all parts of its quaternion are 0")
    return yaw_of(w, x, y, z)


def _joint_deg(message: Any, joint: str) -> float:
    names = list(message.name)
    if joint not in names and (joint or len(names) != 1):
        raise WrongValueError(f"has the joints {', '.join(names)}; choose one as TOPIC:JOINT")
    return math.degrees(number("position", float(message.position[names.index(joint) if joint else 0])))


@dataclass(frozen=True, slots=True)
class AngleTopics:
    """Topics of an open recording.

    kinds
        Pairs of a topic and the type of its messages; an empty type for messages without a reference angle.
    messages
        Function of a topic that gives its messages with their times of logging in ns.
    """

    kinds: set[tuple[str, str]]
    messages: Callable[[str], Iterator[tuple[Any, int]]]

    @property
    def listed(self) -> list[str]:
        """Topics with a reference angle, each with its type."""
        return sorted(f"{topic} ({kind})" for topic, kind in self.kinds if kind)


def is_with_topics(path: Path) -> bool:
    """Whether a recording has topics; a table has none."""
    return path.is_dir() or path.suffix.lower() in (".mcap", ".bag", ".db3")


def angle_topics(path: Path) -> list[str]:
    """Topics of a recording with a reference angle, each with its type; none of one that cannot be read."""
    try:
        with _opened(path) as topics:
            return topics.listed
    except DataError:  # the reader of the samples reports it
        return []


def angle_readings(path: Path, topic: str, joint: str) -> tuple[str, list[AngleReading]]:
    """Type of the messages on a topic, and their readings in the order of the file.

    Raises
    ------
    DataError
        The recording is damaged, the topic has no reference angle, or a message is none.
    """
    with _opened(path) as topics:
        kinds = [kind for name, kind in topics.kinds if name == topic]
        if len(kinds) != 1 or not kinds[0]:
            listing = ", ".join(topics.listed) or "none"
            expected = f"expected {', '.join(TYPES)}; topics with one: {listing}"
            raise DataError(f"{path}: {topic} has no reference angle: {expected}")
        try:
            return kinds[0], [reading_of(body, kinds[0], joint, log_ns) for body, log_ns in topics.messages(topic)]
        except WrongValueError as error:
            raise DataError(f"{path}: {topic}: a message {error}") from error


@contextmanager
def _opened(path: Path) -> Iterator[AngleTopics]:
    if path.suffix.lower() == ".mcap":
        with opened_file(path) as file:
            channels = contents_of(records(file)).channels

            def decoded(topic: str) -> Iterator[tuple[Any, int]]:
                chosen = {key: _decoder(path, channel) for key, channel in channels.items() if channel.topic == topic}
                bodies = (body for body in messages(file) if body.channel_id in chosen)
                return ((chosen[body.channel_id](body.payload), body.log_ns) for body in bodies)

            yield AngleTopics({(channel.topic, _kind(channel)) for channel in channels.values()}, decoded)
        return
    with opened_bag(path) as reader:
        connections = [connection for connection in reader.connections if connection.msgtype in TYPES]

        def deserialized(topic: str) -> Iterator[tuple[Any, int]]:
            chosen = [connection for connection in connections if connection.topic == topic]
            kind, decode = chosen[0].msgtype, deserializer(is_ros1=is_ros1(path))
            stored = reader.messages(connections=chosen)
            return ((decode(bytes(payload), kind), log_ns) for _, log_ns, payload in stored)

        yield AngleTopics({(connection.topic, connection.msgtype) for connection in connections}, deserialized)


def _kind(channel: Messages) -> str:
    """Type of a channel with a reference angle; empty for other channels."""
    schema = channel.schema
    if schema is None or (channel.encoding, schema.encoding) not in FORMS:
        return ""
    kind = type_of(schema.name)
    return kind if kind in TYPES else ""


def _decoder(path: Path, channel: Messages) -> Callable[[bytes], Any]:
    schema = channel.schema
    assert schema is not None  # noqa: S101 - its kind is known
    if channel.encoding == MessageEncoding.CDR:
        return parsed(f"{path}: {channel.topic}", schema)
    with packages_of(path, "ros"):
        decode = deserializer(is_ros1=True)
    kind = type_of(schema.name)
    return fitting(lambda payload: decode(payload, kind), kind)


def with_reference(session: Session, path: Path, topic: str) -> Session:
    """A session with the angle of a topic of its recording, in each sample that is the nearest to a reading.

    The angle is moved from the time of the reading to that of the sample, by half a sample at most. Samples without a
    reading have no angle. The stamps of both topics count, or the times of logging if the stamps are of two clocks.
    A table keeps the angle that it has.

    Parameters
    ----------
    session, path
        The session, and the recording that it comes from.
    topic
        Name of the topic, and of a joint behind a colon.

    Raises
    ------
    UsageError
        The recording is a table without an angle, and has no topics.
    DataError
        The topic has no reference angle, or none at the time of the samples.
    """
    if not is_with_topics(path) and session.encoder_deg is None:
        raise UsageError(f"--reference: {path} has no topics; name the angle of a table with --columns")
    if not is_with_topics(path):
        return replace(session, remarks=(*session.remarks, f"it has no topic {topic}: its own angle is the reference"))
    name, _, joint = topic.partition(":")
    kind, readings = angle_readings(path, name, joint)
    if len(readings) < LEAST_READINGS:
        raise DataError(f"{path}: has {len(readings)} messages on {name}; a reference needs {LEAST_READINGS}")
    t_s, remark = _times_of(session, readings)
    t_s, first = np.unique(t_s, return_index=True)
    angle_deg = np.array([reading.angle_deg for reading in readings])[first]
    if kind != JOINTS:  # a heading ends at 180 degrees, and the position of a joint counts its turns
        angle_deg = np.unwrap(angle_deg, period=360.0)
    encoder_deg = at_samples(session.t_device_s, t_s, angle_deg) if len(t_s) >= LEAST_READINGS else np.array([np.nan])
    if not np.isfinite(encoder_deg).any():
        raise DataError(f"{path}: the messages on {name} are not from the time of its samples")
    what = f"its reference angle is that of {topic} ({kind})"
    return replace(session, encoder_deg=encoder_deg, remarks=(*session.remarks, what + remark))


def at_samples(t_s: Floats, read_s: Floats, angle_deg: Floats) -> Floats:
    """(n,) angles at the times of samples, from (k,) rising times of readings; NaN without a reading so near."""
    period_s = float(np.median(np.diff(t_s))) if len(t_s) > 1 else 0.0
    after = np.clip(np.searchsorted(read_s, t_s), 1, len(read_s) - 1)
    nearest = np.where(t_s - read_s[after - 1] < read_s[after] - t_s, after - 1, after)
    since_s = t_s - read_s[nearest]
    moved_deg = angle_deg[nearest] + np.gradient(angle_deg, read_s)[nearest] * since_s
    sample_deg: Floats = np.where(np.abs(since_s) <= 0.5 * period_s, moved_deg, np.nan)
    return sample_deg


def question_of(path: Path) -> str:
    """How to name the reference of a recording: its topics with an angle; empty without any."""
    topics = angle_topics(path) if is_with_topics(path) else []
    return f"choose its reference with --reference TOPIC: {', '.join(topics)}" if topics else ""


def _times_of(session: Session, readings: Sequence[AngleReading]) -> tuple[Floats, str]:
    """Times of the readings by the clock of the samples, s, and a remark if they are not their stamps."""
    stamp_s = np.array([reading.stamp_s for reading in readings])
    if (stamp_s.max() > session.t_device_s[0] and stamp_s.min() < session.t_device_s[-1]) or session.t_host_s is None:
        return stamp_s, ""
    logged_s = np.array([reading.logged_s for reading in readings])
    is_inside = (logged_s >= session.t_host_s[0]) & (logged_s <= session.t_host_s[-1])
    t_s = np.where(is_inside, np.interp(logged_s, session.t_host_s, session.t_device_s), stamp_s)
    return t_s, ", by the times of logging: its stamps are of another clock"
