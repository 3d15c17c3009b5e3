"""Iteration over the records of an MCAP file without chunks, in bounded memory; samples come in tables."""

import json
import os
import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from io import BytesIO
from math import nan
from typing import IO, NamedTuple, TypeVar

import numpy as np
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.records import Channel, Header, McapRecord, Metadata, Schema

from gyrodrift.io.public_yaml import public_yaml
from gyrodrift.io.system import read_at
from gyrodrift.session.aids import numbered_aid
from gyrodrift.session.mcap.layout import AIDS, HEAD, MAGIC, MESSAGE_OPCODE, SAMPLES, STILLS
from gyrodrift.session.mcap.rows import ROW_START_BYTES, ROW_STARTS, Rows
from gyrodrift.values.aid import Aid
from gyrodrift.values.secret import without_secrets

CONFIG_TABLE = "config"
"""Name of the metadata table with the text of the config."""

BLOCK_BYTES = 1 << 22
ZEROS_BLOCK_BYTES = 1 << 16
FIRST_LOOK_ROWS = 16

MOST_BODY_BYTES = 1 << 28
"""Longest record that is read whole; a file with holes may claim any length."""

R = TypeVar("R", bound=McapRecord)


@dataclass(frozen=True, slots=True)
class SampleRows:
    """Consecutive samples, shape (n,) of one of `rows.ROW_STARTS`; valid only until the next step of the walk."""

    offset: int
    rows: Rows


@dataclass(frozen=True, slots=True)
class PlacedRecord:
    """Another record: its offset in the file, its opcode, and the number of bytes after its head."""

    offset: int
    opcode: int
    length: int


class ByteStretch(NamedTuple):
    """Whole records from `start` to before `stop`."""

    start: int
    stop: int


class Walk:
    """Iterates over tables of samples and other records, up to the first incomplete record.

    With stretches it iterates over every stretch, up to the first incomplete record in it. Afterwards `end` is the
    offset after the last whole record. After a power cut a file may end in zeros instead of its last bytes: from
    `zeros_at` on there are only zeros. In a stretch up to the end of the file, a record that reaches into them is
    incomplete.
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
            index = 0
            while (step := self._step(block, index)) is not None:
                index = self.end - start
                yield step
                if index >= len(block):
                    break
            if self.end == start:
                return

    def body(self, record: PlacedRecord) -> bytes:
        """Bytes of a record after its head.

        Raises
        ------
        BrokenRecordError
            The record is too long.
        """
        if record.length > MOST_BODY_BYTES:
            raise BrokenRecordError(f"the record at byte {record.offset} has {record.length} bytes")
        return read_at(self._file.fileno(), record.length, record.offset + HEAD.size)

    def _step(self, block: bytes, index: int) -> SampleRows | PlacedRecord | None:
        """Next samples or record of the block, and move `end` after it; None if the rest is incomplete."""
        if len(block) - index < ROW_START_BYTES:
            return None
        offset = self.end
        layout = ROW_STARTS.get(block[index : index + ROW_START_BYTES])
        if layout is not None:
            rows = np.frombuffer(block, layout, (len(block) - index) // layout.itemsize, index)
            run = _run(rows)
            if run and not self._is_whole(offset + run * layout.itemsize):
                run -= 1
            if not run:
                return None
            self.end += run * layout.itemsize
            return SampleRows(offset, rows[:run])
        opcode, length = HEAD.unpack_from(block, index)
        if not opcode or not self._is_whole(offset + HEAD.size + length):
            return None
        self.end += HEAD.size + length
        return PlacedRecord(offset, opcode, length)

    def _is_whole(self, end: int) -> bool:
        """Whether a record that ends there is complete."""
        is_torn = self.zeros_at < end < self.size == self.stretch.stop
        return end <= self.stretch.stop and not is_torn


def data_blocks(file: IO[bytes], start: int, end: int, overlap: int = 0) -> Iterator[tuple[int, bytes]]:
    """Yield offsets and blocks of bytes between two offsets, without holes of the file.

    Blocks overlap by `overlap` bytes, so that anything one byte longer is whole in one of them.
    """
    fd = file.fileno()
    while start < end:
        before = os.lseek(fd, 0, os.SEEK_CUR)
        try:
            start = os.lseek(fd, start, os.SEEK_DATA)
        except OSError:  # no data after it
            return
        finally:
            os.lseek(fd, before, os.SEEK_SET)  # the buffer of the file relies on this position
        block = read_at(fd, min(BLOCK_BYTES, max(0, end - start)), start)
        if not block:
            return
        yield start, block
        start += len(block) if start + len(block) >= end or len(block) <= overlap else len(block) - overlap


def _zeros_at(file: IO[bytes], size: int) -> int:
    """Offset of the zeros at the end of the file; its size without any."""
    end = _data_end(file, size)
    while end > 0:
        start = max(0, end - ZEROS_BLOCK_BYTES)
        if data := read_at(file.fileno(), end - start, start).rstrip(b"\0"):
            return start + len(data)
        end = start
    return 0


def _data_end(file: IO[bytes], size: int) -> int:
    """Offset of the hole at the end of the file, which need not be read; its size without one."""
    fd, position, hole = file.fileno(), 0, size
    before = os.lseek(fd, 0, os.SEEK_CUR)
    try:
        while (hole := os.lseek(fd, position, os.SEEK_HOLE)) < size:
            position = os.lseek(fd, hole, os.SEEK_DATA)
    except OSError:  # no data after it, or a disk without holes
        return hole if position <= hole < size else size
    finally:
        os.lseek(fd, before, os.SEEK_SET)
    return size


def _run(rows: Rows) -> int:
    """Number of sample rows before another record; the examined part doubles as long as all rows are samples.

    Samples and reads of the link may alternate: examining all remaining rows for every sample would be quadratic.
    """
    run, looked_at = 0, FIRST_LOOK_ROWS
    while run < len(rows):
        part = rows[run : run + looked_at]
        count = _run_length(part)
        run += count
        if count < len(part):
            break
        looked_at *= 2
    return run


def _run_length(rows: Rows) -> int:
    is_row = rows["opcode"] == MESSAGE_OPCODE
    is_row &= rows["length"] == rows.dtype.itemsize - HEAD.size
    is_row &= rows["channel"] == SAMPLES.channel_id
    return len(rows) if is_row.all() else int(is_row.argmin())


class BrokenRecordError(Exception):
    """The content of a record does not fit its length."""


def header_of(body: bytes) -> Header:
    """Decode the header record."""
    return _read(Header, body)


def schema_of(body: bytes) -> Schema:
    """Decode a schema record."""
    return _read(Schema, body)


def channel_of(body: bytes) -> Channel:
    """Decode a channel record."""
    return _read(Channel, body)


def still_of(content: bytes) -> tuple[int, float]:
    """Decode a rest flag: the number of the first sample, and 1, 0, or NaN for unknown."""
    try:
        values = json.loads(content)
        return int(values["sample"]), nan if values["still"] is None else float(values["still"])
    except (ValueError, KeyError, TypeError, OverflowError, RecursionError) as error:
        raise BrokenRecordError(f"a message on {STILLS.name} is damaged") from error


def aid_in(content: bytes) -> tuple[int, Aid]:
    """Decode a measurement of a second source: the number of its sample, and the measurement."""
    try:
        return numbered_aid(content)
    except ValueError as error:
        raise BrokenRecordError(f"a message on {AIDS.name} is damaged") from error


def metadata_of(body: bytes) -> Metadata:
    """Decode a metadata record, without the secrets that older versions wrote with a config."""
    table = _read(Metadata, body)
    public = public_yaml if table.name == CONFIG_TABLE else without_secrets
    return Metadata(table.name, {key: public(text) for key, text in table.metadata.items()})


def _read(kind: type[R], body: bytes) -> R:
    try:
        record: R = kind.read(ReadDataStream(BytesIO(body)))  # type: ignore[attr-defined]  # each kind has its own
    except (McapError, ValueError, struct.error) as error:
        raise BrokenRecordError(f"a record {kind.__name__} is damaged") from error
    return record
