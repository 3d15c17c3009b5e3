"""Raw bytes of the link in a recording."""

import struct
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from mcap.opcode import Opcode

from gyrodrift.session.mcap.inspection import inspect
from gyrodrift.session.mcap.layout import MAGIC, READ_HEAD, READS
from gyrodrift.session.mcap.walk import BrokenRecordError, PlacedRecord, Walk, channel_of
from gyrodrift.values.errors import DataError

READ_BODY = struct.Struct("<" + READ_HEAD.format.removeprefix("<BQ"))
"""A read after its record head, up to its bytes."""


class Read(NamedTuple):
    """Bytes of a read of the port, and its Unix time in s."""

    t_host_s: float
    content: bytes


class RawSize(NamedTuple):
    """Number of reads of the port in a recording, and their bytes."""

    reads: int
    total_bytes: int


class _NoRawBytesError(DataError):
    """The recording has no raw bytes."""


def raw_size(path: Path, *, allow_damage: bool = False) -> RawSize | None:
    """Amount of raw bytes in a session; None without any.

    Raises
    ------
    DataError
        The file cannot be read.
    """
    if path.suffix != ".mcap":
        return None
    try:
        sizes = [len(read.content) for read in read_raw(path, allow_damage=allow_damage)]
    except _NoRawBytesError:
        return None
    return RawSize(len(sizes), sum(sizes))


def read_raw(path: Path, *, allow_damage: bool = False) -> Iterator[Read]:
    """Yield the reads of a session in order; with `allow_damage`, the whole reads of a damaged one.

    Raises
    ------
    DataError
        It is no MCAP file, is damaged, or has no raw bytes.
    """
    has_reads = False
    try:
        with path.open("rb") as file:
            if not allow_damage and file.read(len(MAGIC)) != MAGIC:
                raise DataError(f"{path}: is no MCAP file; only MCAP files have raw bytes")
            walk = Walk(file, inspect(file).stretches if allow_damage else None)
            for step in walk:
                match step:
                    case PlacedRecord(opcode=Opcode.CHANNEL):
                        has_reads = has_reads or channel_of(walk.body(step)).topic == READS.name
                    case PlacedRecord(opcode=Opcode.MESSAGE) if has_reads:
                        body = walk.body(step)
                        if int.from_bytes(body[:2], "little") == READS.channel_id and len(body) >= READ_BODY.size:
                            yield _read(body)
                    case PlacedRecord(opcode=Opcode.DATA_END):
                        break
    except OSError as error:
        raise DataError(f"{path}: cannot be read: {error.strerror}") from error
    except BrokenRecordError as error:
        raise DataError(f"{path}: {error}; the file was changed since it was written") from error
    if not has_reads:
        raise _NoRawBytesError(f"{path}: it has no raw bytes; record with --raw")


def _read(body: bytes) -> Read:
    *_, t_host_s, count = READ_BODY.unpack_from(body)
    return Read(t_host_s, body[READ_BODY.size : READ_BODY.size + count])
