"""Whole records of a session file, and the losses between them."""

import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import IO

import numpy as np
from mcap.opcode import Opcode

from gyrodrift.io.system import read_at
from gyrodrift.session.damage import LostSamples, RecordingDamage, timed
from gyrodrift.session.mcap.ending import DATA_END, Ending, data_end_of, ending_of
from gyrodrift.session.mcap.layout import HEAD, MAGIC, SEAL_OPCODE
from gyrodrift.session.mcap.proofs import Piece, Proofs, checked_proofs
from gyrodrift.session.mcap.rows import ROW_SIZES
from gyrodrift.session.mcap.tables import TABLE_OPCODE, table_proofs
from gyrodrift.session.mcap.walk import ByteStretch, PlacedRecord, SampleRows, Walk
from gyrodrift.values.arrays import Floats

LONGEST_RECORD_BYTES = 1 << 20
"""Limit of the records that this program writes."""

OPCODES = frozenset({*Opcode, SEAL_OPCODE, TABLE_OPCODE})


@dataclass(slots=True)
class Inspection:
    """Result of the inspection of a file.

    stretches
        Stretches of whole records, in the order of writing.
    lost
        Lost samples in order.
    record_losses
        Numbers of samples before each loss of other records.
    remarks
        Other damage, a phrase each.
    proofs
        What its checksums prove; None if the end of the file already proves all bytes, or without usable checksums.
    is_sure
        Whether checksums prove the samples.
    bad_tail_bytes
        Bytes at the end of an interrupted recording that are no records and not the result of a kill or a power cut.
    """

    stretches: list[ByteStretch] = field(default_factory=list)
    lost: list[LostSamples] = field(default_factory=list)
    record_losses: list[int] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)
    proofs: Proofs | None = None
    is_sure: bool = True
    bad_tail_bytes: int = 0

    @property
    def is_ours(self) -> bool:
        """Whether the file has checksums that only gyrodrift writes."""
        return self.proofs is not None

    @property
    def is_damaged(self) -> bool:
        """Whether any byte is damaged; an interrupted recording is not."""
        return self.has_inner_damage or bool(self.bad_tail_bytes)

    @property
    def has_inner_damage(self) -> bool:
        """Whether there is damage before the end of the last record."""
        return bool(self.lost or self.remarks) or not self.is_sure

    def kept_before(self, numbers: Sequence[int]) -> list[int]:
        """How many of the first `numbers` samples of the recording are whole, for each of `numbers`."""
        firsts = np.array([0, *(loss.first for loss in self.lost)])
        counts = np.array([0, *(loss.count or 0 for loss in self.lost)])
        last = np.searchsorted(firsts, numbers, side="right") - 1  # the last loss that begins before them
        rest = np.maximum(0, (firsts + counts)[last] - numbers)  # its samples behind them
        kept: list[int] = (numbers - np.cumsum(counts)[last] + rest).tolist()
        return kept

    def damage(self, t_device_s: Floats) -> RecordingDamage | None:
        """Damage with times, from the device times of the whole samples, shape (n,); None without damage."""
        if not self.is_damaged:
            return None
        bad_tail = [f"its last {self.bad_tail_bytes} bytes are no records"] if self.bad_tail_bytes else []
        is_sure = self.is_sure and not self.bad_tail_bytes
        return RecordingDamage(timed(self.lost, t_device_s), len(t_device_s), (*self.remarks, *bad_tail), is_sure)

    def keep(self, start: int, stop: int) -> None:
        """Add whole records."""
        last = self.stretches[-1] if self.stretches else None
        if last is not None and last.stop == start:
            self.stretches[-1] = ByteStretch(last.start, stop)
        elif stop > start:
            self.stretches.append(ByteStretch(start, stop))


def inspect(file: IO[bytes]) -> Inspection:
    """Check a file and find its whole records; a file without damage is one stretch."""
    size, ending = os.fstat(file.fileno()).st_size, ending_of(file)
    if ending is Ending.INTACT:
        return Inspection([ByteStretch(len(MAGIC), size)])
    proofs = checked_proofs(file, size) or table_proofs(file, size)
    if proofs is None:
        inspection = Inspection(is_sure=ending is not Ending.DAMAGED)
        _add_unproven(inspection, file, len(MAGIC))
        return inspection
    inspection = _proven(proofs)
    _add_end(inspection, proofs, file, ending)
    return inspection


def _proven(proofs: Proofs) -> Inspection:
    """The proven records, and what is lost between them."""
    inspection = Inspection(record_losses=proofs.record_losses, proofs=proofs)
    number = 0
    for piece in (*proofs.pieces, Piece(0, 0, proofs.samples, 0)):
        if piece.first_sample > number:
            inspection.lost.append(LostSamples(number, piece.first_sample - number))
        number = max(number, piece.first_sample + piece.samples)
        inspection.keep(piece.start, piece.stop)
    if proofs.record_losses:
        text = "records other than samples are lost (description of the device, link events, raw bytes)"
        inspection.remarks.append(text)
    elif not inspection.lost and (len(inspection.stretches) > 1 or inspection.stretches[0].start > len(MAGIC)):
        inspection.remarks.append("bytes between its records are damaged")
    return inspection


def _add_end(inspection: Inspection, proofs: Proofs, file: IO[bytes], ending: Ending) -> None:
    """Check the bytes after the last proven record: the end of a closed file, or unfinished records."""
    end = inspection.stretches[-1].stop
    if ending is Ending.OPEN:
        _add_unproven(inspection, file, end, excludes_samples=proofs.salt is not None)
    elif read_at(file.fileno(), len(DATA_END), end) != DATA_END and data_end_of(file) - end >= min(ROW_SIZES):
        inspection.lost.append(LostSamples(proofs.samples, None))
        inspection.record_losses.append(proofs.samples)
    elif not inspection.has_inner_damage:
        inspection.remarks.append("its end is damaged")


def _add_unproven(inspection: Inspection, file: IO[bytes], start: int, *, excludes_samples: bool = False) -> None:
    """Add the records from an offset on by their layout, up to the end of the data or the first incomplete one.

    Samples and seals that have a checksum are excluded here: if it were right, they would be proven.
    """
    walk = Walk(file, [ByteStretch(start, os.fstat(file.fileno()).st_size)])
    end, is_ended = start, False
    for step in walk:
        is_ended = isinstance(step, PlacedRecord) and step.opcode == Opcode.DATA_END
        if is_ended or (excludes_samples and (isinstance(step, SampleRows) or step.opcode == SEAL_OPCODE)):
            break
        end = walk.end
    inspection.keep(start, end)
    available = max(0, walk.zeros_at - end)
    if not is_ended and not is_torn_record(read_at(file.fileno(), HEAD.size, end), available):
        inspection.bad_tail_bytes = walk.size - end


def is_torn_record(tail: bytes, available: int) -> bool:
    """Whether bytes are the start of a record of which only `available` bytes were written."""
    if available < HEAD.size or len(tail) < HEAD.size:
        return True
    opcode, length = HEAD.unpack_from(tail)
    return opcode in OPCODES and available - HEAD.size < length <= LONGEST_RECORD_BYTES
