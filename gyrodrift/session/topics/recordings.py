"""Topics of a recording with a reference angle: MCAP files, and bags of ROS 1 and ROS 2."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mcap.well_known import MessageEncoding, SchemaEncoding

from gyrodrift.io.installation import packages_of
from gyrodrift.session.foreign.channels import Messages, contents_of
from gyrodrift.session.foreign.columns import WrongValueError
from gyrodrift.session.foreign.read import opened_file
from gyrodrift.session.foreign.records import messages, records
from gyrodrift.session.foreign.ros import fitting, parsed
from gyrodrift.session.logs.bag import deserializer, is_ros1, opened_bag
from gyrodrift.session.topics.messages import TYPES, AngleReading, reading_of, type_of
from gyrodrift.values.errors import DataError

FORMS = {(MessageEncoding.CDR, SchemaEncoding.ROS2), (MessageEncoding.ROS1, SchemaEncoding.ROS1)}
"""Encodings of messages and schemas in MCAP that can be read."""


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
