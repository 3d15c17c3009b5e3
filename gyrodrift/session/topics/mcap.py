"""Reference angles in MCAP files: CDR messages of ROS 2 with their schema, and messages of ROS 1."""

import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

from mcap.opcode import Opcode
from mcap.records import Schema
from mcap.well_known import MessageEncoding, SchemaEncoding

from gyrodrift.errors import DataError
from gyrodrift.session.foreign.channels import ForeignFile, Messages, contents_of
from gyrodrift.session.foreign.columns import WrongValueError
from gyrodrift.session.foreign.records import DamageError, message, records
from gyrodrift.session.foreign.ros import parsed
from gyrodrift.session.logs.missing import packages_of
from gyrodrift.session.mcap.walk import BrokenRecordError
from gyrodrift.session.topics.messages import TYPES, AngleReading, no_such_topic, reading_of, type_of

FORMS = {(MessageEncoding.CDR, SchemaEncoding.ROS2), (MessageEncoding.ROS1, SchemaEncoding.ROS1)}
"""Encodings of messages and schemas that can be read."""

Decode = Callable[[bytes], Any]


def mcap_topics(path: Path) -> list[str]:
    """Topics of a file with a reference angle, each with its type; none of a file that cannot be read."""
    try:
        with path.open("rb") as file:
            return _listed(contents_of(records(file)))
    except (OSError, DamageError, BrokenRecordError, MemoryError, struct.error):
        return []  # the reader of the samples reports it


def mcap_readings(path: Path, topic: str, joint: str) -> tuple[str, list[AngleReading]]:
    """Type of the messages on a topic, and their readings in the order of the file.

    Raises
    ------
    DataError
        The file is damaged, the topic has no reference angle, or a message is none.
    """
    try:
        with path.open("rb") as file:
            contents = contents_of(records(file))
            chosen = {key: channel for key, channel in contents.channels.items() if channel.topic == topic}
            kinds = {_kind(channel) for channel in chosen.values()}
            if len(kinds) != 1 or "" in kinds:
                raise no_such_topic(path, topic, _listed(contents))
            (kind,) = kinds
            decoders = {key: _decoder(path, channel) for key, channel in chosen.items()}
            bodies = (message(record.body) for record in records(file) if record.opcode == Opcode.MESSAGE)
            readings = [
                _read(f"{path}: {topic}", decoders[body.channel_id], body.payload, kind, joint, body.log_ns)
                for body in bodies
                if body.channel_id in decoders
            ]
    except OSError as error:
        raise DataError(f"{path}: cannot be read: {error.strerror or error}") from error
    except (DamageError, BrokenRecordError) as error:
        raise DataError(f"{path}: is damaged: {error}") from error
    except (MemoryError, struct.error) as error:
        raise DataError(f"{path}: cannot be read: it needs too much memory, or changes while it is read") from error
    return kind, readings


def _read(source: str, decode: Decode, payload: bytes, kind: str, joint: str, log_ns: int) -> AngleReading:
    try:
        try:  # any bytes with any schema
            decoded = decode(payload)
        except Exception as error:
            raise WrongValueError(f"does not fit its schema {kind}") from error
        return reading_of(decoded, kind, joint, log_ns)
    except WrongValueError as error:
        raise DataError(f"{source}: a message {error}") from error


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
    return _ros1_decoder(path, schema)


def _ros1_decoder(path: Path, schema: Schema) -> Decode:
    with packages_of(path, "ros"):
        from rosbags.typesys import Stores, get_typestore  # noqa: PLC0415 - an extra that few have
    store = get_typestore(Stores.ROS1_NOETIC)
    return lambda payload: store.deserialize_ros1(payload, type_of(schema.name))
