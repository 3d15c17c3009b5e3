"""Checksums of short stretches of a session file, so that damage costs the samples it hits and no others.

The checksum at the end of an MCAP file says only that something in it is damaged. So a record of a private opcode,
which readers of MCAP pass over, follows every few hundred kilobytes or every flush. It is a table of the bytes before
it, a CRC-32 for every 24 samples. Each table stands twice: once behind its bytes, once more in the table that follows.
Nothing in a table depends on where it is found, so bytes may be missing or stand twice in front of it.
"""

import struct
import zlib
from dataclasses import dataclass
from typing import NamedTuple

from gyrodrift.session.mcap.layout import HEAD, MESSAGE

OPCODE = 0x93
"""In the range that the MCAP specification leaves to applications, 0x80 to 0xFF."""

MARKER = b"gdcrc\x1a\x00\x01"
"""What tables are searched by; the last byte is the version of their layout."""

PIECE_SAMPLES = 24
"""Below 2 KiB, so that a damaged block of a disk (4 KiB) costs at most 96 samples."""

TABLE_BYTES = 128 * PIECE_SAMPLES * MESSAGE.size
"""A table follows after at most so many bytes of samples."""

LEAST_BYTES = 4096
"""Fewer are left to the next flush: at low rates tables would be as large as what they are about."""

ID_BYTES = 8
TABLE = struct.Struct(f"<8s{ID_BYTES}sQQIQQI")
"""Marker, recording, then twice: first byte, number of the first sample, pieces (of this table, of the one before)."""
PIECE = struct.Struct("<III")
CRC_BYTES = 4
LONGEST_TABLE_BYTES = 1 << 20


class Piece(NamedTuple):
    """Whole records in a row: bytes, samples among them (0: other records), CRC-32."""

    length: int
    samples: int
    crc: int


@dataclass(frozen=True, slots=True)
class Region:
    """What one table is about.

    start
        Where it began when it was written, bytes from the beginning of the file.
    first_sample
        Samples of the file before it.
    """

    start: int
    first_sample: int
    pieces: tuple[Piece, ...]

    @property
    def stop(self) -> int:
        """Where its table began when it was written."""
        return self.start + sum(piece.length for piece in self.pieces)

    @property
    def samples(self) -> int:
        """How many it holds."""
        return sum(piece.samples for piece in self.pieces)


@dataclass(frozen=True, slots=True)
class Table:
    """A table as it stands in a file, with the region before its own; `size` is that of the whole record."""

    recording_id: bytes
    region: Region
    before: Region
    size: int


class ChecksumWriter:
    """Collects checksums while a file is written."""

    def __init__(self, recording_id: bytes) -> None:
        self._id = recording_id
        self._start = self._first_sample = 0
        self._samples = self._pending_bytes = 0
        self._pieces: list[Piece] = []
        self._before = Region(0, 0, ())

    @classmethod
    def after(cls, table: Table) -> "ChecksumWriter":
        """One that goes on behind a table."""
        writer = cls(table.recording_id)
        writer._start = table.region.stop + table.size
        writer._first_sample = table.region.first_sample + table.region.samples
        writer._before = table.region
        return writer

    @property
    def is_due(self) -> bool:
        """Whether enough has come for a table."""
        return self._pending_bytes >= LEAST_BYTES

    @property
    def is_pending(self) -> bool:
        """Whether something has come since the last table."""
        return bool(self._pieces)

    def add_samples(self, rows: bytes) -> None:
        """Samples, packed as `layout.MESSAGE`; those of several flushes share a piece."""
        view, at = memoryview(rows), 0
        last = self._pieces[-1] if self._pieces else None
        if last is not None and 0 < last.samples < PIECE_SAMPLES:
            at = (PIECE_SAMPLES - last.samples) * MESSAGE.size
            part = view[:at]
            samples = last.samples + len(part) // MESSAGE.size
            self._pieces[-1] = Piece(last.length + len(part), samples, zlib.crc32(part, last.crc))
        for start in range(at, len(view), PIECE_SAMPLES * MESSAGE.size):
            part = view[start : start + PIECE_SAMPLES * MESSAGE.size]
            self._pieces.append(Piece(len(part), len(part) // MESSAGE.size, zlib.crc32(part)))
        self._samples += len(rows) // MESSAGE.size
        self._pending_bytes += len(rows)

    def add_records(self, content: bytes) -> None:
        """Records that are no samples."""
        self._pieces.append(Piece(len(content), 0, zlib.crc32(content)))
        self._pending_bytes += len(content)

    def table(self) -> bytes:
        """The record that belongs into the file now."""
        region = Region(self._start, self._first_sample, tuple(self._pieces))
        record = encoded_table(self._id, region, self._before)
        self._start = region.stop + len(record)
        self._first_sample += self._samples
        self._samples = self._pending_bytes = 0
        self._pieces.clear()
        self._before = region
        return record


def encoded_table(recording_id: bytes, region: Region, before: Region) -> bytes:
    """A table as it stands in a file."""
    numbers = [n for each in (region, before) for n in (each.start, each.first_sample, len(each.pieces))]
    body = TABLE.pack(MARKER, recording_id, *numbers)
    body += b"".join(PIECE.pack(*piece) for each in (region, before) for piece in each.pieces)
    return HEAD.pack(OPCODE, len(body) + CRC_BYTES) + body + zlib.crc32(body).to_bytes(CRC_BYTES, "little")


def table_of(record: bytes) -> Table | None:
    """The table that bytes begin with, head included; None where there is none or it is damaged."""
    if len(record) < HEAD.size + TABLE.size + CRC_BYTES:
        return None
    opcode, length = HEAD.unpack_from(record)
    body = record[HEAD.size : HEAD.size + length]
    if opcode != OPCODE or len(body) != length or not body.startswith(MARKER):
        return None
    content, crc = body[:-CRC_BYTES], int.from_bytes(body[-CRC_BYTES:], "little")
    _, recording_id, start, first, count, start_before, first_before, count_before = TABLE.unpack_from(content)
    if zlib.crc32(content) != crc or len(content) != TABLE.size + PIECE.size * (count + count_before):
        return None
    pieces = tuple(Piece(*numbers) for numbers in PIECE.iter_unpack(content[TABLE.size :]))
    region, before = Region(start, first, pieces[:count]), Region(start_before, first_before, pieces[count:])
    return Table(recording_id, region, before, HEAD.size + length)
