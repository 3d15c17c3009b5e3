"""Channels of an MCAP file of another program, and the choice of the channel to read."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from mcap.opcode import Opcode
from mcap.records import Channel, Schema
from mcap.well_known import MessageEncoding, SchemaEncoding

from gyrodrift.session.foreign.records import ForeignRecord, message
from gyrodrift.session.foreign.ros import IMU_NAMES, ROS_MESSAGES
from gyrodrift.session.mcap.layout import SAMPLES
from gyrodrift.session.mcap.walk import BrokenRecordError, channel_of, metadata_of, schema_of
from gyrodrift.values.errors import DataError

UNDERSTOOD = (
    "gyrodrift/Sample or sensor_msgs/msg/Imu (ros2msg, cdr; ros1msg, ros1), or json with t_device_s and rate_dps"
)


@dataclass(frozen=True, slots=True)
class Messages:
    """Messages of a channel: topic, form and count."""

    topic: str
    encoding: str
    schema: Schema | None
    count: int

    def __str__(self) -> str:
        schema = f"{self.schema.name}, {self.schema.encoding}" if self.schema else "no schema"
        return f"{self.topic} ({schema}, {self.encoding})"

    @property
    def is_imu(self) -> bool:
        """Whether they are sensor_msgs/Imu, with rates in rad/s."""
        return self.schema is not None and self.schema.name.endswith("/Imu")

    @property
    def is_understood(self) -> bool:
        """Whether their declared form can be read."""
        if self.encoding == MessageEncoding.JSON or self.schema is None:
            return self.encoding == MessageEncoding.JSON
        forms = (self.encoding, self.schema.encoding)
        if forms == (MessageEncoding.ROS1, SchemaEncoding.ROS1):
            return self.schema.name in IMU_NAMES
        return forms == (MessageEncoding.CDR, SchemaEncoding.ROS2) and self.schema.name in ROS_MESSAGES


@dataclass(frozen=True, slots=True)
class ForeignFile:
    """Contents of a file: messages by channel id, metadata by name, and number of attachments."""

    channels: dict[int, Messages]
    metadata: dict[str, dict[str, str]]
    attachments: int = 0


def contents_of(records: Iterable[ForeignRecord], other_counts: Mapping[int, int] | None = None) -> ForeignFile:
    """Collect the declarations of a file, and count its messages.

    Parameters
    ----------
    records
        Records of the file.
    other_counts
        Numbers of messages that are not among the records, by channel.

    Raises
    ------
    BrokenRecordError
        A channel or a schema is not declared.
    """
    schemas: dict[int, Schema] = {}
    channels: dict[int, Channel] = {}
    metadata: dict[str, dict[str, str]] = {}
    counts = Counter(other_counts or {})
    attachments = 0
    for record in records:
        match record.opcode:
            case Opcode.MESSAGE:
                counts[message(record.body).channel_id] += 1
            case Opcode.SCHEMA:
                schema = schema_of(record.body)
                schemas[schema.id] = schema
            case Opcode.CHANNEL:
                channel = channel_of(record.body)
                channels[channel.id] = channel
            case Opcode.METADATA:
                table = metadata_of(record.body)
                metadata[table.name] = table.metadata
            case Opcode.ATTACHMENT:
                attachments += 1
    messages = {key: _declared(key, count, channels, schemas) for key, count in counts.items()}
    return ForeignFile(messages, metadata, attachments)


def _declared(channel_id: int, count: int, channels: dict[int, Channel], schemas: dict[int, Schema]) -> Messages:
    channel = channels.get(channel_id)
    if channel is None:
        raise BrokenRecordError(f"it has messages of channel {channel_id}, which is not declared")
    if channel.schema_id and channel.schema_id not in schemas:
        raise BrokenRecordError(f"{channel.topic} has schema {channel.schema_id}, which is not declared")
    return Messages(channel.topic, channel.message_encoding, schemas.get(channel.schema_id), count)


def chosen_topic(path: Path, channels: Sequence[Messages], topic: str | None) -> str:
    """Topic to read: the given one, else `/gyro`, else the only readable one.

    Raises
    ------
    DataError
        There is none, or more than one.
    """
    listing = ", ".join(sorted(map(str, channels)))
    if not channels:
        raise DataError(f"{path}: has no samples")
    if topic is not None and topic not in {channel.topic for channel in channels}:
        raise DataError(f"{path}: has no messages on {topic}; topics are {listing}")
    understood = {channel.topic for channel in channels if channel.is_understood}
    if not understood or (topic is not None and topic not in understood):
        raise DataError(f"{path}: {topic or 'no channel'} holds samples; expected {UNDERSTOOD}; topics are {listing}")
    if topic is None and len(understood) > 1 and SAMPLES.name not in understood:
        names = ", ".join(sorted(understood))
        raise DataError(f"{path}: samples may be on {names}; choose one with gyrodrift convert --topic")
    return topic or (SAMPLES.name if SAMPLES.name in understood else understood.pop())
