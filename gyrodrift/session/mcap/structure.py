"""Finding the samples behind damage by how records are laid out, where no checksum tells of them."""

import os
from dataclasses import dataclass, replace
from typing import IO

from mcap.opcode import Opcode

from gyrodrift.session.damage import LostSamples
from gyrodrift.session.mcap.checksums import OPCODE
from gyrodrift.session.mcap.ending import Ending
from gyrodrift.session.mcap.layout import HEAD, MAGIC, MESSAGE, MESSAGE_OPCODE, READS
from gyrodrift.session.mcap.surveyed import Survey
from gyrodrift.session.mcap.walk import ROW_START, ByteStretch, PlacedRecord, SampleRows, Walk, data_blocks
from gyrodrift.system import read_at

LONGEST_RECORD_BYTES = 1 << 20
"""No record of ours is longer."""

OPCODES = frozenset({*Opcode, OPCODE})


def is_torn_record(tail: bytes, left: int) -> bool:
    """Whether bytes are the beginning of a record of which only `left` bytes were written."""
    if left < HEAD.size or len(tail) < HEAD.size:
        return True
    opcode, length = HEAD.unpack_from(tail)
    return opcode in OPCODES and left - HEAD.size < length <= LONGEST_RECORD_BYTES


def by_structure(file: IO[bytes], ending: Ending) -> Survey:
    """A file without tables of checksums: what can be found by the layout of its records."""
    found = resynchronised(file, len(MAGIC))
    if ending is Ending.DAMAGED:
        return replace(found, is_sure=False)
    return found


def resynchronised(file: IO[bytes], start: int) -> Survey:
    """Whole records from a place on; behind bytes that are none it goes on with the next sample.

    Samples are counted from that place on.
    """
    size, state = os.fstat(file.fileno()).st_size, _Found([], [])
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
class _Found:
    stretches: list[ByteStretch]
    lost: list[LostSamples]
    samples: int = 0
    bad_tail_bytes: int = 0

    def keep(self, start: int, end: int, samples: int) -> None:
        """A stretch of whole records."""
        if end > start:
            self.stretches.append(ByteStretch(start, end, self.samples))
            self.samples += samples


def _walked(walk: Walk) -> tuple[int, int, bool]:
    """Where whole records end, how many samples are among them, and whether the data was ended there."""
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
    """Without the last sample: its beginning may be whole and the rest damaged."""
    last = end - MESSAGE.size
    if last >= start and samples and read_at(walk.fd, len(ROW_START), last) == ROW_START:
        return last, samples - 1
    return end, samples


def _is_cut_off(file: IO[bytes], walk: Walk, end: int) -> bool:
    """Whether what stands behind the last whole record is what a kill or a power cut leaves: a torn record, zeros."""
    left = max(0, walk.zeros_at - end)
    return is_torn_record(read_at(file.fileno(), HEAD.size, end), left)


def _next_sample(file: IO[bytes], walk: Walk, end: int) -> int | None:
    """Where samples go on behind bytes that are no record; None where there are none, or a read of the link is torn."""
    head = read_at(file.fileno(), HEAD.size + 2, end)
    left = max(0, walk.zeros_at - end)
    is_read = head[:1] == bytes([MESSAGE_OPCODE]) and head[HEAD.size :] == READS.channel_id.to_bytes(2, "little")
    if is_read and is_torn_record(head, left):  # its bytes are a device's, which may look like samples
        return None
    for start, block in data_blocks(file, end + 1, walk.zeros_at, len(ROW_START) - 1):
        at = block.find(ROW_START)
        while at >= 0:
            if _is_followed(file, walk, start + at + MESSAGE.size):
                return start + at
            at = block.find(ROW_START, at + 1)
    return None


def _is_followed(file: IO[bytes], walk: Walk, at: int) -> bool:
    """Whether a record, or the end of the file, stands where a sample would end."""
    head = read_at(file.fileno(), HEAD.size, at)
    if at == walk.size:
        return True
    if at > walk.zeros_at or len(head) < HEAD.size:
        return False
    opcode, length = HEAD.unpack(head)
    return opcode in OPCODES and length <= LONGEST_RECORD_BYTES
