"""Records of a session file that their checksums prove, wherever the bytes are now."""

import re
from collections.abc import Iterator
from itertools import pairwise
from typing import IO, NamedTuple

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from gyrodrift.io.system import read_at
from gyrodrift.session.mcap.layout import CRC_BYTES, HEAD, SEAL, SEAL_BYTES, SEAL_START, seal
from gyrodrift.session.mcap.rows import CRC, ROW_SIZES, ROWS, checksums, row_start
from gyrodrift.session.mcap.walk import data_blocks

LEAST_VOTES = 2
"""Checksums that must agree on a salt: two agree by chance once in 2^32 files."""

SEALED_TIMES = 4
"""Bytes of all seals to check, times the size of the file: sealed records do not overlap, but any bytes may say so."""

CANDIDATE = np.dtype([("offset", "i8"), ("number", "i8"), ("size", "i8"), ("salt", "u4")])
"""A possible sample: offset, number in the file, size in bytes, and the salt with which its checksum is right."""


CHECKED_ROWS = [row for row in ROWS.values() if CRC in (row.names or ())]
CHECKED_START = re.compile(b"|".join(re.escape(row_start(row)) for row in CHECKED_ROWS))
"""First bytes of a sample with a checksum."""


class Piece(NamedTuple):
    """Consecutive whole records: offsets in the file, number of samples before them, and number of samples in them."""

    start: int
    stop: int
    first_sample: int
    samples: int


class Proofs(NamedTuple):
    """Proven records of a file.

    pieces
        Records in the order of writing.
    samples
        Number of samples that were written, as far as it is known.
    record_losses
        Numbers of samples before each loss of other records.
    salt, seals
        Salt of the recording, and number of its seals; None for a file of an earlier version.
    """

    pieces: list[Piece]
    samples: int
    record_losses: list[int]
    salt: int | None = None
    seals: int = 0


class _Seal(NamedTuple):
    number: int
    piece: Piece
    salt: int


def checked_proofs(file: IO[bytes], size: int) -> Proofs | None:
    """Samples with right checksums and records with right seals; None if no two checksums agree on a salt."""
    row_tables: list[NDArray[np.void]] = [np.empty(0, CANDIDATE)]
    seals: list[_Seal] = []
    left_bytes = SEALED_TIMES * size
    for offset, block in data_blocks(file, 0, size, max(ROW_SIZES) - 1):
        row_tables += _rows_in(block, offset)
        for possible in _seals_in(block, offset):
            left_bytes -= possible.stop - possible.start
            if left_bytes >= 0:
                seals += _checked_seal(file, possible)
    rows = np.concatenate(row_tables)
    salt = _salt(rows, seals)
    if salt is None:
        return None
    first_copies: dict[int, Piece] = {}
    for number, piece in sorted(found_seal[:2] for found_seal in seals if found_seal.salt == salt):
        first_copies.setdefault(number, piece)
    runs = _runs(rows[rows["salt"] == salt])
    pieces = sorted([*first_copies.values(), *runs], key=lambda piece: (piece.first_sample, piece.samples > 0))
    samples = max(piece.first_sample + piece.samples for piece in pieces)
    return Proofs(pieces, samples, list(_record_losses(first_copies)), salt, max(first_copies, default=-1) + 1)


def _salt(rows: NDArray[np.void], seals: list[_Seal]) -> int | None:
    """Salt of the recording: that of the seal of its header, which no device can imitate, or else the most frequent."""
    salts = np.concatenate([rows["salt"], np.array([found_seal.salt for found_seal in seals], np.uint32)])
    values, votes = np.unique(salts, return_counts=True)
    of_header = next((found_seal.salt for found_seal in seals if found_seal.piece.start == 0), None)
    if of_header is not None and np.count_nonzero(salts == of_header) >= LEAST_VOTES:
        return of_header
    return int(values[votes.argmax()]) if len(votes) and votes.max() >= LEAST_VOTES else None


def _rows_in(block: bytes, offset: int) -> Iterator[NDArray[np.void]]:
    """Possible samples of a block that begins at `offset`."""
    octets = np.frombuffer(block, np.uint8)
    starts = np.array([match.start() for match in CHECKED_START.finditer(block)], np.int64)
    sizes = octets[starts + 1] + HEAD.size  # the length of a sample takes one byte
    for layout in CHECKED_ROWS:
        size = layout.itemsize
        indices = starts[(sizes == size) & (starts <= len(block) - size)]
        if len(indices):
            rows = sliding_window_view(octets, size)[indices].view(layout).ravel()
            candidates = np.empty(len(rows), CANDIDATE)
            candidates["offset"], candidates["number"] = offset + indices, rows["sequence"]
            candidates["size"], candidates["salt"] = size, rows[CRC] ^ checksums(rows)
            yield candidates


def _seals_in(block: bytes, offset: int) -> Iterator[Piece]:
    """Possible seals of a block that begins at `offset`, with their records."""
    for match in re.finditer(re.escape(SEAL_START), block):
        index = match.start()
        if index + SEAL_BYTES <= len(block):
            *_, length, samples = SEAL.unpack_from(block, index)
            if length <= offset + index:
                yield Piece(offset + index - length, offset + index + SEAL_BYTES, samples, 0)


def _checked_seal(file: IO[bytes], piece: Piece) -> Iterator[_Seal]:
    """The seal of a piece, with the salt with which it is right; none if the file changes meanwhile."""
    content = read_at(file.fileno(), piece.stop - piece.start, piece.start)
    if len(content) == piece.stop - piece.start:
        records, own = content[:-SEAL_BYTES], content[-SEAL_BYTES:]
        _, _, number, _, samples = SEAL.unpack_from(own)
        unsalted = seal(number, records, samples, 0)
        yield _Seal(number, piece, _crc_in(own) ^ _crc_in(unsalted))


def _crc_in(content: bytes) -> int:
    return int.from_bytes(content[-CRC_BYTES:], "little")


def _runs(rows: NDArray[np.void]) -> Iterator[Piece]:
    """Samples in order of their numbers as runs; of a sample that comes twice the first copy."""
    numbers, first = np.unique(rows["number"], return_index=True)
    offsets, sizes = rows["offset"][first], rows["size"][first]
    breaks = np.flatnonzero((np.diff(offsets) != sizes[:-1]) | (np.diff(numbers) != 1)) + 1
    if len(numbers):
        for start, stop in pairwise([0, *breaks.tolist(), len(numbers)]):
            yield Piece(
                int(offsets[start]), int(offsets[stop - 1] + sizes[stop - 1]), int(numbers[start]), stop - start
            )


def _record_losses(seals: dict[int, Piece]) -> Iterator[int]:
    """Number of samples up to the seal before each lost one."""
    expected = samples = 0
    for number, piece in seals.items():
        if number > expected:
            yield samples
        expected, samples = number + 1, piece.first_sample
