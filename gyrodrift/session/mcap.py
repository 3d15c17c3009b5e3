"""Sessions in MCAP, without chunks: every flushed sample survives whatever happens to the writer.

A sample is one message of fixed size on `/gyro`, CDR-encoded with the ROS 2 schema `gyrodrift/Sample`. So a file is
read by one look through numpy instead of message by message, finished or not, and a torn tail costs the torn
message alone. Records other than messages are the `mcap` package's.
"""

import mmap
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

import numpy as np
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
from gyrodrift.errors import DataError
from gyrodrift.sample import Sample
from gyrodrift.session.session import Floats, Session

MAGIC = b"\x89MCAP0\r\n"
TOPIC = "/gyro"
SCHEMA_NAME = "gyrodrift/Sample"
SCHEMA_TEXT = """\
# A rate sample of a gyro. Angles are degrees, times seconds; NaN (seq: -1) where the device sends none.
int64 seq             # counter, unwrapped
float64 t_device_s    # the sensor's own clock, unwrapped
float64 t_host_s      # arrival, Unix time
float64 rate_dps      # counter-clockwise positive
float64 encoder_deg   # reference angle
float64 temp_c
"""
SCHEMA_ID = CHANNEL_ID = 1
CHANNEL_BYTES = struct.pack("<H", CHANNEL_ID)

CDR_LITTLE_ENDIAN = 0x00000100
"""The four bytes 00 01 00 00 before the values."""

MESSAGE = struct.Struct("<BQHIQQIqddddd")
MESSAGE_LENGTH = MESSAGE.size - 9
ROW = np.dtype(
    [
        ("opcode", "u1"),
        ("length", "<u8"),
        ("channel", "<u2"),
        ("sequence", "<u4"),
        ("log_time", "<u8"),
        ("publish_time", "<u8"),
        ("cdr", "<u4"),
        ("seq", "<i8"),
        ("t_device_s", "<f8"),
        ("t_host_s", "<f8"),
        ("rate_dps", "<f8"),
        ("encoder_deg", "<f8"),
        ("temp_c", "<f8"),
    ]
)
"""A message record as it stands in the file; the same bytes as `MESSAGE`."""

COLUMNS = ("t_host_s", "encoder_deg", "temp_c")
"""Columns that a session may lack: all NaN then."""

LATEST_NS = 1 << 63


class McapWriter:
    """Writes a session to a stream, sample by sample or chunk by chunk; whoever opened the stream flushes it.

    Parameters
    ----------
    stream
        Where to write; at its beginning.
    metadata
        Named tables of what is worth keeping beside the samples: device, host, config.
    """

    def __init__(self, stream: BinaryIO, metadata: dict[str, dict[str, str]] | None = None) -> None:
        self.count = 0
        self._stream = stream
        self._offset = 0
        self._first_ns, self._last_ns = LATEST_NS, 0
        self._schema = Schema(SCHEMA_ID, SCHEMA_TEXT.encode(), "ros2msg", SCHEMA_NAME)
        self._channel = Channel(CHANNEL_ID, TOPIC, "cdr", {}, SCHEMA_ID)
        self._metadata: list[MetadataIndex] = []
        self._write(MAGIC)
        self._write(_encoded(Header("ros2", f"gyrodrift {__version__}")))
        self._write(_encoded(self._schema))
        self._write(_encoded(self._channel))
        for name, table in (metadata or {}).items():
            self.add_metadata(name, table)

    def add(self, sample: Sample) -> None:
        """One sample, as it comes."""
        seq, t_device_s, t_host_s, rate_dps, encoder_deg, temp_c = sample
        log_ns = _to_ns(t_host_s)
        self._write(
            MESSAGE.pack(
                Opcode.MESSAGE,
                MESSAGE_LENGTH,
                CHANNEL_ID,
                seq & 0xFFFFFFFF,
                log_ns,
                _to_ns(t_device_s),
                CDR_LITTLE_ENDIAN,
                seq,
                t_device_s,
                t_host_s,
                rate_dps,
                encoder_deg,
                temp_c,
            )
        )
        self._counted(1, log_ns, log_ns)

    def add_chunk(self, session: Session) -> None:
        """Many samples at once."""
        rows = np.zeros(len(session.t_device_s), ROW)
        rows["opcode"], rows["length"], rows["channel"] = Opcode.MESSAGE, MESSAGE_LENGTH, CHANNEL_ID
        rows["cdr"] = CDR_LITTLE_ENDIAN
        rows["seq"] = -1 if session.seq is None else session.seq
        rows["sequence"] = rows["seq"] & 0xFFFFFFFF
        rows["t_device_s"], rows["rate_dps"] = session.t_device_s, session.rate_dps
        for name in COLUMNS:
            column = getattr(session, name)
            rows[name] = np.nan if column is None else column
        rows["publish_time"] = _nanoseconds(session.t_device_s)
        rows["log_time"] = rows["publish_time"] if session.t_host_s is None else _nanoseconds(session.t_host_s)
        self._write(rows.tobytes())
        if len(rows):
            self._counted(len(rows), int(rows["log_time"].min()), int(rows["log_time"].max()))

    def add_metadata(self, name: str, table: dict[str, str]) -> None:
        """A named table of texts."""
        record = _encoded(Metadata(name, table))
        self._metadata.append(MetadataIndex(self._offset, len(record), name))
        self._write(record)

    def finish(self) -> None:
        """The end that makes it a whole file: what is in it and where."""
        self._write(_encoded(DataEnd(0)))
        groups: list[tuple[Opcode, list[McapRecord]]] = [
            (Opcode.SCHEMA, [self._schema]),
            (Opcode.CHANNEL, [self._channel]),
            (Opcode.STATISTICS, [self._statistics()]),
            (Opcode.METADATA_INDEX, list(self._metadata)),
        ]
        start = self._offset
        summary = b""
        offsets = b""
        for opcode, records in groups:
            group = b"".join(_encoded(record) for record in records)
            if group:
                offsets += _encoded(SummaryOffset(opcode, start + len(summary), len(group)))
            summary += group
        offsets_start = start + len(summary)
        footer_start = struct.pack("<BQQQ", Opcode.FOOTER, 20, start, offsets_start)
        crc = zlib.crc32(footer_start, zlib.crc32(summary + offsets))
        self._write(summary + offsets + _encoded(Footer(start, offsets_start, crc)) + MAGIC)

    def _statistics(self) -> Statistics:
        return Statistics(
            attachment_count=0,
            channel_count=1,
            channel_message_counts={CHANNEL_ID: self.count} if self.count else {},
            chunk_count=0,
            message_count=self.count,
            message_start_time=self._first_ns if self.count else 0,
            message_end_time=self._last_ns,
            metadata_count=len(self._metadata),
            schema_count=1,
        )

    def _counted(self, count: int, first_ns: int, last_ns: int) -> None:
        self.count += count
        self._first_ns, self._last_ns = min(self._first_ns, first_ns), max(self._last_ns, last_ns)

    def _write(self, content: bytes) -> None:
        self._stream.write(content)
        self._offset += len(content)


def read_mcap(path: Path) -> Session:
    """Load a session that `McapWriter` wrote, finished or torn.

    Raises
    ------
    DataError
        Where it is no MCAP file, has no samples on `/gyro` of our schema, or says something impossible.
    """
    try:
        with path.open("rb") as file:
            if file.read(len(MAGIC)) != MAGIC:
                raise DataError(f"{path}: is no MCAP file: it does not begin as one")
            with mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
                return _session(path, [rows.copy() for rows in _message_runs(path, content)])
    except OSError as error:
        raise DataError(f"{path}: cannot be read: {error.strerror}") from error


def _message_runs(path: Path, content: mmap.mmap) -> Iterator[np.ndarray[tuple[int], np.dtype[np.void]]]:
    """Each unbroken run of samples; other records are stepped over, and the first torn one is the end."""
    at = len(MAGIC)
    has_schema = False
    while at + 9 <= len(content):
        opcode, length = struct.unpack_from("<BQ", content, at)
        body = at + 9
        if opcode in (Opcode.FOOTER, Opcode.DATA_END) or body + length > len(content):
            return
        if opcode == Opcode.CHUNK:
            raise DataError(f"{path}: is chunked, as other programs write MCAP; convert it without chunks first")
        if opcode == Opcode.SCHEMA:
            has_schema = has_schema or SCHEMA_NAME.encode() in content[body : body + 64]
        if opcode == Opcode.MESSAGE and length == MESSAGE_LENGTH and content[body : body + 2] == CHANNEL_BYTES:
            if not has_schema:
                raise DataError(f"{path}: has messages before a schema {SCHEMA_NAME}; this is no session of gyrodrift")
            rows = np.frombuffer(content, ROW, (len(content) - at) // ROW.itemsize, at)
            is_row = (rows["opcode"] == Opcode.MESSAGE) & (rows["length"] == MESSAGE_LENGTH)
            is_row &= rows["channel"] == CHANNEL_ID
            run = len(rows) if is_row.all() else int(is_row.argmin())
            yield rows[:run]
            at += run * ROW.itemsize
            del rows, is_row
        else:
            at = body + length


def _session(path: Path, runs: "list[np.ndarray[tuple[int], np.dtype[np.void]]]") -> Session:
    if not runs:
        raise DataError(f"{path}: has no samples")
    rows = np.concatenate(runs) if len(runs) > 1 else runs[0]
    columns: dict[str, Floats] = {
        name: np.ascontiguousarray(rows[name]) for name in ("t_device_s", "rate_dps", *COLUMNS)
    }
    seq = np.ascontiguousarray(rows["seq"])
    return Session(
        name=path.stem,
        t_device_s=columns["t_device_s"],
        rate_dps=columns["rate_dps"],
        seq=None if (seq < 0).all() else seq,
        **{name: None if np.isnan(columns[name]).all() else columns[name] for name in COLUMNS},
    )


def _encoded(record: McapRecord) -> bytes:
    builder = RecordBuilder()
    record.write(builder)
    content: bytes = builder.end()  # type: ignore[no-untyped-call]  # the package leaves it unannotated
    return content


def _to_ns(seconds: float) -> int:
    return int(min(seconds * 1e9, LATEST_NS)) if 0.0 <= seconds < float("inf") else 0


def _nanoseconds(seconds: Floats) -> np.ndarray[tuple[int], np.dtype[np.uint64]]:
    finite = np.where(np.isfinite(seconds), seconds, 0.0)
    return np.clip(finite * 1e9, 0, LATEST_NS).astype(np.uint64)
