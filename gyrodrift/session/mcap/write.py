"""Writing of a session file as samples arrive, light enough for the service: without numpy.

The `mcap` package encodes all records except messages.
"""

import json
import struct
import zlib
from collections.abc import Iterable
from math import isnan, nan
from typing import Any, Protocol

from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Channel,
    DataEnd,
    Footer,
    Header,
    McapRecord,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)

from gyrodrift import __version__
from gyrodrift.session.aids import aid_values
from gyrodrift.session.mcap.layout import (
    AIDS,
    CDR_LITTLE_ENDIAN,
    CRC_BYTES,
    EVENTS,
    FOOTER_LENGTH,
    HEAD,
    LATEST_NS,
    LATEST_S,
    LAYOUTS,
    MAGIC,
    MESSAGE_OPCODE,
    READ_HEAD,
    READS,
    SAMPLES,
    STILLS,
    Topic,
    salt_of,
    seal,
)
from gyrodrift.values.aid import Aid
from gyrodrift.values.sample import NO_AXES, NO_YAW, Sample

MESSAGE_HEAD = struct.Struct("<BQHIQQ")

CHANNEL = SAMPLES.channel_id
NOTHING: tuple[float, ...] = ()


class Stream(Protocol):
    """Target of a session file."""

    def write(self, content: bytes, /) -> Any:
        """Write all bytes."""
        ...


class FileSummary:
    """Contents of a file for the records at its end, collected during writing or repair."""

    def __init__(self) -> None:
        self.size = 0
        self.crc = 0
        self.counts: dict[int, int] = {}
        self.first_ns, self.last_ns = LATEST_NS, 0
        self.schemas: list[Schema] = []
        self.channels: list[Channel] = []
        self.metadata: list[MetadataIndex] = []

    def add_bytes(self, content: bytes) -> None:
        """Add bytes of the file."""
        self.size += len(content)
        self.crc = zlib.crc32(content, self.crc)

    def add_messages(self, channel_id: int, count: int, first_ns: int, last_ns: int) -> None:
        """Add messages of a channel, with their earliest and latest log time."""
        self.counts[channel_id] = self.counts.get(channel_id, 0) + count
        self.first_ns, self.last_ns = min(self.first_ns, first_ns), max(self.last_ns, last_ns)

    def end(self) -> bytes:
        """End of the file: end of the data, summary with offsets, and footer."""
        data_end = encoded(DataEnd(self.crc))
        start = self.size + len(data_end)
        groups: list[tuple[Opcode, list[McapRecord]]] = [
            (Opcode.SCHEMA, list(self.schemas)),
            (Opcode.CHANNEL, list(self.channels)),
            (Opcode.STATISTICS, [self._statistics()]),
            (Opcode.METADATA_INDEX, list(self.metadata)),
        ]
        summary = offsets = b""
        for opcode, records in groups:
            group = b"".join(map(encoded, records))
            if group:
                offsets += encoded(SummaryOffset(opcode, start + len(summary), len(group)))
            summary += group
        offsets_start = start + len(summary)
        summary += offsets
        footer_start = HEAD.pack(Opcode.FOOTER, FOOTER_LENGTH) + struct.pack("<QQ", start, offsets_start)
        crc = zlib.crc32(footer_start, zlib.crc32(summary))
        return data_end + summary + encoded(Footer(start, offsets_start, crc)) + MAGIC

    def _statistics(self) -> Statistics:
        count = sum(self.counts.values())
        return Statistics(
            attachment_count=0,
            channel_count=len(self.channels),
            channel_message_counts=dict(sorted(self.counts.items())),
            chunk_count=0,
            message_count=count,
            message_start_time=self.first_ns if count else 0,
            message_end_time=self.last_ns,
            metadata_count=len(self.metadata),
            schema_count=len(self.schemas),
        )


class McapWriter:
    """Writes a session to a stream; the next `flush` writes everything added.

    Parameters
    ----------
    stream
        Stream at its start; the caller closes it.
    metadata
        Named tables beside the samples: device, host, config.
    has_axes
        Whether samples have three axes.
    has_device_yaw
        Whether samples have the result of the device's own filter.
    """

    def __init__(
        self,
        stream: Stream,
        metadata: dict[str, dict[str, str]] | None = None,
        *,
        has_axes: bool = False,
        has_device_yaw: bool = False,
    ) -> None:
        self.has_axes, self.has_device_yaw = has_axes, has_device_yaw
        layout = LAYOUTS[has_axes, has_device_yaw, True]
        self.salt = salt_of(metadata or {})
        self._layout = layout
        self._stream = stream
        self._contents = FileSummary()
        self._rows = bytearray()  # apart from other records, so that samples form long runs
        self._others = bytearray()
        self._out = bytearray()
        self._still = nan
        self._seals = 0
        self._hand_over(MAGIC + encoded(Header("ros2", f"gyrodrift {__version__}")) + self._declared(layout.topic))
        self._seal(bytes(self._out))
        self._send()
        for name, table in (metadata or {}).items():
            self.add_metadata(name, table)

    @property
    def count(self) -> int:
        """Number of samples so far."""
        return self._contents.counts.get(CHANNEL, 0)

    @property
    def size(self) -> int:
        """Number of bytes so far."""
        return self._contents.size + len(self._rows) + len(self._others)

    def add(self, sample: Sample) -> None:
        """Add a sample."""
        self.add_all((sample,))

    def add_all(self, samples: Iterable[Sample]) -> None:
        """Add samples in order; values that the layout of the file does not have are lost."""
        pack, rows, length = self._layout.values.pack, self._rows, self._layout.message.size - HEAD.size
        crc32, salt, number = zlib.crc32, self.salt, self.count
        last_host_s, log_ns = nan, 0
        no_axes, no_yaw = NO_AXES if self.has_axes else NOTHING, NO_YAW if self.has_device_yaw else NOTHING
        for seq, t_device_s, t_host_s, rate_dps, encoder_deg, temp_c, still, inertial, device_yaw, aids in samples:
            if still != self._still and not (isnan(still) and isnan(self._still)):
                self.add_still(number, still, t_host_s)
            for aid in aids:
                self.add_aid(number, aid, t_device_s, t_host_s)
            if t_host_s != last_host_s:  # samples that arrive together have the same time
                last_host_s, log_ns = t_host_s, to_ns(t_host_s)
                self._contents.add_messages(CHANNEL, 0, log_ns, log_ns)
            device_ns = int(t_device_s * 1e9) if 0.0 <= t_device_s < LATEST_S else to_ns(t_device_s)
            values = pack(
                MESSAGE_OPCODE,
                length,
                CHANNEL,
                number & 0xFFFFFFFF,
                log_ns,
                device_ns,
                CDR_LITTLE_ENDIAN,
                seq,
                t_device_s,
                t_host_s,
                rate_dps,
                encoder_deg,
                temp_c,
                *(no_axes and (inertial or no_axes)),
                *(no_yaw and (device_yaw or no_yaw)),
            )
            rows += values + (crc32(values) ^ salt).to_bytes(CRC_BYTES, "little")
            number += 1
        self._contents.counts[CHANNEL] = number

    def add_rows(self, rows: bytes, first_ns: int, last_ns: int) -> None:
        """Add many packed samples, with their earliest and latest log time."""
        self._rows += rows
        self._contents.add_messages(CHANNEL, len(rows) // self._layout.message.size, first_ns, last_ns)
        self.flush()

    def add_message(self, topic: Topic, content: bytes, log_ns: int) -> None:
        """Add a message of another recording, on another channel than the samples."""
        self._others += self._message_head(topic, MESSAGE_HEAD.size - HEAD.size + len(content), log_ns)
        self._others += content

    def add_still(self, sample: int, still: float, t_host_s: float) -> None:
        """Add the rest flag from a sample on, if it changes: 1, 0, or NaN for unknown."""
        if still == self._still or (isnan(still) and isnan(self._still)):
            return
        self._still = still
        text = json.dumps({"sample": sample, "still": None if isnan(still) else still}).encode()
        self._others += self._message_head(STILLS, MESSAGE_HEAD.size - HEAD.size + len(text), to_ns(t_host_s)) + text

    def add_aid(self, sample: int, aid: Aid, t_device_s: float, t_host_s: float) -> None:
        """Add a measurement of a second source that came with a sample; without a time it has that of the sample."""
        timed = aid._replace(t_s=t_device_s) if isnan(aid.t_s) else aid
        text = json.dumps({"sample": sample, **aid_values(timed)}).encode()
        self._others += self._message_head(AIDS, MESSAGE_HEAD.size - HEAD.size + len(text), to_ns(t_host_s)) + text

    def add_read(self, content: bytes, t_host_s: float) -> None:
        """Add the bytes of a read of the port."""
        head = self._message_head(READS, READ_HEAD.size - HEAD.size + len(content), to_ns(t_host_s))
        self._others += head + struct.pack("<IdI", CDR_LITTLE_ENDIAN, t_host_s, len(content)) + content

    def add_event(self, event: str, t_host_s: float, fields: dict[str, Any]) -> None:
        """Add a link event."""
        text = json.dumps({"event": event, "t_host_s": t_host_s, **fields}, default=str).encode()
        self._others += self._message_head(EVENTS, MESSAGE_HEAD.size - HEAD.size + len(text), to_ns(t_host_s)) + text

    def add_metadata(self, name: str, table: dict[str, str]) -> None:
        """Add a named table of texts."""
        self.flush()
        record = encoded(Metadata(name, {key: _in_utf_8(text) for key, text in table.items()}))
        self._contents.metadata.append(MetadataIndex(self._contents.size, len(record), name))
        self._hand_over(record)
        self._seal(record)
        self._send()

    def flush(self) -> None:
        """Write everything added to the stream.

        Rest flags and second sources come before their samples, for a reader that follows the file.
        """
        if self._others:
            self._hand_over(bytes(self._others))
            self._seal(bytes(self._others))
            self._others.clear()
        self._hand_over(bytes(self._rows))
        self._rows.clear()
        self._send()

    def finish(self) -> None:
        """Write the end of the file."""
        self.flush()
        self._seal(b"")  # with the number of all samples
        self._send()
        self._stream.write(self._contents.end())

    def _message_head(self, topic: Topic, length: int, log_ns: int) -> bytes:
        """Head of a message; the first message of a channel also declares it."""
        sequence = self._contents.counts.get(topic.channel_id, 0)
        declared = b"" if sequence else self._declared(topic)
        self._contents.add_messages(topic.channel_id, 1, log_ns, log_ns)
        head = MESSAGE_HEAD.pack(MESSAGE_OPCODE, length, topic.channel_id, sequence & 0xFFFFFFFF, log_ns, log_ns)
        return declared + head

    def _declared(self, topic: Topic) -> bytes:
        schema = Schema(topic.channel_id, topic.schema_text.encode(), topic.schema_encoding, topic.schema_name)
        channel = Channel(topic.channel_id, topic.name, topic.message_encoding, {}, topic.channel_id)
        self._contents.schemas.append(schema)
        self._contents.channels.append(channel)
        return encoded(schema) + encoded(channel)

    def _seal(self, content: bytes) -> None:
        """Queue the seal of the last bytes."""
        waiting = len(self._rows) // self._layout.message.size
        self._hand_over(seal(self._seals, content, self.count - waiting, self.salt))
        self._seals += 1

    def _hand_over(self, content: bytes) -> None:
        """Queue bytes for the next `_send`, which writes them in one piece."""
        self._out += content
        self._contents.add_bytes(content)

    def _send(self) -> None:
        if self._out:
            self._stream.write(bytes(self._out))
            self._out.clear()


def _in_utf_8(text: str) -> str:
    r"""Text as UTF-8 for MCAP; surrogates of undecodable bytes become text such as `\udcff`."""
    return text.encode("utf-8", "backslashreplace").decode()


def encoded(record: McapRecord) -> bytes:
    """Bytes of a record."""
    builder = RecordBuilder()
    record.write(builder)
    content: bytes = builder.end()  # type: ignore[no-untyped-call]  # the package leaves it unannotated
    return content


def to_ns(seconds: float) -> int:
    """Whole nanoseconds, clipped to the range of a message head."""
    return int(min(seconds * 1e9, LATEST_NS)) if 0.0 <= seconds < float("inf") else 0
