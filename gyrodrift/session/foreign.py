"""Sessions in MCAP files that others wrote: chunked or not, compressed or not, finished or torn.

Three kinds of messages are understood: `gyrodrift/Sample` and `sensor_msgs/msg/Imu` in CDR with a ros2msg schema, and
JSON objects with the column names of a session. Records are framed here, because no length in a file is to be believed
before it is held against the size of the file; what stands in them is decoded by the public packages.
"""

import json
import math
import os
import reprlib
import struct
import zlib
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import redirect_stderr
from dataclasses import dataclass
from io import BytesIO, StringIO
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

import lz4.frame  # type: ignore[import-untyped]  # ships no type information
import numpy as np
import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, Schema
from mcap.well_known import MessageEncoding, SchemaEncoding

from gyrodrift.errors import DataError
from gyrodrift.sample import Sample
from gyrodrift.session.csv import REQUIRED
from gyrodrift.session.layout import HEAD, MAGIC, SAMPLES
from gyrodrift.session.session import Floats, Session
from gyrodrift.session.walk import BrokenRecordError, channel_of, metadata_of, schema_of

RECORD_LIMIT_BYTES = 1 << 30
"""The largest record and the largest opened chunk that is believed; recorders write chunks of some megabytes."""

MESSAGE_HEAD = struct.Struct("<HIQQ")
"""What a message begins with: channel, sequence, log and publish time in ns."""

ROW = np.dtype([(name, "i8" if name == "seq" else "f8") for name in Sample._fields])
NS_PER_S = 1_000_000_000
UNDERSTOOD = "gyrodrift/Sample or sensor_msgs/msg/Imu (ros2msg, cdr), or json with t_device_s and rate_dps"

Decode = Callable[[bytes, int], Sample]
"""From the bytes of a message and its log time in ns to a sample."""


class DamageError(Exception):
    """Something in the file contradicts itself."""


class WrongValueError(Exception):
    """A message that is whole and cannot be a sample."""


def read_foreign(path: Path, topic: str | None = None) -> Session:
    """Load a session from any MCAP file, samples in the order of the file.

    A file that was cut off gives every whole message before the cut.

    Parameters
    ----------
    path
        The file.
    topic
        Which channel to read; without it `/gyro`, or else the only one that is understood.

    Raises
    ------
    DataError
        Where it is no MCAP file or damaged, where no channel or more than one could be meant, or where a message lacks
        what a sample needs.
    """
    try:
        with path.open("rb") as file:
            return _session(path, file, topic)
    except OSError as error:
        raise DataError(f"{path}: cannot be read: {error.strerror or error}") from error
    except (DamageError, BrokenRecordError) as error:
        raise DataError(f"{path}: is damaged: {error}") from error
    except (MemoryError, struct.error) as error:
        raise DataError(f"{path}: cannot be read: it is larger than memory, or changes while it is read") from error


def _session(path: Path, file: BinaryIO, topic: str | None) -> Session:
    if file.read(len(MAGIC)) != MAGIC:
        raise DataError(f"{path}: is no MCAP file: it does not begin as one")
    contents = _contents(_records(file))
    chosen = _chosen(path, list(contents.channels.values()), topic)
    decoders = {
        channel_id: _decoder(path, channel)
        for channel_id, channel in contents.channels.items()
        if channel.topic == chosen and channel.is_understood
    }
    rows = np.fromiter(_samples(f"{path}: {chosen}", _records(file), decoders), ROW)
    return Session(
        name=path.stem,
        t_device_s=rows["t_device_s"].copy(),
        rate_dps=rows["rate_dps"].copy(),
        t_host_s=_column(rows["t_host_s"]),
        seq=None if (rows["seq"] < 0).all() else rows["seq"].copy(),
        encoder_deg=_column(rows["encoder_deg"]),
        temp_c=_column(rows["temp_c"]),
        metadata=contents.metadata,
    )


def _column(values: Floats) -> Floats | None:
    return None if np.isnan(values).all() else values.copy()


class _Record(NamedTuple):
    """A record without its head; the body is shorter than it was where the file was cut off in it."""

    opcode: int
    body: bytes
    is_whole: bool


def _records(file: BinaryIO) -> Iterator[_Record]:
    """Every whole record of the data section from its beginning, those in chunks included; sums are checked."""
    size = os.fstat(file.fileno()).st_size
    file.seek(max(0, size - len(MAGIC)))
    is_torn = file.read(len(MAGIC)) != MAGIC
    file.seek(len(MAGIC))
    crc = zlib.crc32(MAGIC)
    for record in _framed(file, size, is_torn=is_torn):
        if record.opcode == Opcode.CHUNK:
            content = _opened(record)
            yield from filter(_is_whole, _framed(BytesIO(content), len(content), is_torn=not record.is_whole))
        elif record.opcode in (Opcode.DATA_END, Opcode.FOOTER):
            _check_end(record, crc)
            return
        elif record.is_whole:
            yield record
        crc = zlib.crc32(record.body, zlib.crc32(HEAD.pack(record.opcode, len(record.body)), crc))


def _is_whole(record: _Record) -> bool:
    return record.is_whole


def _framed(stream: BinaryIO, size: int, *, is_torn: bool) -> Iterator[_Record]:
    """Records one behind the other, up to `size`; only a torn stream may end within one."""
    at = stream.tell()
    while size - at >= HEAD.size:
        opcode, length = HEAD.unpack(stream.read(HEAD.size))
        left = size - at - HEAD.size
        if opcode == 0 and is_torn:  # zeros are what a power cut leaves behind
            return
        if length > RECORD_LIMIT_BYTES or (length > left and not is_torn):
            raise DamageError(f"the record at byte {at} claims to have {length} bytes, {left} are left")
        yield _Record(opcode, stream.read(min(length, left)), length <= left)
        at += HEAD.size + length
    if at < size and not is_torn:
        raise DamageError("it ends within a record")


def _check_end(record: _Record, crc: int) -> None:
    """The end of the data may tell the checksum of all before it; 0 tells none."""
    told = int.from_bytes(record.body[:4], "little")
    if record.opcode == Opcode.DATA_END and record.is_whole and told not in (0, crc):
        raise DamageError("the checksum of its data is wrong")


def _opened(record: _Record) -> bytes:
    """What is in a chunk; of one that was cut off, as much as can be had."""
    try:
        chunk: Chunk = Chunk.read(ReadDataStream(BytesIO(record.body)))
        content = _inflated(chunk)
    except (McapError, ValueError, OverflowError, MemoryError, struct.error) as error:
        if not record.is_whole:
            return b""
        raise DamageError("a chunk cannot be opened") from error
    except (RuntimeError, zstandard.ZstdError) as error:
        raise DamageError(f"a chunk cannot be opened: {chunk.compression} says no") from error
    if record.is_whole and len(content) != chunk.uncompressed_size:
        raise DamageError(f"a chunk has not the {chunk.uncompressed_size} bytes that it claims")
    if record.is_whole and chunk.uncompressed_crc not in (0, zlib.crc32(content)):
        raise DamageError("the checksum of a chunk is wrong")
    return content


def _inflated(chunk: Chunk) -> bytes:
    """The content of a chunk, never more than a byte beyond what it claims: a few bytes can inflate to anything."""
    if chunk.uncompressed_size > RECORD_LIMIT_BYTES:
        raise DamageError(f"a chunk claims to have {chunk.uncompressed_size} bytes")
    most = chunk.uncompressed_size + 1
    match chunk.compression:
        case "":
            return chunk.data
        case "lz4":
            content: bytes = lz4.frame.LZ4FrameDecompressor().decompress(chunk.data, max_length=most)
            return content
        case "zstd":
            with zstandard.ZstdDecompressor().stream_reader(chunk.data, read_across_frames=True) as reader:
                return reader.read(most)
    raise DamageError(f"a chunk is compressed with {chunk.compression!r}; known are lz4 and zstd")


@dataclass(frozen=True, slots=True)
class _Messages:
    """The messages of one channel: where, in what form, how many."""

    topic: str
    encoding: str
    schema: Schema | None
    count: int

    def __str__(self) -> str:
        schema = f"{self.schema.name}, {self.schema.encoding}" if self.schema else "no schema"
        return f"{self.topic} ({schema}, {self.encoding})"

    @property
    def is_understood(self) -> bool:
        """Whether samples can be made of them, as far as the declaration tells."""
        if self.encoding == MessageEncoding.JSON or self.schema is None:
            return self.encoding == MessageEncoding.JSON
        forms = (self.encoding, self.schema.encoding)
        return forms == (MessageEncoding.CDR, SchemaEncoding.ROS2) and self.schema.name in ROS_MESSAGES


@dataclass(frozen=True, slots=True)
class _Contents:
    """What a file holds: its channels that have messages, by id, and its metadata, by name."""

    channels: dict[int, _Messages]
    metadata: dict[str, dict[str, str]]


def _contents(records: Iterable[_Record]) -> _Contents:
    schemas: dict[int, Schema] = {}
    channels: dict[int, Channel] = {}
    metadata: dict[str, dict[str, str]] = {}
    counts: Counter[int] = Counter()
    for record in records:
        match record.opcode:
            case Opcode.MESSAGE:
                counts[_message(record.body)[0]] += 1
            case Opcode.SCHEMA:
                schema = schema_of(record.body)
                schemas[schema.id] = schema
            case Opcode.CHANNEL:
                channel = channel_of(record.body)
                channels[channel.id] = channel
            case Opcode.METADATA:
                table = metadata_of(record.body)
                metadata[table.name] = table.metadata
    return _Contents({key: _declared(key, count, channels, schemas) for key, count in counts.items()}, metadata)


def _declared(channel_id: int, count: int, channels: dict[int, Channel], schemas: dict[int, Schema]) -> _Messages:
    channel = channels.get(channel_id)
    if channel is None:
        raise DamageError(f"it has messages of a channel {channel_id}, which is nowhere declared")
    if channel.schema_id and channel.schema_id not in schemas:
        raise DamageError(f"{channel.topic} has a schema {channel.schema_id}, which is nowhere declared")
    return _Messages(channel.topic, channel.message_encoding, schemas.get(channel.schema_id), count)


def _message(body: bytes) -> tuple[int, int, bytes]:
    """Channel, log time in ns and payload."""
    if len(body) < MESSAGE_HEAD.size:
        raise DamageError(f"a message has {len(body)} bytes, fewer than its head")
    channel_id, _, log_ns, _ = MESSAGE_HEAD.unpack_from(body)
    return channel_id, log_ns, body[MESSAGE_HEAD.size :]


def _chosen(path: Path, channels: list[_Messages], topic: str | None) -> str:
    """The topic to read."""
    there = ", ".join(sorted(map(str, channels)))
    if not channels:
        raise DataError(f"{path}: has no samples")
    if topic is not None and topic not in {channel.topic for channel in channels}:
        raise DataError(f"{path}: has no messages on {topic}; there are {there}")
    understood = {channel.topic for channel in channels if channel.is_understood}
    if not understood or (topic is not None and topic not in understood):
        raise DataError(f"{path}: {topic or 'no channel'} holds samples; expected {UNDERSTOOD}; there are {there}")
    if topic is None and len(understood) > 1 and SAMPLES.name not in understood:
        names = ", ".join(sorted(understood))
        raise DataError(f"{path}: samples may be on {names}; choose one with gyrodrift convert --topic")
    return topic or (SAMPLES.name if SAMPLES.name in understood else understood.pop())


def _samples(place: str, records: Iterable[_Record], decoders: dict[int, Decode]) -> Iterator[Sample]:
    number = 0
    for record in records:
        if record.opcode != Opcode.MESSAGE:
            continue
        channel_id, log_ns, payload = _message(record.body)
        if channel_id not in decoders:
            continue
        number += 1
        try:
            sample = decoders[channel_id](payload, log_ns)
        except WrongValueError as error:
            raise DataError(f"{place}: message {number} {error}") from error
        yield sample


def _decoder(path: Path, channel: _Messages) -> Decode:
    if channel.encoding == MessageEncoding.JSON or channel.schema is None:
        return _json_sample
    from mcap_ros2.decoder import DecoderFactory  # noqa: PLC0415 - only who reads CDR pays for it

    name = channel.schema.name
    to_sample = ROS_MESSAGES[name]
    try:  # a schema is text from anywhere; its parser names few of its troubles, and prints them all
        with redirect_stderr(StringIO()):
            decode = DecoderFactory().decoder_for(channel.encoding, channel.schema)
    except Exception as error:
        raise DataError(f"{path}: {channel.topic}: the schema {name} cannot be parsed") from error

    def decoded(payload: bytes, log_ns: int) -> Sample:
        try:  # likewise the bytes, by whatever that schema says
            message = decode(payload) if decode else None
        except Exception as error:
            raise WrongValueError(f"does not fit its schema {name}") from error
        return to_sample(message, log_ns)

    return decoded


def _json_sample(payload: bytes, log_ns: int) -> Sample:
    try:
        fields = json.loads(payload)
    except (ValueError, RecursionError) as error:
        raise WrongValueError("is not JSON") from error
    if not isinstance(fields, dict):
        raise WrongValueError(f"is {reprlib.repr(fields)}, expected an object with {' and '.join(REQUIRED)}")
    return _sample(fields, log_ns)


def _own_sample(message: Any, log_ns: int) -> Sample:
    return _sample({name: getattr(message, name) for name in Sample._fields if hasattr(message, name)}, log_ns)


def _imu_sample(message: Any, log_ns: int) -> Sample:
    """The turn about z; what the message cannot hold is missing."""
    try:
        stamp, rate, covariance = message.header.stamp, message.angular_velocity.z, message.angular_velocity_covariance
        parts, first = (stamp.sec, stamp.nanosec), covariance[0]
    except (AttributeError, IndexError, TypeError) as error:
        raise WrongValueError("lacks header.stamp, angular_velocity.z or angular_velocity_covariance") from error
    if first == -1.0:
        raise WrongValueError("has no rate: angular_velocity_covariance begins with -1")
    sec, nanosec = (_whole(f"header.stamp.{name}", part) for name, part in zip(("sec", "nanosec"), parts, strict=True))
    rate_dps = math.degrees(_number("angular_velocity.z", rate))
    return Sample(-1, (sec * NS_PER_S + nanosec) / NS_PER_S, log_ns / NS_PER_S, rate_dps)


ROS_MESSAGES: dict[str, Callable[[Any, int], Sample]] = {
    "gyrodrift/Sample": _own_sample,
    "gyrodrift/msg/Sample": _own_sample,
    "sensor_msgs/Imu": _imu_sample,
    "sensor_msgs/msg/Imu": _imu_sample,
}
"""By the name of the schema, as older and newer writers spell it."""


def _sample(fields: Mapping[str, Any], log_ns: int) -> Sample:
    """A sample from its columns by name; None is a value that is not there."""
    for name in REQUIRED:
        if name not in fields:
            raise WrongValueError(f"has no {name}, which is required")
    seq = fields.get("seq")
    return Sample(
        seq=-1 if seq is None else _whole("seq", seq),
        t_device_s=_number("t_device_s", fields["t_device_s"]),
        t_host_s=_number("t_host_s", fields.get("t_host_s", log_ns / NS_PER_S)),
        rate_dps=_number("rate_dps", fields["rate_dps"]),
        encoder_deg=_number("encoder_deg", fields.get("encoder_deg")),
        temp_c=_number("temp_c", fields.get("temp_c")),
    )


def _number(name: str, value: Any) -> float:
    if value is None:
        return math.nan
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise WrongValueError(f"has {reprlib.repr(value)} as {name}, expected a number")
    try:
        return float(value)
    except OverflowError:
        raise WrongValueError(f"has a number as {name} that no float can hold") from None


def _whole(name: str, value: Any) -> int:
    number = _number(name, value)
    if math.isnan(number):
        return -1
    if not number.is_integer() or not -(2**63) <= int(value) < 2**63:
        raise WrongValueError(f"has {reprlib.repr(value)} as {name}, expected a whole number of 64 bits")
    return int(value)
