"""Closing a session file whose writer was killed: its whole records stay as they are, and the end is added.

Whatever interrupts a repair leaves a file that can be repaired again.
"""

import os
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import IO

from mcap.opcode import Opcode
from mcap.records import MetadataIndex

from gyrodrift.errors import DataError
from gyrodrift.session.mcap.interrupted import is_bare, is_closed, lock
from gyrodrift.session.mcap.layout import HEAD, MAGIC, SAMPLES
from gyrodrift.session.mcap.walk import (
    BrokenRecordError,
    PlacedRecord,
    SampleRows,
    Walk,
    channel_of,
    header_of,
    metadata_of,
    schema_of,
)
from gyrodrift.session.mcap.write import FileSummary

BLOCK_BYTES = 1 << 22
MESSAGE_START = struct.Struct("<HIQ")
LONGEST_RECORD_BYTES = 1 << 20
"""No record of ours is longer; bytes at the end that cannot be one torn record are kept in a file of their own."""


@dataclass(frozen=True, slots=True)
class Repaired:
    """What a repair made of a file.

    samples
        How many it holds.
    cut_bytes
        What stood behind the last whole record.
    tail
        Where those bytes were saved, if they were more than one torn record.
    """

    path: Path
    samples: int
    cut_bytes: int
    tail: Path | None


def repair(path: Path) -> Repaired | None:
    """Close a session file; None where it is closed already.

    Raises
    ------
    DataError
        Where it was not written by gyrodrift, is being written, or cannot be written to.
    """
    try:
        with path.open("r+b") as file:
            lock(path, file)
            return None if is_closed(file) else _close(path, file)
    except OSError as error:
        raise DataError(f"{path}: cannot be repaired: {error.strerror}") from error
    except BrokenRecordError as error:
        raise DataError(f"{path}: cannot be repaired: {error}") from error


def _close(path: Path, file: IO[bytes]) -> Repaired:
    if is_bare(file):
        raise DataError(f"{path}: cannot be repaired: nothing was recorded into it; it can be deleted")
    if file.read(len(MAGIC)) != MAGIC:
        raise DataError(f"{path}: cannot be repaired: it does not begin as an MCAP file")
    walk = Walk(file)
    contents, end = _contents(path, walk)
    contents.size, contents.crc = end, _crc(file, end)
    closing = contents.end()
    tail = _keep_tail(path, file, end, walk, closing)
    file.truncate(end)
    file.seek(end)
    file.write(closing)
    file.flush()
    os.fsync(file.fileno())
    return Repaired(path, contents.counts.get(SAMPLES.channel_id, 0), walk.size - end, tail)


def _contents(path: Path, walk: Walk) -> tuple[FileSummary, int]:
    """What the whole records hold, and where the data ends."""
    contents = FileSummary()
    steps = iter(walk)
    _check_writer(next(steps, None), walk, path)
    for step in steps:
        match step:
            case SampleRows(rows=rows):
                times = rows["log_time"]
                contents.add_messages(SAMPLES.channel_id, len(rows), int(times.min()), int(times.max()))
            case PlacedRecord(opcode=Opcode.DATA_END):
                return contents, step.at
            case PlacedRecord():
                _add(contents, step, walk)
    return contents, walk.end


def _check_writer(first: SampleRows | PlacedRecord | None, walk: Walk, path: Path) -> None:
    """Files of others are laid out in ways that are not known here."""
    match first:
        case PlacedRecord(opcode=Opcode.HEADER):
            if not header_of(walk.body(first)).library.startswith("gyrodrift"):
                raise DataError(f"{path}: cannot be repaired: it was written by another program")
        case _:
            raise DataError(f"{path}: cannot be repaired: it ends before it says which program wrote it")


def _add(contents: FileSummary, record: PlacedRecord, walk: Walk) -> None:
    match record.opcode:
        case Opcode.SCHEMA:
            contents.schemas.append(schema_of(walk.body(record)))
        case Opcode.CHANNEL:
            contents.channels.append(channel_of(walk.body(record)))
        case Opcode.METADATA:
            name = metadata_of(walk.body(record)).name
            contents.metadata.append(MetadataIndex(record.at, HEAD.size + record.length, name))
        case Opcode.MESSAGE:
            if record.length < MESSAGE_START.size:
                raise BrokenRecordError("a message is too short")
            channel_id, _sequence, log_ns = MESSAGE_START.unpack_from(walk.body(record))
            contents.add_messages(channel_id, 1, log_ns, log_ns)


def _keep_tail(path: Path, file: IO[bytes], end: int, walk: Walk, closing: bytes) -> Path | None:
    """Save what stands behind the last whole record, unless it is one torn record or a torn end, zeros behind it."""
    length = min(LONGEST_RECORD_BYTES + HEAD.size + 1, max(0, walk.zeros_at - end))
    tail = os.pread(file.fileno(), length, end)
    if closing.startswith(tail) or _is_torn_record(tail):
        return None
    saved, number = path.with_name(f"{path.name}.tail"), 1
    while os.path.lexists(saved):  # an earlier one, or whatever it is
        number += 1
        saved = path.with_name(f"{path.name}.tail_{number}")
    with saved.open("xb") as copy:
        for at, block in _data_blocks(file, end, walk.size):
            copy.seek(at - end)
            copy.write(block)
        copy.truncate(walk.size - end)
        copy.flush()
        os.fsync(copy.fileno())
    return saved


def _is_torn_record(tail: bytes) -> bool:
    if len(tail) < HEAD.size:
        return True
    opcode, length = HEAD.unpack_from(tail)
    return opcode in frozenset(Opcode) and len(tail) - HEAD.size < length <= LONGEST_RECORD_BYTES


def _crc(file: IO[bytes], end: int) -> int:
    crc = 0
    for block in _blocks(file, 0, end):
        crc = zlib.crc32(block, crc)
    return crc


def _data_blocks(file: IO[bytes], start: int, end: int) -> Iterator[tuple[int, bytes]]:
    """What stands between two places and where, without holes."""
    while start < end:
        before = os.lseek(file.fileno(), 0, os.SEEK_CUR)
        try:
            start = os.lseek(file.fileno(), start, os.SEEK_DATA)
        except OSError:  # no data any more
            return
        finally:
            os.lseek(file.fileno(), before, os.SEEK_SET)  # where the buffer of the file believes it to be
        block = os.pread(file.fileno(), min(BLOCK_BYTES, max(0, end - start)), start)
        if not block:
            return
        yield start, block
        start += len(block)


def _blocks(file: IO[bytes], start: int, end: int) -> Iterator[bytes]:
    while start < end and (block := os.pread(file.fileno(), min(BLOCK_BYTES, end - start), start)):
        yield block
        start += len(block)
