"""Writing a session file as the samples come, light enough for the service: no numpy.

Records other than messages are the `mcap` package's.
"""

import json
import struct
import zlib
from collections.abc import Iterable
from hashlib import blake2b
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
from gyrodrift.sample import Sample
from gyrodrift.session.mcap.checksums import ID_BYTES, TABLE_BYTES, ChecksumWriter
from gyrodrift.session.mcap.layout import (
    CDR_LITTLE_ENDIAN,
    EVENTS,
    FOOTER_LENGTH,
    HEAD,
    LATEST_NS,
    MAGIC,
    MESSAGE,
    MESSAGE_LENGTH,
    MESSAGE_OPCODE,
    READ_HEAD,
    READS,
    SAMPLES,
    STILLS,
    Topic,
)

MESSAGE_HEAD = struct.Struct("<BQHIQQ")
MESSAGE_START = struct.Struct("<HIQQ")
"""A message behind its record head, up to its content: channel, sequence, log and publish time in ns."""

CHANNEL = SAMPLES.channel_id
LATEST_S = LATEST_NS * 1e-9


class Stream(Protocol):
    """What a session is written to."""

    def write(self, content: bytes, /) -> Any:
        """Take all of it."""
        ...


class FileSummary:
    """What a file holds, as its end has to tell: worked out while writing, or afterwards while repairing."""

    def __init__(self) -> None:
        self.size = 0
        self.crc = 0
        self.counts: dict[int, int] = {}
        self.first_ns, self.last_ns = LATEST_NS, 0
        self.schemas: list[Schema] = []
        self.channels: list[Channel] = []
        self.metadata: list[MetadataIndex] = []

    def add_bytes(self, content: bytes) -> None:
        """Bytes that stand in the file."""
        self.size += len(content)
        self.crc = zlib.crc32(content, self.crc)

    def add_messages(self, channel_id: int, count: int, first_ns: int, last_ns: int) -> None:
        """Messages of one channel, the earliest and the latest of their log times."""
        self.counts[channel_id] = self.counts.get(channel_id, 0) + count
        self.first_ns, self.last_ns = min(self.first_ns, first_ns), max(self.last_ns, last_ns)

    def end(self) -> bytes:
        """What makes it a whole file: that the data ends, what is in it and where."""
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
            channel_message_counts=self.counts,
            chunk_count=0,
            message_count=count,
            message_start_time=self.first_ns if count else 0,
            message_end_time=self.last_ns,
            metadata_count=len(self.metadata),
            schema_count=len(self.schemas),
        )


class McapWriter:
    """Writes a session to a stream; what is added goes out with the next `flush`.

    Parameters
    ----------
    stream
        Where to write; at its beginning. Whoever opened it closes it.
    metadata
        Named tables of what is worth keeping beside the samples: device, host, config.
    """

    def __init__(self, stream: Stream, metadata: dict[str, dict[str, str]] | None = None) -> None:
        self._stream = stream
        self._contents = FileSummary()
        self._rows = bytearray()  # apart from the rest, so that samples stand in long runs
        self._others = bytearray()
        self._out = bytearray()
        self._still = nan
        begin = MAGIC + encoded(Header("ros2", f"gyrodrift {__version__}")) + self._declared(SAMPLES)
        told = repr(metadata or {}).encode(
            errors="backslashreplace"
        )  # no device knows it: its bytes cannot hold our tables
        self._checksums = ChecksumWriter(blake2b(told, digest_size=ID_BYTES).digest())
        self._write(begin)
        self._write_table()
        self._send()
        for name, table in (metadata or {}).items():
            self.add_metadata(name, table)

    @property
    def count(self) -> int:
        """Samples so far."""
        return self._contents.counts.get(CHANNEL, 0)

    @property
    def size(self) -> int:
        """Bytes so far."""
        return self._contents.size + len(self._rows) + len(self._others)

    def add(self, sample: Sample) -> None:
        """One sample."""
        self.add_all((sample,))

    def add_all(self, samples: Iterable[Sample]) -> None:
        """Samples as they come."""
        pack, rows = MESSAGE.pack, self._rows
        last_host_s, log_ns, count = nan, 0, 0
        for seq, t_device_s, t_host_s, rate_dps, encoder_deg, temp_c, still in samples:
            if still != self._still and not (isnan(still) and isnan(self._still)):
                self.add_still(self.count + count, still, t_host_s)
            if t_host_s != last_host_s:  # what arrived together has one time
                last_host_s, log_ns = t_host_s, to_ns(t_host_s)
                self._contents.add_messages(CHANNEL, 0, log_ns, log_ns)
            device_ns = int(t_device_s * 1e9) if 0.0 <= t_device_s < LATEST_S else to_ns(t_device_s)
            rows += pack(
                MESSAGE_OPCODE,
                MESSAGE_LENGTH,
                CHANNEL,
                seq & 0xFFFFFFFF,
                log_ns,
                device_ns,
                CDR_LITTLE_ENDIAN,
                seq,
                t_device_s,
                t_host_s,
                rate_dps,
                encoder_deg,
                temp_c,
            )
            count += 1
        self._contents.counts[CHANNEL] = self.count + count

    def add_rows(self, rows: bytes, first_ns: int, last_ns: int) -> None:
        """Many samples, packed as `MESSAGE`, with the earliest and the latest of their log times."""
        self._rows += rows
        self._contents.add_messages(CHANNEL, len(rows) // MESSAGE.size, first_ns, last_ns)
        self.flush()

    def add_message(self, topic: Topic, content: bytes, log_ns: int) -> None:
        """A message of another recording, on any channel but that of the samples."""
        self._others += self._message_head(topic, MESSAGE_HEAD.size - HEAD.size + len(content), log_ns)
        self._others += content

    def add_still(self, sample: int, still: float, t_host_s: float) -> None:
        """What is said of rest from a sample on: 1, 0, or NaN where nobody says; nothing where that is no change."""
        if still == self._still or (isnan(still) and isnan(self._still)):
            return
        self._still = still
        text = json.dumps({"sample": sample, "still": None if isnan(still) else still}).encode()
        self._others += self._message_head(STILLS, MESSAGE_HEAD.size - HEAD.size + len(text), to_ns(t_host_s)) + text

    def add_read(self, content: bytes, t_host_s: float) -> None:
        """The bytes that one read of the port gave."""
        head = self._message_head(READS, READ_HEAD.size - HEAD.size + len(content), to_ns(t_host_s))
        self._others += head + struct.pack("<IdI", CDR_LITTLE_ENDIAN, t_host_s, len(content)) + content

    def add_event(self, event: str, t_host_s: float, fields: dict[str, Any]) -> None:
        """Something that happened on the link."""
        text = json.dumps({"event": event, "t_host_s": t_host_s, **fields}, default=str).encode()
        self._others += self._message_head(EVENTS, MESSAGE_HEAD.size - HEAD.size + len(text), to_ns(t_host_s)) + text

    def add_metadata(self, name: str, table: dict[str, str]) -> None:
        """A named table of texts."""
        self.flush()
        record = encoded(Metadata(name, {key: _in_utf_8(text) for key, text in table.items()}))
        self._contents.metadata.append(MetadataIndex(self._contents.size, len(record), name))
        self._write(record)
        self._send()

    def flush(self) -> None:
        """Hand to the stream what has been added."""
        rows = bytes(self._rows)
        self._rows.clear()
        for at in range(0, len(rows), TABLE_BYTES):
            self._write_rows(rows[at : at + TABLE_BYTES])
        if self._others:
            self._write(bytes(self._others))
            self._others.clear()
        if self._checksums.is_due:
            self._write_table()
        self._send()

    def finish(self) -> None:
        """The end that makes it a whole file."""
        self.flush()
        if self._checksums.is_pending:
            self._write_table()
        self._write_table()  # without bytes of its own: each table stands twice
        self._send()
        self._stream.write(self._contents.end())

    def _message_head(self, topic: Topic, length: int, log_ns: int) -> bytes:
        """The head of a message on a channel that is declared when it is first used."""
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

    def _write(self, content: bytes) -> None:
        """Records that are no samples."""
        self._hand_over(content)
        self._checksums.add_records(content)

    def _send(self) -> None:
        if self._out:
            self._stream.write(bytes(self._out))
            self._out.clear()

    def _write_rows(self, rows: bytes) -> None:
        """Samples, as many as a table is about."""
        self._hand_over(rows)
        self._checksums.add_samples(rows)
        if len(rows) == TABLE_BYTES:
            self._write_table()

    def _write_table(self) -> None:
        self._hand_over(self._checksums.table())

    def _hand_over(self, content: bytes) -> None:
        """What belongs together goes out in one piece, with the next `_send`."""
        self._out += content
        self._contents.add_bytes(content)


def _in_utf_8(text: str) -> str:
    r"""A text as MCAP takes it: bytes of an argument that are not UTF-8, which Python keeps, become `\udcff`."""
    return text.encode("utf-8", "backslashreplace").decode()


def encoded(record: McapRecord) -> bytes:
    """A record as it stands in a file."""
    builder = RecordBuilder()
    record.write(builder)
    content: bytes = builder.end()  # type: ignore[no-untyped-call]  # the package leaves it unannotated
    return content


def to_ns(seconds: float) -> int:
    """Whole nanoseconds, inside what a message head can say."""
    return int(min(seconds * 1e9, LATEST_NS)) if 0.0 <= seconds < float("inf") else 0
