"""Limit of the compressed content of a bag: the package rosbags has none, and a few bytes can open to gigabytes."""

from bz2 import BZ2Decompressor
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from io import BytesIO
from typing import Any, BinaryIO, Self
from unittest.mock import patch

import lz4.frame
import zstandard

PIECE_BYTES = 1 << 26
"""Largest chunk or message that is decompressed at once; rosbag writes chunks of 768 KiB."""

Opened = Callable[..., bytes]


class TooLargeError(Exception):
    """The content of a bag is larger than its limit."""


class LimitedOpening:
    """Decompression that stands in for the functions of rosbags, and for its module `zstd`, within one limit."""

    def __init__(self, limit_bytes: int) -> None:
        self._limit_bytes = self._left_bytes = limit_bytes

    def bz2(self, content: bytes) -> bytes:
        """Content of a chunk of ROS 1."""
        return self._counted(BZ2Decompressor().decompress(content, self._most_bytes))

    def lz4(self, content: bytes, _size: int = 0) -> bytes:
        """Content of a chunk of ROS 1 or MCAP."""
        return self._counted(lz4.frame.LZ4FrameDecompressor().decompress(content, self._most_bytes))

    def decompress(self, content: bytes, _size: int = 0) -> bytes:
        """Content of a message of ROS 2 or a chunk of MCAP, by zstd."""
        with zstandard.ZstdDecompressor().stream_reader(BytesIO(content), read_across_frames=True) as reader:
            return self._counted(reader.read(self._most_bytes))

    def open(self, file: BinaryIO, _mode: str) -> "_LimitedFile":
        """Content of a file of ROS 2, by zstd."""
        stream = zstandard.ZstdDecompressor().stream_reader(file, read_across_frames=True, closefd=False)
        return _LimitedFile(stream, self._counted)

    @property
    def _most_bytes(self) -> int:
        """Bytes to decompress at once, one more than are allowed."""
        return min(self._left_bytes, PIECE_BYTES) + 1

    def _counted(self, content: bytes) -> bytes:
        self._left_bytes -= len(content)
        if self._left_bytes < 0 or len(content) > PIECE_BYTES:
            most_bytes = min(self._limit_bytes, PIECE_BYTES)
            raise TooLargeError(f"it has compressed content above {most_bytes >> 20} MiB, too much for its size")
        return content


class _LimitedFile:
    def __init__(self, stream: Any, counted: Callable[[bytes], bytes]) -> None:
        self._stream, self._counted = stream, counted

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._stream.close()

    def read(self, count: int) -> bytes:
        """The next bytes."""
        return self._counted(self._stream.read(count))


@contextmanager
def limited_opening(limit_bytes: int) -> Iterator[None]:
    """Let rosbags decompress at most so many bytes within the block."""
    from rosbags.rosbag1 import reader as ros1
    from rosbags.rosbag2 import reader as ros2
    from rosbags.rosbag2 import storage_mcap

    limited = LimitedOpening(limit_bytes)
    ros1_kinds: dict[str, Opened] = {"bz2": limited.bz2, "lz4": limited.lz4}
    mcap_kinds: dict[str, Opened] = {"lz4": limited.lz4, "zstd": limited.decompress}
    with ExitStack() as patches:
        patches.enter_context(patch.dict(ros1.decompressors, ros1_kinds))
        patches.enter_context(patch.dict(storage_mcap.DECOMPRESSORS, mcap_kinds))
        patches.enter_context(patch.object(ros2, "zstd", limited))
        yield
