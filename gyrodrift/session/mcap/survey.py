"""Search for the whole stretches of a session file, and for the losses between them."""

import os
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import IO

from gyrodrift.io.system import read_at
from gyrodrift.session.damage import LostSamples
from gyrodrift.session.mcap.checksums import LONGEST_TABLE_BYTES, MARKER, OPCODE, Piece, Region, Table, table_of
from gyrodrift.session.mcap.ending import DATA_END, Ending, data_end_of, ending_of
from gyrodrift.session.mcap.layout import HEAD, MAGIC
from gyrodrift.session.mcap.surveyed import PlacedTable, Survey
from gyrodrift.session.mcap.walk import ByteStretch, data_blocks

MOST_SHIFTS = 64
"""Offsets to try for a moved piece, one per gap before it."""


def survey(file: IO[bytes]) -> Survey:
    """Check a file and find its whole stretches; a file without damage is one stretch."""
    size = os.fstat(file.fileno()).st_size
    everything = Survey((ByteStretch(len(MAGIC), size),))
    ending = ending_of(file)
    if ending is Ending.INTACT:
        return everything
    tables = list(_tables(file, size))
    if tables:
        return _Checked(file, size, tables, ending).survey()
    from gyrodrift.session.mcap.structure import by_structure  # noqa: PLC0415 - only for files of earlier versions

    return by_structure(file, ending)


def _tables(file: IO[bytes], size: int) -> Iterator[PlacedTable]:
    """All whole tables of the recording that has the first table."""
    recording_id = None
    for offset in _table_offsets(file, size):
        table = _table_at(file, offset)
        if table is not None and (recording_id is None or table.recording_id == recording_id):
            recording_id = table.recording_id
            yield PlacedTable(offset, table)


def _table_at(file: IO[bytes], offset: int) -> Table | None:
    head = read_at(file.fileno(), HEAD.size, offset)
    opcode, length = HEAD.unpack(head) if len(head) == HEAD.size else (0, 0)
    if opcode != OPCODE or length > LONGEST_TABLE_BYTES:
        return None
    return table_of(read_at(file.fileno(), HEAD.size + length, offset))


def _table_offsets(file: IO[bytes], size: int) -> Iterator[int]:
    """Offsets of possible table records, by their marker."""
    for start, block in data_blocks(file, 0, size, len(MARKER) - 1):
        index = block.find(MARKER)
        while index >= 0:
            if start + index >= HEAD.size:
                yield start + index - HEAD.size
            index = block.find(MARKER, index + 1)


@dataclass(slots=True)
class _Checked:
    """Compares every piece of a file with its checksum."""

    file: IO[bytes]
    size: int
    found_tables: list[PlacedTable]
    ending: Ending
    stretches: list[ByteStretch] = field(default_factory=list)
    lost: list[LostSamples] = field(default_factory=list)
    record_losses: list[int] = field(default_factory=list)
    is_moved: bool = False
    end: int = 0
    bad_tail_bytes: int = 0

    def survey(self) -> Survey:
        """Survey the whole file."""
        tables: dict[int, PlacedTable] = {}
        regions: dict[int, Region] = {}
        for placed in self.found_tables:
            regions[placed.table.before.start] = placed.table.before
        for placed in self.found_tables:
            regions[placed.table.region.start] = placed.table.region
            tables.setdefault(placed.table.region.start, placed)
        shifts = list(dict.fromkeys(placed.shift for placed in tables.values()))[:MOST_SHIFTS]
        shift, expected_at, expected_sample = 0, 0, 0
        for start in sorted(regions):
            region, own = regions[start], tables.get(start)
            self._skip(start - expected_at, region.first_sample - expected_sample, expected_sample)
            likely = shift if own is None else own.shift
            self._take(region, list(dict.fromkeys([likely, shift, *shifts])))
            shift = likely
            expected_at, expected_sample = region.stop, region.first_sample + region.samples
            if own is not None:
                self._keep(own.offset, own.offset + own.table.size, expected_sample)
                expected_at += own.table.size
        remarks = [*self._remarks()]
        last = max(self.found_tables, key=lambda placed: placed.table.region.start)
        remarks += self._ended(last, expected_sample, is_damaged=bool(self.lost or remarks))
        return Survey(
            tuple(self.stretches),
            _joined(self.lost),
            tuple(self.record_losses),
            tuple(remarks),
            is_ours=True,
            last_table=last,
            bad_tail_bytes=self.bad_tail_bytes,
        )

    def _skip(self, count: int, samples: int, first: int) -> None:
        """Record the loss of damaged tables and of the bytes that only they cover."""
        if count <= 0:
            return
        self.is_moved = True
        if samples > 0:
            self.lost.append(LostSamples(first, samples))
            self.record_losses.append(first)

    def _take(self, region: Region, shifts: list[int]) -> None:
        """Find the pieces of a region."""
        start, number = region.start, region.first_sample
        likely = shifts[0] if shifts else 0
        content = read_at(self.file.fileno(), region.stop - start, start + likely) if start + likely >= 0 else b""
        for piece in region.pieces:
            offset = start - region.start
            if zlib.crc32(content[offset : offset + piece.length]) == piece.crc and offset + piece.length <= len(
                content
            ):
                self._keep(start + likely, start + likely + piece.length, number)
            else:
                self._search(piece, start, number, shifts)
            start += piece.length
            number += piece.samples

    def _search(self, piece: Piece, start: int, number: int, shifts: list[int]) -> None:
        """Search for a piece that is not at its expected offset."""
        for shift in shifts[1:]:
            offset = start + shift
            if offset >= 0 and offset + piece.length <= self.size:
                content = read_at(self.file.fileno(), piece.length, offset)
                if zlib.crc32(content) == piece.crc:
                    self._keep(offset, offset + piece.length, number)
                    return
        if piece.samples:
            self.lost.append(LostSamples(number, piece.samples))
        else:
            self.record_losses.append(number)

    def _keep(self, start: int, stop: int, first_sample: int) -> None:
        last = self.stretches[-1] if self.stretches else None
        if last is not None and last.stop == start:
            self.stretches[-1] = ByteStretch(last.start, stop, last.first_sample)
        else:
            self.is_moved |= start != self.end
            self.stretches.append(ByteStretch(start, stop, first_sample))
        self.end = stop

    def _remarks(self) -> Iterator[str]:
        if self.record_losses:
            yield "records other than samples are lost (description of the device, link events, raw bytes)"
        if self.is_moved and not self.lost and not self.record_losses:
            yield "bytes between its records are damaged"

    def _ended(self, last: PlacedTable, samples: int, *, is_damaged: bool) -> Iterator[str]:
        """Check the bytes after the last table: the end of a closed file, or unfinished records."""
        end = last.offset + last.table.size
        if self.ending is Ending.OPEN:
            self._tail(end, samples)
            return
        begin = read_at(self.file.fileno(), len(DATA_END), end)
        if begin != DATA_END and data_end_of(self.file) > end:  # the last tables are damaged too
            self.lost.append(LostSamples(samples, None))
            self.record_losses.append(samples)
        elif not is_damaged:
            yield "its end is damaged"

    def _tail(self, end: int, samples: int) -> None:
        """Add the records of an interrupted recording after its last table."""
        if end >= self.size:
            return
        from gyrodrift.session.mcap.structure import resynchronized  # noqa: PLC0415 - rarely needed

        tail = resynchronized(self.file, end)
        for stretch in tail.stretches:
            self._keep(stretch.start, stretch.stop, samples + stretch.first_sample)
        self.lost += [LostSamples(samples + loss.first, loss.count) for loss in tail.lost]
        self.bad_tail_bytes = tail.bad_tail_bytes


def _joined(lost: list[LostSamples]) -> tuple[LostSamples, ...]:
    """Merge adjacent losses."""
    joined: list[LostSamples] = []
    for loss in lost:
        last = joined[-1] if joined else None
        if last is not None and last.count is not None and last.first + last.count == loss.first:
            joined[-1] = LostSamples(last.first, None if loss.count is None else last.count + loss.count)
        else:
            joined.append(loss)
    return tuple(joined)
