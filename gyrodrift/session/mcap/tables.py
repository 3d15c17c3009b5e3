"""Tables of checksums in session files of earlier versions.

A record with a private opcode follows every few hundred kilobytes or every flush. It has a CRC-32 for every 24 samples
before it, and repeats the table before it. A table does not depend on its position: bytes before it may be missing or
doubled.
"""

import struct
import zlib
from collections.abc import Iterator
from typing import IO, NamedTuple

from gyrodrift.io.system import read_at
from gyrodrift.session.mcap.layout import CRC_BYTES, HEAD
from gyrodrift.session.mcap.proofs import Piece, Proofs
from gyrodrift.session.mcap.walk import data_blocks

TABLE_OPCODE = 0x93
MARKER = b"gdcrc\x1a\x00\x01"
"""Marks a table for a search; the last byte is the version of the layout."""

TABLE = struct.Struct("<8s8sQQIQQI")
"""Marker, recording, then first byte, number of the first sample and parts, of this and of the previous region."""

PART = struct.Struct("<III")
LONGEST_TABLE_BYTES = 1 << 20

MOST_SHIFTS = 64
"""Offsets to try for moved records, one per gap before them."""


class TablePart(NamedTuple):
    """Consecutive whole records: bytes, samples (0 for other records), CRC-32."""

    length: int
    samples: int
    crc: int


class Region(NamedTuple):
    """Records that a table covers: offset when it was written, number of samples before it, and its parts."""

    start: int
    first_sample: int
    parts: tuple[TablePart, ...]

    @property
    def stop(self) -> int:
        """Offset of its table when it was written."""
        return self.start + sum(part.length for part in self.parts)

    @property
    def last_sample(self) -> int:
        """Number of samples up to its end."""
        return self.first_sample + sum(part.samples for part in self.parts)


class Table(NamedTuple):
    """A table at an offset, with its region and the previous one."""

    offset: int
    size: int
    recording_id: bytes
    region: Region
    before: Region

    @property
    def shift(self) -> int:
        """Present offset minus the offset when it was written, bytes."""
        return self.offset - self.region.stop


def table_proofs(file: IO[bytes], size: int) -> Proofs | None:
    """Records that tables prove; None without a table."""
    tables: dict[int, Table] = {}
    regions: dict[int, Region] = {}
    for table in _tables(file, size):
        regions.setdefault(table.before.start, table.before)
        regions[table.region.start] = table.region
        tables.setdefault(table.region.start, table)
    if not tables:
        return None
    shifts = list(dict.fromkeys(table.shift for table in tables.values()))[:MOST_SHIFTS]
    pieces: list[Piece] = []
    record_losses: list[int] = []
    samples = shift = 0
    for start in sorted(regions):
        region, own = regions[start], tables.get(start)
        if region.first_sample > samples:  # the table of the region before it is lost, too
            record_losses.append(samples)
        shift = own.shift if own else shift
        for number, part, piece in _searched(file, region, list(dict.fromkeys([shift, *shifts]))):
            if piece is not None:
                pieces.append(piece)
            elif not part.samples:
                record_losses.append(number)
        samples = region.last_sample
        if own is not None:
            pieces.append(Piece(own.offset, own.offset + own.size, samples, 0))
    return Proofs(pieces, samples, record_losses)


def _searched(file: IO[bytes], region: Region, shifts: list[int]) -> Iterator[tuple[int, TablePart, Piece | None]]:
    """Parts of a region with the number of samples before them, and where they are now."""
    start, number = region.start, region.first_sample
    for part in region.parts:
        offset = next((start + shift for shift in shifts if _is_at(file, part, start + shift)), None)
        piece = None if offset is None else Piece(offset, offset + part.length, number, part.samples)
        yield number, part, piece
        start, number = start + part.length, number + part.samples


def _is_at(file: IO[bytes], part: TablePart, offset: int) -> bool:
    content = read_at(file.fileno(), part.length, offset) if offset >= 0 else b""
    return len(content) == part.length and zlib.crc32(content) == part.crc


def _tables(file: IO[bytes], size: int) -> Iterator[Table]:
    """All whole tables of the recording that has the first table."""
    recording_id = None
    for start, block in data_blocks(file, 0, size, len(MARKER) - 1):
        index = block.find(MARKER)
        while index >= 0:
            table = _table_at(file, start + index - HEAD.size) if start + index >= HEAD.size else None
            if table is not None and recording_id in (None, table.recording_id):
                recording_id = table.recording_id
                yield table
            index = block.find(MARKER, index + 1)


def _table_at(file: IO[bytes], offset: int) -> Table | None:
    """The table at an offset; None if it is damaged."""
    opcode, length = HEAD.unpack(read_at(file.fileno(), HEAD.size, offset))
    if opcode != TABLE_OPCODE or not TABLE.size + CRC_BYTES <= length <= LONGEST_TABLE_BYTES:
        return None
    body = read_at(file.fileno(), length, offset + HEAD.size)
    content, crc = body[:-CRC_BYTES], int.from_bytes(body[-CRC_BYTES:], "little")
    if len(body) < length or zlib.crc32(content) != crc:
        return None
    _, recording_id, start, first, count, start_before, first_before, count_before = TABLE.unpack_from(content)
    if len(content) != TABLE.size + PART.size * (count + count_before):
        return None
    parts = tuple(TablePart(*numbers) for numbers in PART.iter_unpack(content[TABLE.size :]))
    region, before = Region(start, first, parts[:count]), Region(start_before, first_before, parts[count:])
    return Table(offset, HEAD.size + length, recording_id, region, before)
