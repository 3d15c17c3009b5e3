"""The records of an MCAP file that others wrote: chunked or not, compressed or not, finished or torn.

They are framed here, because no length in a file is to be believed before it is held against the size of the file;
what stands in them is decoded by the public packages.
"""

import os
import struct
import zlib
from collections.abc import Iterator
from io import BytesIO
from typing import BinaryIO, NamedTuple

import lz4.frame
import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Chunk

from gyrodrift.session.mcap.layout import HEAD, MAGIC

RECORD_LIMIT_BYTES = 1 << 30
"""The largest record that is believed."""

OPENED_BYTES, OPENED_TIMES = 1 << 24, 100
"""Chunks of a file may open to so many bytes, or to so many times its size: samples have noise and shrink tenfold."""

MESSAGE_HEAD = struct.Struct("<HIQQ")
"""What a message begins with: channel, sequence, log and publish time in ns."""


class DamageError(Exception):
    """Something in the file contradicts itself."""


class ForeignRecord(NamedTuple):
    """A record without its head; the body is shorter than it was where the file was cut off in it."""

    opcode: int
    body: bytes
    is_whole: bool


def records(file: BinaryIO) -> Iterator[ForeignRecord]:
    """Every whole record of the data section from its beginning, those in chunks included; sums are checked."""
    size = os.fstat(file.fileno()).st_size
    file.seek(max(0, size - len(MAGIC)))
    is_torn = file.read(len(MAGIC)) != MAGIC
    file.seek(len(MAGIC))
    crc = zlib.crc32(MAGIC)
    left = max(OPENED_BYTES, OPENED_TIMES * size)
    for record in _framed(file, size, is_torn=is_torn):
        if record.opcode == Opcode.CHUNK:
            content = _opened(record, left)
            left -= len(content)
            yield from filter(_is_whole, _framed(BytesIO(content), len(content), is_torn=not record.is_whole))
        elif record.opcode in (Opcode.DATA_END, Opcode.FOOTER):
            _check_end(record, crc)
            return
        elif record.is_whole:
            yield record
        crc = zlib.crc32(record.body, zlib.crc32(HEAD.pack(record.opcode, len(record.body)), crc))


def _is_whole(record: ForeignRecord) -> bool:
    return record.is_whole


def _framed(stream: BinaryIO, size: int, *, is_torn: bool) -> Iterator[ForeignRecord]:
    """Records one behind the other, up to `size`; only a torn stream may end within one."""
    at = stream.tell()
    while size - at >= HEAD.size:
        opcode, length = HEAD.unpack(stream.read(HEAD.size))
        left = size - at - HEAD.size
        if opcode == 0 and is_torn:  # zeros are what a power cut leaves behind
            return
        if length > RECORD_LIMIT_BYTES or (length > left and not is_torn):
            raise DamageError(f"the record at byte {at} claims to have {length} bytes, {left} are left")
        yield ForeignRecord(opcode, stream.read(min(length, left)), length <= left)
        at += HEAD.size + length
    if at < size and not is_torn:
        raise DamageError("it ends within a record")


def _check_end(record: ForeignRecord, crc: int) -> None:
    """The end of the data may tell the checksum of all before it; 0 tells none."""
    told = int.from_bytes(record.body[:4], "little")
    if record.opcode == Opcode.DATA_END and record.is_whole and told not in (0, crc):
        raise DamageError("the checksum of its data is wrong")


def _opened(record: ForeignRecord, most: int) -> bytes:
    """What is in a chunk, up to `most` bytes; of one that was cut off, as much as can be had."""
    try:
        chunk: Chunk = Chunk.read(ReadDataStream(BytesIO(record.body)))
        content = _inflated(chunk, most)
    except (McapError, ValueError, OverflowError, MemoryError, struct.error) as error:
        if not record.is_whole:
            return b""
        raise DamageError("a chunk cannot be opened") from error
    except (RuntimeError, zstandard.ZstdError) as error:
        raise DamageError(f"a chunk cannot be opened: {chunk.compression} says no") from error
    if record.is_whole and len(content) != chunk.uncompressed_size:
        raise DamageError(f"a chunk has not the {chunk.uncompressed_size} bytes that it claims")
    if record.is_whole and chunk.uncompressed_crc not in (0, zlib.crc32(content)):
        raise DamageError("the checksum of a chunk is wrong")
    return content


def _inflated(chunk: Chunk, most: int) -> bytes:
    """The content of a chunk, never more than a byte beyond what it claims: a few bytes can inflate to anything."""
    if chunk.uncompressed_size > most:
        raise DamageError(f"a chunk claims to have {chunk.uncompressed_size} bytes, more than is believed of this file")
    most = chunk.uncompressed_size + 1
    match chunk.compression:
        case "":
            return chunk.data
        case "lz4":
            content: bytes = lz4.frame.LZ4FrameDecompressor().decompress(chunk.data, max_length=most)
            return content
        case "zstd":
            with zstandard.ZstdDecompressor().stream_reader(chunk.data, read_across_frames=True) as reader:
                return reader.read(most)
    raise DamageError(f"a chunk is compressed with {chunk.compression!r}; known are lz4 and zstd")


class Message(NamedTuple):
    """A message without its sequence number and publish time."""

    channel_id: int
    log_ns: int
    payload: bytes


def message(body: bytes) -> Message:
    """The body of a record of a message, taken apart."""
    if len(body) < MESSAGE_HEAD.size:
        raise DamageError(f"a message has {len(body)} bytes, fewer than its head")
    channel_id, _, log_ns, _ = MESSAGE_HEAD.unpack_from(body)
    return Message(channel_id, log_ns, body[MESSAGE_HEAD.size :])
