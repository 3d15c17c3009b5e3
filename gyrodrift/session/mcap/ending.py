"""End of a session file: whether it was closed, its checksums, and locks of files being written.

Light, because every recording first examines its folder.
"""

import os
import struct
import zlib
from collections.abc import Iterator
from contextlib import suppress
from enum import Enum
from pathlib import Path
from typing import IO

from mcap.opcode import Opcode

from gyrodrift.io.system import lock_file, read_at
from gyrodrift.session.mcap.layout import CLOSED_TAIL, CLOSED_TAIL_BYTES, HEAD, MAGIC
from gyrodrift.values.errors import DataError

FOOTER = struct.Struct("<QQI")
DATA_END = HEAD.pack(Opcode.DATA_END, 4)
DATA_END_BYTES = len(DATA_END) + 4
BLOCK_BYTES = 1 << 20
BYTES_PER_ALLOCATED = 512
MOST_HOLES_BYTES = 1 << 28
"""A file with larger holes was never a recording, and reading the holes would take hours."""

MOST_BARE_BYTES = 1 << 16
"""Largest file of zeros that a power cut leaves of a short recording, bytes."""


class Ending(Enum):
    """Result of the check of a file against its end."""

    INTACT = "every checksum is right"
    DAMAGED = "a checksum is wrong"
    UNCHECKED = "there is no checksum"
    OPEN = "the file was never closed"


def ending_of(file: IO[bytes]) -> Ending:
    """Check the whole file against its end."""
    if not is_closed(file):
        return Ending.OPEN
    fd, status = file.fileno(), os.fstat(file.fileno())
    if status.st_size - status.st_blocks * BYTES_PER_ALLOCATED > MOST_HOLES_BYTES:
        return Ending.DAMAGED
    footer_offset, data_end_offset = status.st_size - CLOSED_TAIL_BYTES, data_end_of(file)
    if not len(MAGIC) <= data_end_offset <= footer_offset - DATA_END_BYTES:
        return Ending.DAMAGED
    data_end = read_at(fd, DATA_END_BYTES, data_end_offset)
    footer = read_at(fd, HEAD.size + FOOTER.size, footer_offset)
    *_, summary_crc = FOOTER.unpack_from(footer, HEAD.size)
    actual_crc = zlib.crc32(footer[:-4], crc_of(file, data_end_offset + DATA_END_BYTES, footer_offset))
    if not data_end.startswith(DATA_END) or summary_crc not in (0, actual_crc):
        return Ending.DAMAGED
    data_crc = int.from_bytes(data_end[len(DATA_END) :], "little")
    if not data_crc:
        return Ending.UNCHECKED
    return Ending.INTACT if data_crc == crc_of(file, 0, data_end_offset) else Ending.DAMAGED


def data_end_of(file: IO[bytes]) -> int:
    """Offset of the end of the data of a closed file, from its footer."""
    footer_offset = os.fstat(file.fileno()).st_size - CLOSED_TAIL_BYTES
    start, *_ = FOOTER.unpack(read_at(file.fileno(), FOOTER.size, footer_offset + HEAD.size))
    return int(start or footer_offset) - DATA_END_BYTES


def crc_of(file: IO[bytes], start: int, stop: int) -> int:
    """CRC-32 of the bytes from `start` to before `stop`."""
    crc = 0
    while start < stop and (block := read_at(file.fileno(), min(BLOCK_BYTES, stop - start), start)):
        crc = zlib.crc32(block, crc)
        start += len(block)
    return crc


def is_closed(file: IO[bytes]) -> bool:
    """Whether a file ends like a finished MCAP file."""
    size = os.fstat(file.fileno()).st_size
    tail = read_at(file.fileno(), CLOSED_TAIL_BYTES, max(0, size - CLOSED_TAIL_BYTES))
    return tail.startswith(CLOSED_TAIL) and tail.endswith(MAGIC)


def is_bare(file: IO[bytes]) -> bool:
    """Whether a recording was cut off before its first record: nothing or zeros after the magic bytes.

    Such a file is not touched, because another program may be about to write it.
    """
    head = read_at(file.fileno(), MOST_BARE_BYTES + 1, 0)
    return len(head) <= MOST_BARE_BYTES and MAGIC.startswith(head.rstrip(b"\0"))


def lock(path: Path, file: IO[bytes]) -> None:
    """Lock a file for writing or repair by this process only, until it is closed.

    Raises
    ------
    DataError
        Another process has the lock.
    """
    try:
        lock_file(file, wait=False)
    except BlockingIOError:
        raise DataError(f"{path}: is being written by another process") from None


def interrupted(folder: Path) -> Iterator[Path]:
    """Yield the `.mcap` files of a folder that were never closed and are not being written.

    Files that cannot be read or disappear meanwhile are skipped.
    """
    for path in sorted(folder.glob("*.mcap")):
        is_left_open = False
        with suppress(OSError):
            is_left_open = path.is_file() and _is_left_open(path)
        if is_left_open:
            yield path


def _is_left_open(path: Path) -> bool:
    with path.open("rb") as file:
        if is_closed(file) or is_bare(file):
            return False
        try:
            lock(path, file)
        except DataError:
            return False
        return True
