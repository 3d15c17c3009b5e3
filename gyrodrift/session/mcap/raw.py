"""The raw bytes of a link, where a recording kept them."""

import struct
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from mcap.opcode import Opcode

from gyrodrift.errors import DataError
from gyrodrift.session.mcap.layout import MAGIC, READ_HEAD, READS
from gyrodrift.session.mcap.survey import survey
from gyrodrift.session.mcap.walk import BrokenRecordError, PlacedRecord, Walk, channel_of

READ_BODY = struct.Struct("<" + READ_HEAD.format.removeprefix("<BQ"))
"""A read behind its record head, up to its bytes."""


class Read(NamedTuple):
    """What one read of the port gave, and when: Unix time in s."""

    t_host_s: float
    content: bytes


class RawSize(NamedTuple):
    """How much of the link a recording kept: reads of the port, and their bytes."""

    reads: int
    total_bytes: int


class _NoRawBytesError(DataError):
    """A recording that did not keep them."""


def raw_size(path: Path, *, allow_damage: bool = False) -> RawSize | None:
    """How much of the link a session kept; None where it kept nothing of it.

    Raises
    ------
    DataError
        Where the file cannot be read.
    """
    if path.suffix != ".mcap":
        return None
    try:
        sizes = [len(one.content) for one in read_raw(path, allow_damage=allow_damage)]
    except _NoRawBytesError:
        return None
    return RawSize(len(sizes), sum(sizes))


def read_raw(path: Path, *, allow_damage: bool = False) -> Iterator[Read]:
    """The reads of a session in their order, one at a time; of a damaged one, those that are whole, if asked for.

    Raises
    ------
    DataError
        Where it is no MCAP file or damaged, or no raw bytes were kept in it.
    """
    found = False
    try:
        with path.open("rb") as file:
            if not allow_damage and file.read(len(MAGIC)) != MAGIC:
                raise DataError(f"{path}: is no MCAP file; only those keep raw bytes")
            walk = Walk(file, survey(file).stretches if allow_damage else None)
            for step in walk:
                match step:
                    case PlacedRecord(opcode=Opcode.CHANNEL):
                        found = found or channel_of(walk.body(step)).topic == READS.name
                    case PlacedRecord(opcode=Opcode.MESSAGE) if found:
                        body = walk.body(step)
                        if int.from_bytes(body[:2], "little") == READS.channel_id and len(body) >= READ_BODY.size:
                            yield _read(body)
                    case PlacedRecord(opcode=Opcode.DATA_END):
                        break
    except OSError as error:
        raise DataError(f"{path}: cannot be read: {error.strerror}") from error
    except BrokenRecordError as error:
        raise DataError(f"{path}: {error}; the file was changed since it was written") from error
    if not found:
        raise _NoRawBytesError(f"{path}: no raw bytes were kept in it; record with --raw")


def _read(body: bytes) -> Read:
    *_, t_host_s, count = READ_BODY.unpack_from(body)
    return Read(t_host_s, body[READ_BODY.size : READ_BODY.size + count])
