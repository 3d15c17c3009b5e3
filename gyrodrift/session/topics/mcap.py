"""Reference angles in MCAP files: CDR messages of ROS 2 with their schema, and messages of ROS 1."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from mcap.opcode import Opcode
from mcap.well_known import MessageEncoding, SchemaEncoding

from gyrodrift.session.foreign.channels import ForeignFile, Messages, contents_of
from gyrodrift.session.foreign.columns import WrongValueError
from gyrodrift.session.foreign.read import opened_file
from gyrodrift.session.foreign.records import message, records
from gyrodrift.session.foreign.ros import fitting, parsed
from gyrodrift.session.logs.bag import deserializer
from gyrodrift.session.logs.missing import packages_of
from gyrodrift.session.topics.messages import TYPES, AngleReading, no_such_topic, reading_of, type_of
from gyrodrift.values.errors import DataError

FORMS = {(MessageEncoding.CDR, SchemaEncoding.ROS2), (MessageEncoding.ROS1, SchemaEncoding.ROS1)}
"""Encodings of messages and schemas that can be read."""

Decode = Callable[[bytes], Any]


def mcap_topics(path: Path) -> list[str]:
    """Topics of a file with a reference angle, each with its type; none of a file that cannot be read."""
    try:
        with opened_file(path) as file:
            return _listed(contents_of(records(file)))
    except DataError:  # the reader of the samples reports it
        return []


def mcap_readings(path: Path, topic: str, joint: str) -> tuple[str, list[AngleReading]]:
    """Type of the messages on a topic, and their readings in the order of the file.

    Raises
    ------
    DataError
        The file is damaged, the topic has no reference angle, or a message is none.
    """
    with opened_file(path) as file:
        contents = contents_of(records(file))
        chosen = {key: channel for key, channel in contents.channels.items() if channel.topic == topic}
        kinds = {_kind(channel) for channel in chosen.values()}
        if len(kinds) != 1 or "" in kinds:
            raise no_such_topic(path, topic, _listed(contents))
        (kind,) = kinds
        decoders = {key: _decoder(path, channel) for key, channel in chosen.items()}
        bodies = (message(record.body) for record in records(file) if record.opcode == Opcode.MESSAGE)
        try:
            return kind, [
                reading_of(decoders[body.channel_id](body.payload), kind, joint, body.log_ns)
                for body in bodies
                if body.channel_id in decoders
            ]
        except WrongValueError as error:
            raise DataError(f"{path}: {topic}: a message {error}") from error


def _kind(channel: Messages) -> str:
    """Type of a channel with a reference angle; empty for other channels."""
    schema = channel.schema
    if schema is None or (channel.encoding, schema.encoding) not in FORMS:
        return ""
    kind = type_of(schema.name)
    return kind if kind in TYPES else ""


def _listed(contents: ForeignFile) -> list[str]:
    return sorted({f"{channel.topic} ({kind})" for channel in contents.channels.values() if (kind := _kind(channel))})


def _decoder(path: Path, channel: Messages) -> Decode:
    schema = channel.schema
    assert schema is not None  # noqa: S101 - its kind is known
    if channel.encoding == MessageEncoding.CDR:
        return parsed(f"{path}: {channel.topic}", schema)
    with packages_of(path, "ros"):
        decode = deserializer(is_ros1=True)
    kind = type_of(schema.name)
    return fitting(lambda payload: decode(payload, kind), kind)
