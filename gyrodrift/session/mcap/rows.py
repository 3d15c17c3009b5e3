"""Samples of a session file as numpy rows, and their checksums."""

import zlib
from functools import cache

import numpy as np
from numpy.typing import NDArray

from gyrodrift.session.mcap.layout import CDR_LITTLE_ENDIAN, CRC_BYTES, HEAD, KINDS, MESSAGE_OPCODE, SAMPLES

CRC = "crc32"
DEVICE_YAW = "device_yaw"
FIELDS: list[tuple[str, str]] = [
    ("opcode", "u1"),
    ("length", "<u8"),
    ("channel", "<u2"),
    ("sequence", "<u4"),
    ("log_time", "<u8"),
    ("publish_time", "<u8"),
    ("cdr", "<u4"),
    ("seq", "<i8"),
    ("t_device_s", "<f8"),
    ("t_host_s", "<f8"),
    ("rate_dps", "<f8"),
    ("encoder_deg", "<f8"),
    ("temp_c", "<f8"),
]

CRC_BLOCK_ROWS = 2048
"""Rows whose bytes, at most 330 kB, fit the second-level cache of a usual processor."""

Rows = NDArray[np.void]
UInts = NDArray[np.uint32]


def _dtype(has_axes: bool, has_device_yaw: bool, has_checksum: bool) -> np.dtype[np.void]:  # noqa: FBT001 - a kind
    wide = [("axes", "<f8", 6)] * has_axes + [(DEVICE_YAW, "<f8", 3)] * has_device_yaw
    return np.dtype([*FIELDS, *wide, *[(CRC, "<u4")] * has_checksum])


ROWS = {kind: _dtype(*kind) for kind in KINDS}
"""A sample in the file by its kind; the same bytes as `layout.LAYOUTS`."""

ROW_SIZES = [row.itemsize for row in ROWS.values()]


def row_start(row: np.dtype[np.void]) -> bytes:
    """First bytes of a sample."""
    return HEAD.pack(MESSAGE_OPCODE, row.itemsize - HEAD.size) + SAMPLES.channel_id.to_bytes(2, "little")


ROW_STARTS = {row_start(row): row for row in ROWS.values()}
"""Layout of a sample by its first bytes."""

ROW_START_BYTES = HEAD.size + 2


def finished(rows: Rows, first: int, salt: int) -> bytes:
    """Bytes of rows after their heads and checksums are filled in; their values are given.

    Parameters
    ----------
    rows
        Samples, shape (n,), of one of `ROWS`.
    first
        Number of samples before them in the file.
    salt
        Salt of the recording.
    """
    rows["opcode"], rows["channel"], rows["cdr"] = MESSAGE_OPCODE, SAMPLES.channel_id, CDR_LITTLE_ENDIAN
    rows["length"] = rows.dtype.itemsize - HEAD.size
    rows["sequence"] = np.arange(first, first + len(rows)) & 0xFFFFFFFF
    rows[CRC] = checksums(rows) ^ np.uint32(salt)
    return rows.tobytes()


def checksums(rows: Rows) -> UInts:
    """CRC-32 of every row without its own checksum, shape (n,), as `zlib.crc32` gives it.

    A CRC is linear: that of a row is the XOR of those of its bytes, each alone in a row of zeros. So numpy takes one
    byte of all rows at a time.
    """
    size = rows.dtype.itemsize - CRC_BYTES
    tables, zeros_crc = _byte_tables(size)
    octets = rows.view(np.uint8).reshape(len(rows), rows.dtype.itemsize)
    crcs = np.full(len(rows), zeros_crc, np.uint32)
    for start in range(0, len(rows), CRC_BLOCK_ROWS):
        part = crcs[start : start + CRC_BLOCK_ROWS]
        columns = np.ascontiguousarray(octets[start : start + CRC_BLOCK_ROWS, :size].T)
        for table, column in zip(tables, columns, strict=True):
            part ^= table.take(column)
    return crcs


@cache
def _byte_tables(size: int) -> tuple[UInts, np.uint32]:
    """Change of the CRC-32 of `size` zeros by a byte, shape (size, 256), and their CRC-32."""
    last: UInts = np.array([zlib.crc32(bytes([byte])) ^ zlib.crc32(b"\0") for byte in range(256)], np.uint32)
    tables = np.empty((size, 256), np.uint32)
    tables[-1] = last
    for index in range(size - 2, -1, -1):  # one more zero behind the byte
        after = tables[index + 1]
        tables[index] = last[after & 0xFF] ^ (after >> np.uint32(8))
    return tables, np.uint32(zlib.crc32(bytes(size)))
