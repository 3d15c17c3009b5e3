"""Records of an MCAP file of another program: chunked or not, compressed or not, finished or torn.

The framing is done here, because every length has to be checked against the size of the file. Public packages decode
the contents.
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

from gyrodrift.io.files import opened_limit
from gyrodrift.session.mcap.layout import HEAD, MAGIC, MESSAGE_START
from gyrodrift.session.mcap.walk import BrokenRecordError

RECORD_LIMIT_BYTES = 1 << 30
"""Longest plausible record."""


class ForeignRecord(NamedTuple):
    """A record without its head; the body is shorter if the file was cut off in it."""

    opcode: int
    body: bytes
    is_whole: bool


def records(file: BinaryIO) -> Iterator[ForeignRecord]:
    """Yield all whole records of the data section, also from chunks; checksums are checked."""
    size = os.fstat(file.fileno()).st_size
    file.seek(max(0, size - len(MAGIC)))
    is_torn = file.read(len(MAGIC)) != MAGIC
    file.seek(len(MAGIC))
    crc = zlib.crc32(MAGIC)
    limit_bytes = opened_limit(size)
    for record in framed(file, size, is_torn=is_torn):
        if record.opcode == Opcode.CHUNK:
            content = opened(record, limit_bytes)
            limit_bytes -= len(content)
            yield from filter(_is_whole, framed(BytesIO(content), len(content), is_torn=not record.is_whole))
        elif record.opcode in (Opcode.DATA_END, Opcode.FOOTER):
            _check_end(record, crc)
            return
        elif record.is_whole:
            yield record
        crc = zlib.crc32(record.body, zlib.crc32(HEAD.pack(record.opcode, len(record.body)), crc))


def _is_whole(record: ForeignRecord) -> bool:
    return record.is_whole


def framed(stream: BinaryIO, size: int, *, is_torn: bool) -> Iterator[ForeignRecord]:
    """Consecutive records up to `size`; only a torn stream may end within a record."""
    offset = stream.tell()
    while size - offset >= HEAD.size:
        opcode, length = HEAD.unpack(stream.read(HEAD.size))
        available = size - offset - HEAD.size
        if opcode == 0 and is_torn:  # zeros are left by a power cut
            return
        if length > RECORD_LIMIT_BYTES or (length > available and not is_torn):
            raise BrokenRecordError(f"the record at byte {offset} claims {length} bytes, only {available} follow")
        yield ForeignRecord(opcode, stream.read(min(length, available)), length <= available)
        offset += HEAD.size + length
    if offset < size and not is_torn:
        raise BrokenRecordError("it ends within a record")


def _check_end(record: ForeignRecord, crc: int) -> None:
    """Check the checksum at the end of the data; 0 means none."""
    stated_crc = int.from_bytes(record.body[:4], "little")
    if record.opcode == Opcode.DATA_END and record.is_whole and stated_crc not in (0, crc):
        raise BrokenRecordError("the checksum of its data is wrong")


def opened(record: ForeignRecord, most_bytes: int) -> bytes:
    """Content of a chunk, at most `most_bytes`; the readable part of a torn chunk."""
    try:
        chunk: Chunk = Chunk.read(ReadDataStream(BytesIO(record.body)))
        content = _inflated(chunk, most_bytes)
    except (McapError, ValueError, OverflowError, MemoryError, struct.error) as error:
        if not record.is_whole:
            return b""
        raise BrokenRecordError("a chunk cannot be opened") from error
    except (RuntimeError, zstandard.ZstdError) as error:
        raise BrokenRecordError(f"a chunk cannot be opened: {chunk.compression} refuses it") from error
    if record.is_whole and len(content) != chunk.uncompressed_size:
        raise BrokenRecordError(f"a chunk does not have the {chunk.uncompressed_size} bytes that it claims")
    if record.is_whole and chunk.uncompressed_crc not in (0, zlib.crc32(content)):
        raise BrokenRecordError("the checksum of a chunk is wrong")
    return content


def _inflated(chunk: Chunk, most_bytes: int) -> bytes:
    """Decompressed content of a chunk, at most a byte more than it claims: few bytes can expand to any size."""
    if chunk.uncompressed_size > most_bytes:
        raise BrokenRecordError(f"a chunk claims {chunk.uncompressed_size} bytes, too many for this file")
    most_bytes = chunk.uncompressed_size + 1
    match chunk.compression:
        case "":
            return chunk.data
        case "lz4":
            content: bytes = lz4.frame.LZ4FrameDecompressor().decompress(chunk.data, max_length=most_bytes)
            return content
        case "zstd":
            with zstandard.ZstdDecompressor().stream_reader(chunk.data, read_across_frames=True) as reader:
                return reader.read(most_bytes)
    raise BrokenRecordError(f"a chunk is compressed with {chunk.compression!r}; known are lz4 and zstd")


class Message(NamedTuple):
    """A message without its sequence number and publish time."""

    channel_id: int
    log_ns: int
    payload: bytes


def message(body: bytes) -> Message:
    """Decode the body of a message record."""
    if len(body) < MESSAGE_START.size:
        raise BrokenRecordError(f"a message has {len(body)} bytes, fewer than its head")
    channel_id, _, log_ns, _ = MESSAGE_START.unpack_from(body)
    return Message(channel_id, log_ns, body[MESSAGE_START.size :])


def messages(file: BinaryIO) -> Iterator[Message]:
    """Yield all whole messages of a file."""
    return (message(record.body) for record in records(file) if record.opcode == Opcode.MESSAGE)
