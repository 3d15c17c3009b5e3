"""Whether the checksums at the end of an MCAP file agree with what stands before it."""

import os
import struct
import zlib
from enum import Enum
from typing import IO

from mcap.opcode import Opcode

from gyrodrift.session.mcap.interrupted import is_closed
from gyrodrift.session.mcap.layout import CLOSED_TAIL_BYTES, HEAD, MAGIC
from gyrodrift.system import read_at

FOOTER = struct.Struct("<QQI")
DATA_END = HEAD.pack(Opcode.DATA_END, 4)
DATA_END_BYTES = len(DATA_END) + 4
BLOCK_BYTES = 1 << 20
BYTES_PER_ALLOCATED = 512
MOST_HOLES_BYTES = 1 << 28
"""A file of more holes was never written as a recording, and reading them would take hours."""


class Ending(Enum):
    """What the end of a file says of the bytes before it."""

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
    footer_at, data_end_at = status.st_size - CLOSED_TAIL_BYTES, data_end_of(file)
    if not len(MAGIC) <= data_end_at <= footer_at - DATA_END_BYTES:
        return Ending.DAMAGED
    data_end = read_at(fd, DATA_END_BYTES, data_end_at)
    footer = read_at(fd, HEAD.size + FOOTER.size, footer_at)
    *_, summary_crc = FOOTER.unpack_from(footer, HEAD.size)
    found_crc = zlib.crc32(footer[:-4], crc_of(file, data_end_at + DATA_END_BYTES, footer_at))
    if not data_end.startswith(DATA_END) or summary_crc not in (0, found_crc):
        return Ending.DAMAGED
    data_crc = int.from_bytes(data_end[len(DATA_END) :], "little")
    if not data_crc:
        return Ending.UNCHECKED
    return Ending.INTACT if data_crc == crc_of(file, 0, data_end_at) else Ending.DAMAGED


def data_end_of(file: IO[bytes]) -> int:
    """Where the data of a closed file ends, as its footer says."""
    footer_at = os.fstat(file.fileno()).st_size - CLOSED_TAIL_BYTES
    start, *_ = FOOTER.unpack(read_at(file.fileno(), FOOTER.size, footer_at + HEAD.size))
    return int(start or footer_at) - DATA_END_BYTES


def crc_of(file: IO[bytes], start: int, stop: int) -> int:
    """CRC-32 of the bytes from one place to before another."""
    crc = 0
    while start < stop and (block := read_at(file.fileno(), min(BLOCK_BYTES, stop - start), start)):
        crc = zlib.crc32(block, crc)
        start += len(block)
    return crc
