"""Walking through the records of an MCAP file without chunks, samples a table at a time, in bounded memory."""

import os
import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from io import BytesIO
from typing import IO, NamedTuple, TypeVar

import numpy as np
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.records import Channel, Header, McapRecord, Metadata, Schema
from numpy.typing import NDArray

from gyrodrift.public_yaml import public_yaml
from gyrodrift.secret import without_secrets
from gyrodrift.session.mcap.layout import HEAD, MAGIC, MESSAGE_LENGTH, MESSAGE_OPCODE, SAMPLES
from gyrodrift.system import read_at

CONFIG_TABLE = "config"
"""Metadata of a recording with the text of the config."""

BLOCK_BYTES = 1 << 22
ZEROS_BLOCK_BYTES = 1 << 16
FIRST_LOOK_ROWS = 16

MOST_BODY_BYTES = 1 << 28
"""Of a record that is read whole; ours have less than a megabyte, and a file of holes may claim any length."""

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
"""A sample as it stands in the file; the same bytes as `layout.MESSAGE`."""

Rows = NDArray[np.void]
ROW_START = HEAD.pack(MESSAGE_OPCODE, MESSAGE_LENGTH) + SAMPLES.channel_id.to_bytes(2, "little")
R = TypeVar("R", bound=McapRecord)


@dataclass(frozen=True, slots=True)
class SampleRows:
    """Samples that stand one behind the other, shape (n,) of `ROW`; only good until the next step of the walk."""

    at: int
    rows: Rows


@dataclass(frozen=True, slots=True)
class PlacedRecord:
    """Any other record: where it begins in the file, its opcode, and how many bytes follow its head."""

    at: int
    opcode: int
    length: int


class ByteStretch(NamedTuple):
    """Bytes of a file that are whole records: from one place to before another, and how many samples came before."""

    start: int
    stop: int
    first_sample: int = 0


class Walk:
    """Iterates over tables of samples and other records, from the beginning to the first thing that is not whole.

    Where stretches are given, over those, each to the first thing in it that is not whole.

    `end` is then the place behind the last whole record. After a power cut a file may have its length, and zeros
    where its last bytes should be: from `zeros_at` on there is nothing else, and what reaches into them is not whole.
    """

    def __init__(self, file: IO[bytes], stretches: Sequence[ByteStretch] | None = None) -> None:
        self.size = os.fstat(file.fileno()).st_size
        self.end = len(MAGIC)
        self.stretch = ByteStretch(0, self.size)
        self.zeros_at = _zeros_at(file, self.size)
        self._stretches = [self.stretch] if stretches is None else stretches
        self._file = file
        self.fd = file.fileno()

    def __iter__(self) -> Iterator[SampleRows | PlacedRecord]:
        for stretch in self._stretches:
            self.stretch, self.end = stretch, max(stretch.start, len(MAGIC))
            yield from self._steps(stretch.stop)

    def _steps(self, stop: int) -> Iterator[SampleRows | PlacedRecord]:
        while True:
            start = self.end
            block = read_at(self._file.fileno(), max(0, min(BLOCK_BYTES, stop - start)), start)
            at = 0
            while (step := self._step(block, at)) is not None:
                at = self.end - start
                yield step
                if at >= len(block):
                    break
            if self.end == start:
                return

    def body(self, record: PlacedRecord) -> bytes:
        """The bytes of a record behind its head.

        Raises
        ------
        BrokenRecordError
            Where there are more than anybody would write.
        """
        if record.length > MOST_BODY_BYTES:
            raise BrokenRecordError(f"the record at byte {record.at} has {record.length} bytes")
        return read_at(self._file.fileno(), record.length, record.at + HEAD.size)

    def _step(self, block: bytes, at: int) -> SampleRows | PlacedRecord | None:
        """The next thing in the block, with `end` moved behind it; None where the block has nothing whole any more."""
        if len(block) - at < HEAD.size + 2:
            return None
        place = self.end
        if block.startswith(ROW_START, at):
            rows = np.frombuffer(block, ROW, (len(block) - at) // ROW.itemsize, at)
            run = _run(rows)
            if run and not self._is_whole(place + run * ROW.itemsize):
                run -= 1
            if not run:
                return None
            self.end += run * ROW.itemsize
            return SampleRows(place, rows[:run])
        opcode, length = HEAD.unpack_from(block, at)
        if not opcode or not self._is_whole(place + HEAD.size + length):
            return None
        self.end += HEAD.size + length
        return PlacedRecord(place, opcode, length)

    def _is_whole(self, end: int) -> bool:
        """Whether a record that ends there was written to its end."""
        return end <= min(self.zeros_at, self.stretch.stop) or end == self.size == self.stretch.stop


def data_blocks(file: IO[bytes], start: int, end: int, overlap: int = 0) -> Iterator[tuple[int, bytes]]:
    """What stands between two places and where, without holes; each block begins with the last bytes of the one before.

    `overlap` is how many: something so long, and a byte, is whole in one of them.
    """
    fd = file.fileno()
    while start < end:
        before = os.lseek(fd, 0, os.SEEK_CUR)
        try:
            start = os.lseek(fd, start, os.SEEK_DATA)
        except OSError:  # no data any more
            return
        finally:
            os.lseek(fd, before, os.SEEK_SET)  # where the buffer of the file believes it to be
        block = read_at(fd, min(BLOCK_BYTES, max(0, end - start)), start)
        if not block:
            return
        yield start, block
        start += len(block) if start + len(block) >= end or len(block) <= overlap else len(block) - overlap


def _zeros_at(file: IO[bytes], size: int) -> int:
    """Where the zeros begin that the file ends with; its size where there are none."""
    end = _data_end(file, size)
    while end > 0:
        start = max(0, end - ZEROS_BLOCK_BYTES)
        if rest := read_at(file.fileno(), end - start, start).rstrip(b"\0"):
            return start + len(rest)
        end = start
    return 0


def _data_end(file: IO[bytes], size: int) -> int:
    """Where the hole begins that the file ends with, which need not be read; its size where there is none."""
    fd, place, hole = file.fileno(), 0, size
    before = os.lseek(fd, 0, os.SEEK_CUR)
    try:
        while (hole := os.lseek(fd, place, os.SEEK_HOLE)) < size:
            place = os.lseek(fd, hole, os.SEEK_DATA)
    except OSError:  # no data behind it, or a disk that knows of no holes
        return hole if place <= hole < size else size
    finally:
        os.lseek(fd, before, os.SEEK_SET)
    return size


def _run(rows: Rows) -> int:
    """How many rows there are before something else; what is looked at grows with what was found.

    Samples and reads of the link may take turns: a look at all that is left, for each of them, would never end.
    """
    run, looked_at = 0, FIRST_LOOK_ROWS
    while run < len(rows):
        part = rows[run : run + looked_at]
        found = _run_length(part)
        run += found
        if found < len(part):
            break
        looked_at *= 2
    return run


def _run_length(rows: Rows) -> int:
    is_row = rows["opcode"] == MESSAGE_OPCODE
    is_row &= rows["length"] == MESSAGE_LENGTH
    is_row &= rows["channel"] == SAMPLES.channel_id
    return len(rows) if is_row.all() else int(is_row.argmin())


class BrokenRecordError(Exception):
    """A record whose inside does not fit its length."""


def header_of(body: bytes) -> Header:
    """The header record."""
    return _read(Header, body)


def schema_of(body: bytes) -> Schema:
    """A schema record."""
    return _read(Schema, body)


def channel_of(body: bytes) -> Channel:
    """A channel record."""
    return _read(Channel, body)


def metadata_of(body: bytes) -> Metadata:
    """A metadata record, without the secrets that older versions kept with a config."""
    found = _read(Metadata, body)
    public = public_yaml if found.name == CONFIG_TABLE else without_secrets
    return Metadata(found.name, {key: public(text) for key, text in found.metadata.items()})


def _read(kind: type[R], body: bytes) -> R:
    try:
        record: R = kind.read(ReadDataStream(BytesIO(body)))  # type: ignore[attr-defined]  # each kind has its own
    except (McapError, ValueError, struct.error) as error:
        raise BrokenRecordError(f"a record {kind.__name__} is damaged") from error
    return record
