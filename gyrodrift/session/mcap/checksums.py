"""Checksums of short parts of a session file, so that damage costs only the samples that it hits.

The checksum at the end of an MCAP file only says that something is damaged. Therefore a table follows every few hundred
kilobytes or every flush, with a CRC-32 for every 24 samples before it. It is a record with a private opcode, which MCAP
readers skip. The next table repeats it. A table does not depend on its position: bytes before it may be missing or
doubled.
"""

import struct
import zlib
from dataclasses import dataclass
from typing import NamedTuple

from gyrodrift.session.mcap.layout import HEAD, MESSAGE

OPCODE = 0x93
"""In the range of the MCAP specification for applications, 0x80 to 0xFF."""

MARKER = b"gdcrc\x1a\x00\x01"
"""Marks a table for a search; the last byte is the version of the layout."""

PIECE_SAMPLES = 24
"""About 2 KiB (3 KiB with three axes), so that a damaged block of a disk (4 KiB) costs at most 96 samples."""

TABLE_SAMPLES = 128 * PIECE_SAMPLES
"""A table follows after at most this many samples."""

LEAST_BYTES = 4096
"""Fewer bytes wait for the next flush; at low rates tables would be as large as the samples."""

ID_BYTES = 8
TABLE = struct.Struct(f"<8s{ID_BYTES}sQQIQQI")
"""Marker, recording, then first byte, number of the first sample and pieces, of this and of the previous table."""
PIECE = struct.Struct("<III")
CRC_BYTES = 4
LONGEST_TABLE_BYTES = 1 << 20


class Piece(NamedTuple):
    """Consecutive whole records: bytes, samples (0 for other records), CRC-32."""

    length: int
    samples: int
    crc: int


@dataclass(frozen=True, slots=True)
class Region:
    """The part of a file that a table covers.

    start
        Offset of its start when it was written, bytes.
    first_sample
        Number of samples before it.
    """

    start: int
    first_sample: int
    pieces: tuple[Piece, ...]

    @property
    def stop(self) -> int:
        """Offset of its table when it was written."""
        return self.start + sum(piece.length for piece in self.pieces)

    @property
    def samples(self) -> int:
        """Number of samples in it."""
        return sum(piece.samples for piece in self.pieces)


@dataclass(frozen=True, slots=True)
class Table:
    """A table in a file, with the previous region; `size` is the size of the whole record."""

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
        """A writer that continues after a table."""
        writer = cls(table.recording_id)
        writer._start = table.region.stop + table.size
        writer._first_sample = table.region.first_sample + table.region.samples
        writer._before = table.region
        return writer

    @property
    def is_due(self) -> bool:
        """Whether enough bytes were added for a table."""
        return self._pending_bytes >= LEAST_BYTES

    @property
    def is_pending(self) -> bool:
        """Whether bytes were added since the last table."""
        return bool(self._pieces)

    def add_samples(self, rows: bytes, row_bytes: int = MESSAGE.size) -> None:
        """Add samples of `row_bytes` each; samples of several flushes share a piece."""
        view, first = memoryview(rows), 0
        last = self._pieces[-1] if self._pieces else None
        if last is not None and 0 < last.samples < PIECE_SAMPLES:
            first = (PIECE_SAMPLES - last.samples) * row_bytes
            part = view[:first]
            samples = last.samples + len(part) // row_bytes
            self._pieces[-1] = Piece(last.length + len(part), samples, zlib.crc32(part, last.crc))
        for start in range(first, len(view), PIECE_SAMPLES * row_bytes):
            part = view[start : start + PIECE_SAMPLES * row_bytes]
            self._pieces.append(Piece(len(part), len(part) // row_bytes, zlib.crc32(part)))
        self._samples += len(rows) // row_bytes
        self._pending_bytes += len(rows)

    def add_records(self, content: bytes) -> None:
        """Add records that are no samples."""
        self._pieces.append(Piece(len(content), 0, zlib.crc32(content)))
        self._pending_bytes += len(content)

    def table(self) -> bytes:
        """The table record for the bytes since the last one."""
        region = Region(self._start, self._first_sample, tuple(self._pieces))
        record = encoded_table(self._id, region, self._before)
        self._start = region.stop + len(record)
        self._first_sample += self._samples
        self._samples = self._pending_bytes = 0
        self._pieces.clear()
        self._before = region
        return record


def encoded_table(recording_id: bytes, region: Region, before: Region) -> bytes:
    """A table as bytes of its record."""
    numbers = [n for part in (region, before) for n in (part.start, part.first_sample, len(part.pieces))]
    body = TABLE.pack(MARKER, recording_id, *numbers)
    body += b"".join(PIECE.pack(*piece) for part in (region, before) for piece in part.pieces)
    return HEAD.pack(OPCODE, len(body) + CRC_BYTES) + body + zlib.crc32(body).to_bytes(CRC_BYTES, "little")


def table_of(record: bytes) -> Table | None:
    """Table at the start of bytes, record head included; None without one, or if it is damaged."""
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
