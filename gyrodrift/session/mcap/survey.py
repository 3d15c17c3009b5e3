"""Which stretches of a session file are as they were written, and what is missing between them."""

import os
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import IO

from gyrodrift.session.damage import LostSamples
from gyrodrift.session.mcap.checksums import LONGEST_TABLE_BYTES, MARKER, OPCODE, Piece, Region, Table, table_of
from gyrodrift.session.mcap.ending import DATA_END, Ending, data_end_of, ending_of
from gyrodrift.session.mcap.layout import HEAD, MAGIC
from gyrodrift.session.mcap.surveyed import PlacedTable, Survey
from gyrodrift.session.mcap.walk import ByteStretch, data_blocks
from gyrodrift.system import read_at

MOST_SHIFTS = 64
"""How many places are tried for a piece that is not where it was written, one for each hole before it."""


def survey(file: IO[bytes]) -> Survey:
    """Check a file and find what is whole in it; a file without damage is one stretch."""
    size = os.fstat(file.fileno()).st_size
    everything = Survey((ByteStretch(len(MAGIC), size),))
    ending = ending_of(file)
    if ending is Ending.INTACT:
        return everything
    tables = list(_tables(file, size))
    if tables:
        return _Checked(file, size, tables, ending).survey()
    from gyrodrift.session.mcap.structure import by_structure  # noqa: PLC0415 - files of earlier versions alone need it

    return by_structure(file, ending)


def _tables(file: IO[bytes], size: int) -> Iterator[PlacedTable]:
    """All whole tables of the recording whose table comes first."""
    recording_id = None
    for at in _places(file, size):
        table = _table_at(file, at)
        if table is not None and (recording_id is None or table.recording_id == recording_id):
            recording_id = table.recording_id
            yield PlacedTable(at, table)


def _table_at(file: IO[bytes], at: int) -> Table | None:
    head = read_at(file.fileno(), HEAD.size, at)
    opcode, length = HEAD.unpack(head) if len(head) == HEAD.size else (0, 0)
    if opcode != OPCODE or length > LONGEST_TABLE_BYTES:
        return None
    return table_of(read_at(file.fileno(), HEAD.size + length, at))


def _places(file: IO[bytes], size: int) -> Iterator[int]:
    """Where the records begin that the marker of a table stands in."""
    for start, block in data_blocks(file, 0, size, len(MARKER) - 1):
        at = block.find(MARKER)
        while at >= 0:
            if start + at >= HEAD.size:
                yield start + at - HEAD.size
            at = block.find(MARKER, at + 1)


@dataclass(slots=True)
class _Checked:
    """Holds each piece of a file against its checksum."""

    file: IO[bytes]
    size: int
    found: list[PlacedTable]
    ending: Ending
    stretches: list[ByteStretch] = field(default_factory=list)
    lost: list[LostSamples] = field(default_factory=list)
    unheard: list[int] = field(default_factory=list)
    is_moved: bool = False
    end: int = 0
    bad_tail_bytes: int = 0

    def survey(self) -> Survey:
        """All of it."""
        tables: dict[int, PlacedTable] = {}
        regions: dict[int, Region] = {}
        for each in self.found:
            regions[each.table.before.start] = each.table.before
        for each in self.found:
            regions[each.table.region.start] = each.table.region
            tables.setdefault(each.table.region.start, each)
        shifts = list(dict.fromkeys(each.shift for each in tables.values()))[:MOST_SHIFTS]
        shift, expected_at, expected_sample = 0, 0, 0
        for start in sorted(regions):
            region, own = regions[start], tables.get(start)
            self._skip(start - expected_at, region.first_sample - expected_sample, expected_sample)
            likely = shift if own is None else own.shift
            self._take(region, list(dict.fromkeys([likely, shift, *shifts])))
            shift = likely
            expected_at, expected_sample = region.stop, region.first_sample + region.samples
            if own is not None:
                self._keep(own.at, own.at + own.table.size, expected_sample)
                expected_at += own.table.size
        remarks = [*self._remarks()]
        last = max(self.found, key=lambda each: each.table.region.start)
        remarks += self._ended(last, expected_sample, is_damaged=bool(self.lost or remarks))
        return Survey(
            tuple(self.stretches),
            _joined(self.lost),
            tuple(self.unheard),
            tuple(remarks),
            is_ours=True,
            last_table=last,
            bad_tail_bytes=self.bad_tail_bytes,
        )

    def _skip(self, count: int, samples: int, first: int) -> None:
        """What no table tells of: damaged tables, and all that they are about."""
        if count <= 0:
            return
        self.is_moved = True
        if samples > 0:
            self.lost.append(LostSamples(first, samples))
            self.unheard.append(first)

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
        """A piece that is not where it should be."""
        for shift in shifts[1:]:
            at = start + shift
            if at >= 0 and at + piece.length <= self.size:
                content = read_at(self.file.fileno(), piece.length, at)
                if zlib.crc32(content) == piece.crc:
                    self._keep(at, at + piece.length, number)
                    return
        if piece.samples:
            self.lost.append(LostSamples(number, piece.samples))
        else:
            self.unheard.append(number)

    def _keep(self, start: int, stop: int, first_sample: int) -> None:
        last = self.stretches[-1] if self.stretches else None
        if last is not None and last.stop == start:
            self.stretches[-1] = ByteStretch(last.start, stop, last.first_sample)
        else:
            self.is_moved |= start != self.end
            self.stretches.append(ByteStretch(start, stop, first_sample))
        self.end = stop

    def _remarks(self) -> Iterator[str]:
        if self.unheard:
            yield "records beside the samples are lost (what is known of the device, link events, raw bytes)"
        if self.is_moved and not self.lost and not self.unheard:
            yield "bytes between its records are damaged"

    def _ended(self, last: PlacedTable, samples: int, *, is_damaged: bool) -> Iterator[str]:
        """What stands behind the last table: the end of a closed file, or what was on its way."""
        end = last.at + last.table.size
        if self.ending is Ending.OPEN:
            self._tail(end, samples)
            return
        begin = read_at(self.file.fileno(), len(DATA_END), end)
        if begin != DATA_END and data_end_of(self.file) > end:  # the last tables are damaged, too
            self.lost.append(LostSamples(samples, None))
            self.unheard.append(samples)
        elif not is_damaged:
            yield "its end is damaged"

    def _tail(self, end: int, samples: int) -> None:
        """Records of an interrupted recording that no table tells of yet."""
        if end >= self.size:
            return
        from gyrodrift.session.mcap.structure import resynchronised  # noqa: PLC0415 - knows the records

        tail = resynchronised(self.file, end)
        for stretch in tail.stretches:
            self._keep(stretch.start, stretch.stop, samples + stretch.first_sample)
        self.lost += [LostSamples(samples + each.first, each.count) for each in tail.lost]
        self.bad_tail_bytes = tail.bad_tail_bytes


def _joined(lost: list[LostSamples]) -> tuple[LostSamples, ...]:
    """Losses that follow each other are one."""
    found: list[LostSamples] = []
    for each in lost:
        last = found[-1] if found else None
        if last is not None and last.count is not None and last.first + last.count == each.first:
            found[-1] = LostSamples(last.first, None if each.count is None else last.count + each.count)
        else:
            found.append(each)
    return tuple(found)
