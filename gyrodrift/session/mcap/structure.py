"""Search for samples after damage by the layout of records, without checksums."""

import os
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import IO

from mcap.opcode import Opcode

from gyrodrift.io.system import read_at
from gyrodrift.session.damage import LostSamples
from gyrodrift.session.mcap.checksums import OPCODE
from gyrodrift.session.mcap.ending import Ending
from gyrodrift.session.mcap.layout import HEAD, MAGIC, MESSAGE_OPCODE, READS
from gyrodrift.session.mcap.surveyed import Survey
from gyrodrift.session.mcap.walk import (
    ROW_START_BYTES,
    ROW_STARTS,
    ByteStretch,
    PlacedRecord,
    SampleRows,
    Walk,
    data_blocks,
)

LONGEST_RECORD_BYTES = 1 << 20
"""Limit of the records that this program writes."""

OPCODES = frozenset({*Opcode, OPCODE})


def is_torn_record(tail: bytes, available: int) -> bool:
    """Whether bytes are the start of a record of which only `available` bytes were written."""
    if available < HEAD.size or len(tail) < HEAD.size:
        return True
    opcode, length = HEAD.unpack_from(tail)
    return opcode in OPCODES and available - HEAD.size < length <= LONGEST_RECORD_BYTES


def by_structure(file: IO[bytes], ending: Ending) -> Survey:
    """Survey of a file without checksum tables, by the layout of its records."""
    survey = resynchronized(file, len(MAGIC))
    if ending is Ending.DAMAGED:
        return replace(survey, is_sure=False)
    return survey


def resynchronized(file: IO[bytes], start: int) -> Survey:
    """Whole records from an offset on; after bytes that are no record, from the next sample on.

    Samples are counted from the offset on.
    """
    size, state = os.fstat(file.fileno()).st_size, _Progress([], [])
    while start < size:
        walk = Walk(file, [ByteStretch(start, size)])
        end, samples, is_ended = _walked(walk)
        again = size if is_ended else _next_sample(file, walk, end)
        if again is None:
            state.keep(start, end, samples)
            if not is_ended and not _is_cut_off(file, walk, end):
                state.bad_tail_bytes = size - end
            break
        if is_ended:
            state.keep(start, end, samples)
            break
        state.keep(start, *_before_damage(walk, start, end, samples))
        state.lost.append(LostSamples(state.samples, None))
        start = again
    return Survey(
        tuple(state.stretches),
        tuple(state.lost),
        is_sure=not state.lost,
        bad_tail_bytes=state.bad_tail_bytes,
    )


@dataclass(slots=True)
class _Progress:
    stretches: list[ByteStretch]
    lost: list[LostSamples]
    samples: int = 0
    bad_tail_bytes: int = 0

    def keep(self, start: int, end: int, samples: int) -> None:
        """Add a stretch of whole records."""
        if end > start:
            self.stretches.append(ByteStretch(start, end, self.samples))
            self.samples += samples


def _walked(walk: Walk) -> tuple[int, int, bool]:
    """End of the whole records, number of samples among them, and whether the data section ended."""
    samples = 0
    for step in walk:
        match step:
            case SampleRows(rows=rows):
                samples += len(rows)
            case PlacedRecord(opcode=Opcode.DATA_END):
                return walk.end, samples, True
            case PlacedRecord():
                pass
    return walk.end, samples, False


def _before_damage(walk: Walk, start: int, end: int, samples: int) -> tuple[int, int]:
    """End and samples without the last sample, which may be damaged after its first bytes."""
    for row_start, row in ROW_STARTS.items() if samples else ():
        last = end - row.itemsize
        if last >= start and read_at(walk.fd, ROW_START_BYTES, last) == row_start:
            return last, samples - 1
    return end, samples


def _is_cut_off(file: IO[bytes], walk: Walk, end: int) -> bool:
    """Whether the bytes after the last whole record are from a kill or a power cut: a torn record, or zeros."""
    available = max(0, walk.zeros_at - end)
    return is_torn_record(read_at(file.fileno(), HEAD.size, end), available)


def _next_sample(file: IO[bytes], walk: Walk, end: int) -> int | None:
    """Offset of the next sample after bytes that are no record; None without one, or after a torn read of the link."""
    head = read_at(file.fileno(), HEAD.size + 2, end)
    available = max(0, walk.zeros_at - end)
    is_read = head[:1] == bytes([MESSAGE_OPCODE]) and head[HEAD.size :] == READS.channel_id.to_bytes(2, "little")
    if is_read and is_torn_record(head, available):  # bytes of a device may look like samples
        return None
    for start, block in data_blocks(file, end + 1, walk.zeros_at, ROW_START_BYTES - 1):
        offsets = [
            start + index
            for row_start, row in ROW_STARTS.items()
            for index in _occurrences(block, row_start)
            if _is_followed(file, walk, start + index + row.itemsize)
        ]
        if offsets:
            return min(offsets)
    return None


def _occurrences(block: bytes, part: bytes) -> Iterator[int]:
    index = block.find(part)
    while index >= 0:
        yield index
        index = block.find(part, index + 1)


def _is_followed(file: IO[bytes], walk: Walk, offset: int) -> bool:
    """Whether a record or the end of the file follows at the end of a possible sample."""
    head = read_at(file.fileno(), HEAD.size, offset)
    if offset == walk.size:
        return True
    if offset > walk.zeros_at or len(head) < HEAD.size:
        return False
    opcode, length = HEAD.unpack(head)
    return opcode in OPCODES and length <= LONGEST_RECORD_BYTES
