"""Repair of a session file whose writer was killed: whole records stay, and the end is added.

After an interrupted repair the file can be repaired again. For a damaged file, `rebuild` writes a new one.
"""

import os
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import IO

from mcap.opcode import Opcode
from mcap.records import MetadataIndex

from gyrodrift.io.files import UnreadableError, check_ordinary
from gyrodrift.io.system import read_at
from gyrodrift.session.damage import DamagedError, RecordingDamage
from gyrodrift.session.mcap.checksums import ChecksumWriter
from gyrodrift.session.mcap.ending import crc_of
from gyrodrift.session.mcap.interrupted import is_bare, is_closed, lock
from gyrodrift.session.mcap.layout import HEAD, MAGIC, SAMPLES
from gyrodrift.session.mcap.structure import LONGEST_RECORD_BYTES, is_torn_record
from gyrodrift.session.mcap.survey import survey
from gyrodrift.session.mcap.surveyed import Survey
from gyrodrift.session.mcap.tail import keep_tail
from gyrodrift.session.mcap.walk import (
    BrokenRecordError,
    ByteStretch,
    PlacedRecord,
    SampleRows,
    Walk,
    channel_of,
    header_of,
    metadata_of,
    schema_of,
)
from gyrodrift.session.mcap.write import FileSummary
from gyrodrift.values.errors import DataError

BLOCK_BYTES = 1 << 22
MESSAGE_START = struct.Struct("<HIQ")


@dataclass(frozen=True, slots=True)
class Repaired:
    """Result of a repair.

    samples
        Number of samples in the file.
    cut_bytes
        Bytes removed after the last whole record.
    tail
        File with these bytes, if they were more than one torn record.
    damage
        Losses, if the file was damaged; the damaged file is then `kept`.
    """

    path: Path
    samples: int
    cut_bytes: int
    tail: Path | None
    damage: RecordingDamage | None = None
    kept: Path | None = None


def repair(path: Path, *, rebuilds: bool = True) -> Repaired | None:
    """Close a session file, or replace a damaged one by a whole file; None if it is whole already.

    Raises
    ------
    DamagedError
        It is damaged and `rebuilds` is false.
    DataError
        It was not written by gyrodrift, is being written, or cannot be written to.
    """
    try:
        check_ordinary(path)
        with path.open("r+b") as file:
            lock(path, file)
            file_survey = _own_survey(path, file)
            if not file_survey.has_inner_damage:
                return None if is_closed(file) else _close(path, file, file_survey)
            if not file_survey.is_ours:
                _check_writer(next(iter(Walk(file)), None), Walk(file), path)
            return _rebuilt(path, file, file_survey, rebuilds=rebuilds)
    except OSError as error:
        raise DataError(f"{path}: cannot be repaired: {error.strerror}") from error
    except (BrokenRecordError, UnreadableError) as error:
        raise DataError(f"{path}: cannot be repaired: {error}") from error


def _own_survey(path: Path, file: IO[bytes]) -> Survey:
    """Survey of a file that this program wrote or may have written."""
    if is_bare(file):
        raise DataError(f"{path}: cannot be repaired: nothing was recorded into it; it can be deleted")
    file_survey = survey(file)
    if not file_survey.is_ours and read_at(file.fileno(), len(MAGIC), 0) != MAGIC:
        raise DataError(f"{path}: cannot be repaired: it does not begin as an MCAP file")
    return file_survey


def _rebuilt(path: Path, file: IO[bytes], file_survey: Survey, *, rebuilds: bool) -> Repaired:
    from gyrodrift.session.mcap.read import read_mcap  # noqa: PLC0415 - only for damaged files
    from gyrodrift.session.mcap.rebuild import rebuild

    damage = read_mcap(path, allow_damage=True).damage
    if damage is None:
        raise DataError(f"{path}: cannot be repaired: it changes while it is read")
    if not rebuilds:
        raise DamagedError([(path, damage)])
    return Repaired(path, damage.kept, 0, None, damage, rebuild(path, file, file_survey, damage))


def _close(path: Path, file: IO[bytes], file_survey: Survey) -> Repaired:
    walk = Walk(file)
    contents, end = _contents(path, walk)
    contents.size, contents.crc = end, crc_of(file, 0, end)
    tables = _last_tables(file, file_survey, end)
    contents.add_bytes(tables)
    closing = tables + contents.end()
    tail = _keep_tail(path, file, end, walk, closing)
    file.truncate(end)
    file.seek(end)
    file.write(closing)
    file.flush()
    os.fsync(file.fileno())
    return Repaired(path, contents.counts.get(SAMPLES.channel_id, 0), walk.size - end, tail)


def _last_tables(file: IO[bytes], file_survey: Survey, end: int) -> bytes:
    """Checksum tables for the bytes after the last table, and the repetition of the last one."""
    if file_survey.last_table is None:
        return b""
    offset, table = file_survey.last_table.offset, file_survey.last_table.table
    writer = ChecksumWriter.after(table)
    for step in Walk(file, [ByteStretch(offset + table.size, end)]):
        match step:
            case SampleRows(rows=rows):
                writer.add_samples(rows.tobytes(), rows.dtype.itemsize)
            case PlacedRecord(offset=start, length=length):
                writer.add_records(read_at(file.fileno(), HEAD.size + length, start))
    tables = writer.table() if writer.is_pending else b""
    return tables + writer.table() if tables or table.region.pieces else b""


def _contents(path: Path, walk: Walk) -> tuple[FileSummary, int]:
    """Summary of the whole records, and the offset of their end."""
    contents = FileSummary()
    steps = iter(walk)
    _check_writer(next(steps, None), walk, path)
    for step in steps:
        match step:
            case SampleRows(rows=rows):
                times = rows["log_time"]
                contents.add_messages(SAMPLES.channel_id, len(rows), int(times.min()), int(times.max()))
            case PlacedRecord(opcode=Opcode.DATA_END):
                return contents, step.offset
            case PlacedRecord():
                _add(contents, step, walk)
    return contents, walk.end


def _check_writer(first: SampleRows | PlacedRecord | None, walk: Walk, path: Path) -> None:
    """Check that gyrodrift wrote the file; other programs use other layouts."""
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
            contents.metadata.append(MetadataIndex(record.offset, HEAD.size + record.length, name))
        case Opcode.MESSAGE:
            if record.length < MESSAGE_START.size:
                raise BrokenRecordError("a message is too short")
            channel_id, _sequence, log_ns = MESSAGE_START.unpack_from(walk.body(record))
            contents.add_messages(channel_id, 1, log_ns, log_ns)


def _keep_tail(path: Path, file: IO[bytes], end: int, walk: Walk, closing: bytes) -> Path | None:
    """Save the bytes after the last whole record, unless they are a torn record or a torn end, then zeros."""
    length = min(LONGEST_RECORD_BYTES + HEAD.size + 1, max(0, walk.zeros_at - end))
    tail = read_at(file.fileno(), length, end)
    if closing.startswith(tail) or is_torn_record(tail, len(tail)):
        return None
    return keep_tail(path, file, end, walk.size)
