"""Repair of a session file: a killed writer's file gets its end, and a damaged file is replaced by a whole one.

After an interrupted repair the file can be repaired again. The bytes after the last whole record are kept in another
file. They may be anything. Older versions wrote the config with passwords, so stars replace text that mentions a
password.
"""

import os
import shutil
import stat
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import IO

from mcap.opcode import Opcode
from mcap.records import MetadataIndex

from gyrodrift.io.files import UnreadableError, check_ordinary, whole_file
from gyrodrift.io.system import read_at, set_mode
from gyrodrift.session.damage import DamagedError, RecordingDamage
from gyrodrift.session.mcap.ending import crc_of, is_bare, is_closed, lock
from gyrodrift.session.mcap.inspection import LONGEST_RECORD_BYTES, Inspection, inspect, is_torn_record
from gyrodrift.session.mcap.layout import (
    EVENTS,
    HEAD,
    MAGIC,
    MESSAGE_START,
    PROVED,
    READS,
    REPAIR,
    SAMPLES,
    SEAL_BYTES,
    seal,
)
from gyrodrift.session.mcap.read import add_chunk, read_mcap, writer_for
from gyrodrift.session.mcap.walk import (
    BrokenRecordError,
    PlacedRecord,
    SampleRows,
    Walk,
    channel_of,
    data_blocks,
    header_of,
    metadata_of,
    schema_of,
)
from gyrodrift.session.mcap.write import FileSummary, McapWriter
from gyrodrift.session.session import Session
from gyrodrift.values.errors import DataError
from gyrodrift.values.secret import MENTION

TOPICS = {topic.channel_id: topic for topic in (READS, EVENTS)}

LONGEST_TEXT = 1 << 17
"""Bytes of a config, the longest text with secrets."""

TEXT = bytes(byte for byte in range(256) if byte in b"\t\n\r" or 0x20 <= byte != 0x7F)
IS_TEXT = bytes(byte in TEXT for byte in range(256))
"""Table for `bytes.translate`: 1 for a byte of text, 0 for another byte."""


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
            inspection = _own_inspection(path, file)
            if not inspection.has_inner_damage:
                return None if is_closed(file) else _close(path, file, inspection)
            if not inspection.is_ours:
                _check_writer(next(iter(Walk(file)), None), Walk(file), path)
            session = read_mcap(path, allow_damage=True)
            if session.damage is None:
                raise DataError(f"{path}: cannot be repaired: it changes while it is read")
            if not rebuilds:
                raise DamagedError([(path, session.damage)])
            kept = _rebuild(path, Walk(file, inspection.stretches), session, session.damage)
            return Repaired(path, session.damage.kept, 0, None, session.damage, kept)
    except OSError as error:
        raise DataError(f"{path}: cannot be repaired: {error.strerror}") from error
    except (BrokenRecordError, UnreadableError) as error:
        raise DataError(f"{path}: cannot be repaired: {error}") from error


def _own_inspection(path: Path, file: IO[bytes]) -> Inspection:
    """Inspection of a file that this program wrote or may have written."""
    if is_bare(file):
        raise DataError(f"{path}: cannot be repaired: nothing was recorded into it; it can be deleted")
    inspection = inspect(file)
    if not inspection.is_ours and read_at(file.fileno(), len(MAGIC), 0) != MAGIC:
        raise DataError(f"{path}: cannot be repaired: it does not begin as an MCAP file")
    return inspection


def _rebuild(path: Path, walk: Walk, session: Session, damage: RecordingDamage) -> Path:
    """Replace a damaged file by a whole one with all that was read of it; returns the new path of the damaged file."""
    kept = free_path(path, "damaged")
    try:
        os.link(path, kept)
    except OSError:  # a disk without links, such as FAT, or a file of another user
        shutil.copy(path, kept)
    repair_table = {
        "damage": str(damage),
        "samples_lost": str(damage.lost_count),
        "seconds_lost": f"{damage.lost_seconds:.6g}",
        PROVED: "yes" if damage.is_sure else "no",
    }
    with whole_file(path) as fresh:
        writer = writer_for(session, fresh, {REPAIR: repair_table})
        add_chunk(writer, session)
        for step in walk:
            if isinstance(step, PlacedRecord):
                with suppress(BrokenRecordError):
                    _copy(step, walk, writer)
        writer.finish()
    return kept


def _copy(record: PlacedRecord, walk: Walk, writer: McapWriter) -> None:
    """Copy a table, or a message other than a sample or a rest flag."""
    body = walk.body(record)
    if record.opcode == Opcode.METADATA:
        table = metadata_of(body)
        if table.name != REPAIR or table.metadata.get(PROVED) == "no":  # once unproved, always unproved
            writer.add_metadata(table.name, table.metadata)
    elif record.opcode == Opcode.MESSAGE and len(body) >= MESSAGE_START.size:
        channel_id, _, log_ns, _ = MESSAGE_START.unpack_from(body)
        if channel_id in TOPICS:
            writer.add_message(TOPICS[channel_id], body[MESSAGE_START.size :], log_ns)


def _close(path: Path, file: IO[bytes], inspection: Inspection) -> Repaired:
    walk = Walk(file, inspection.stretches)
    contents, end = _contents(path, walk)
    contents.size, contents.crc = end, crc_of(file, 0, end)
    last_seal = _last_seal(file, inspection, end)
    contents.add_bytes(last_seal)
    closing = last_seal + contents.end()
    tail = _keep_tail(path, file, end, walk, closing)
    file.truncate(end)
    file.seek(end)
    file.write(closing)
    file.flush()
    os.fsync(file.fileno())
    return Repaired(path, contents.counts.get(SAMPLES.channel_id, 0), walk.size - end, tail)


def _last_seal(file: IO[bytes], inspection: Inspection, end: int) -> bytes:
    """Seal of the records after the last one; empty if the file ends in the last seal of a closed file."""
    proofs = inspection.proofs
    if proofs is None or proofs.salt is None:
        return b""
    last = proofs.pieces[-1]
    if last.stop == end and not last.samples and last.stop - last.start == SEAL_BYTES:
        return b""
    return seal(proofs.seals, read_at(file.fileno(), end - last.stop, last.stop), proofs.samples, proofs.salt)


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
            channel_id, _, log_ns, _ = MESSAGE_START.unpack_from(walk.body(record))
            contents.add_messages(channel_id, 1, log_ns, log_ns)


def _keep_tail(path: Path, file: IO[bytes], end: int, walk: Walk, closing: bytes) -> Path | None:
    """Save the bytes after the last whole record, unless they are a torn record or a torn end, then zeros."""
    length = min(LONGEST_RECORD_BYTES + HEAD.size + 1, max(0, walk.zeros_at - end))
    tail = read_at(file.fileno(), length, end)
    if closing.startswith(tail) or is_torn_record(tail, len(tail)):
        return None
    return keep_tail(path, file, end, walk.size)


def keep_tail(path: Path, file: IO[bytes], end: int, size: int) -> Path:
    """Copy the bytes between two offsets to a new file with the permissions of the session file; returns its path."""
    saved = free_path(path, "tail")
    with open(saved, "xb", opener=_open_private) as copy:
        set_mode(copy.fileno(), stat.S_IMODE(os.fstat(file.fileno()).st_mode))
        for offset, block in data_blocks(file, end, size):
            copy.seek(offset - end)
            copy.write(_public(file, offset, block, end))
        copy.truncate(size - end)
        copy.flush()
        os.fsync(copy.fileno())
    return saved


def free_path(path: Path, ending: str) -> Path:
    """Path beside a file for what is kept of it; with a number if an earlier copy or another file has it."""
    free, number = path.with_name(f"{path.name}.{ending}"), 1
    while os.path.lexists(free):
        number += 1
        free = path.with_name(f"{path.name}.{ending}_{number}")
    return free


def _open_private(name: str, flags: int) -> int:
    """Open a new file that no other user can open until its mode is set."""
    return os.open(name, flags, 0o600)


def _public(file: IO[bytes], offset: int, block: bytes, least: int) -> bytes:
    """A block with stars for text that mentions a secret; the text may start before it and end after it."""
    start = max(least, offset - LONGEST_TEXT)
    context = read_at(file.fileno(), offset - start + len(block) + LONGEST_TEXT, start)
    return covered(context)[offset - start : offset - start + len(block)]


def covered(content: bytes) -> bytes:
    """Bytes of the same length, with stars for the text around every mention of a secret."""
    is_text, public = content.translate(IS_TEXT), bytearray(content)
    words, index = content.decode("latin-1"), 0
    while match := MENTION.search(words, index):
        mention_start, index = match.start(), match.end()
        first = is_text.rfind(0, max(0, mention_start - LONGEST_TEXT), mention_start)
        first = max(0, mention_start - LONGEST_TEXT) if first < 0 else first + 1
        text_end = is_text.find(0, index, index + LONGEST_TEXT)
        index = min(len(content), index + LONGEST_TEXT) if text_end < 0 else text_end
        public[first:index] = b"*" * (index - first)
    return bytes(public)
