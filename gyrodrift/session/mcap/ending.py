"""Check of an MCAP file against the checksums at its end."""

import os
import struct
import zlib
from enum import Enum
from typing import IO

from mcap.opcode import Opcode

from gyrodrift.io.system import read_at
from gyrodrift.session.mcap.interrupted import is_closed
from gyrodrift.session.mcap.layout import CLOSED_TAIL_BYTES, HEAD, MAGIC

FOOTER = struct.Struct("<QQI")
DATA_END = HEAD.pack(Opcode.DATA_END, 4)
DATA_END_BYTES = len(DATA_END) + 4
BLOCK_BYTES = 1 << 20
BYTES_PER_ALLOCATED = 512
MOST_HOLES_BYTES = 1 << 28
"""A file with larger holes was never a recording, and reading the holes would take hours."""


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
