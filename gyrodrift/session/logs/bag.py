"""Bags of ROS 1 (.bag) and ROS 2 (a folder with .db3 files): `sensor_msgs/Imu` through the package rosbags.

The package does not limit compressed content, and a few bytes can open to gigabytes, so it is limited here.
"""

from bz2 import BZ2Decompressor
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from io import BytesIO
from pathlib import Path
from typing import Any, BinaryIO, Self
from unittest.mock import patch

import lz4.frame
import zstandard

from gyrodrift.io.files import UnreadableError, check_ordinary, opened_limit, read_ordinary
from gyrodrift.io.installation import packages_of
from gyrodrift.session.foreign.columns import Decode
from gyrodrift.session.foreign.read import sample_rows, session_of_rows
from gyrodrift.session.foreign.ros import imu_sample, ros1_imu_sample
from gyrodrift.session.session import Session
from gyrodrift.values.errors import DataError
from gyrodrift.values.sample import Sample

IMU = "sensor_msgs/msg/Imu"
METADATA, LONGEST_METADATA_BYTES = "metadata.yaml", 1 << 20
"""Largest metadata.yaml; one of a hundred topics has 50 kB. Its reader needs a second for so many bytes."""

ROS1_MAGIC = b"#ROSBAG V"

PIECE_BYTES = 1 << 26
"""Largest chunk or message that is decompressed at once; rosbag writes chunks of 768 KiB."""

Opened = Callable[..., bytes]


def read_bag(path: Path, topic: str | None = None) -> Session:
    """Load rates and accelerations from the `sensor_msgs/Imu` messages of a bag.

    Parameters
    ----------
    path
        `.bag`, a folder of a bag, or a `.db3` in one.
    topic
        Topic to read; without it the only one with such messages.

    Raises
    ------
    DataError
        It is no bag or damaged, has no or several possible topics, or `rosbags` is missing.
    """
    with opened_bag(path) as reader:
        decode = ros1_imu_sample if is_ros1(path) else _ros2_decode()
        rows = sample_rows(_samples(reader, _chosen(path, reader, topic), decode))
    if not len(rows):
        raise DataError(f"{path}: has no samples")
    return session_of_rows(path.stem, rows, is_imu=True)


@contextmanager
def opened_bag(path: Path) -> Iterator[Any]:
    """Open a bag, and turn what can go wrong while it is read into an error for the user.

    Raises
    ------
    DataError
        It is no bag or damaged, or `rosbags` is missing.
    """
    try:
        with _opened(path) as reader:
            yield reader
    except DataError:
        raise
    except UnreadableError as error:
        raise DataError(f"{path}: {error}") from error
    except MemoryError as error:
        raise DataError(f"{path}: needs more memory than this computer has") from error
    except Exception as error:  # bytes from anywhere
        raise DataError(f"{path}: is no bag, or damaged: {error}") from error


@contextmanager
def _opened(path: Path) -> Iterator[Any]:
    """The opened reader of a bag of limited size."""
    unopened = _reader_of(path)
    with limited_opening(opened_limit(_checked_size(path))), unopened as reader:
        yield reader


def _checked_size(path: Path) -> int:
    """Size of a bag in bytes, after the check of the files that its reader may open.

    Raises
    ------
    UnreadableError
        Its metadata are too large, or a file of it is no ordinary one.
    """
    if is_ros1(path):
        return path.stat().st_size
    folder = _folder_of(path)
    try:
        read_ordinary(folder / METADATA, LONGEST_METADATA_BYTES)
    except UnreadableError as error:
        raise UnreadableError(f"its {METADATA} {error}") from error
    for file in folder.iterdir():
        check_ordinary(file)
    return sum(file.stat().st_size for file in folder.iterdir() if file.is_file())


def _folder_of(path: Path) -> Path:
    return path.parent if path.suffix.lower() == ".db3" else path


def is_ros1(path: Path) -> bool:
    """Whether a bag is one of ROS 1, by its ending."""
    return path.suffix.lower() == ".bag"


def deserializer(*, is_ros1: bool) -> Callable[[bytes, str], Any]:
    """Decoder of messages of standard types, by their bytes and type; what a file says about its types is not parsed.

    The layout of messages is the same in every release of ROS 2.
    """
    from rosbags.typesys import Stores, get_typestore

    if is_ros1:
        ros1: Callable[[bytes, str], Any] = get_typestore(Stores.ROS1_NOETIC).deserialize_ros1
        return ros1
    ros2: Callable[[bytes, str], Any] = get_typestore(Stores.ROS2_HUMBLE).deserialize_cdr
    return ros2


def _check_beginning(path: Path) -> None:
    """Check the beginning of a ROS 1 bag; its reader would search the whole file for the end of the first line."""
    if not is_ros1(path):
        return
    with path.open("rb") as file:
        if file.read(len(ROS1_MAGIC)) != ROS1_MAGIC:
            raise DataError(f"{path}: is no bag of ROS 1: it does not begin with {ROS1_MAGIC.decode()}")


def _reader_of(path: Path) -> Any:
    """Reader of a bag that does not parse its message definitions, which may be any text.

    Raises
    ------
    DataError
        It does not begin as a bag, is a part of one, or `rosbags` is missing.
    """
    folder = _folder_of(path)
    if path.suffix.lower() == ".db3" and not (folder / METADATA).is_file():
        raise DataError(f"{path}: there is no metadata.yaml beside it; give the folder of the bag as ros2 bag wrote it")
    with packages_of(path, "ros"):
        from rosbags import rosbag1, rosbag2
    _check_beginning(path)
    return rosbag1.Reader(folder) if is_ros1(path) else rosbag2.Reader(folder)


def _chosen(path: Path, reader: Any, topic: str | None) -> list[Any]:
    """Connections to read."""
    imus = sorted(
        {connection.topic for connection in reader.connections if connection.msgtype == IMU and connection.msgcount}
    )
    topics = (
        ", ".join(sorted(f"{connection.topic} ({connection.msgtype})" for connection in reader.connections))
        or "nothing"
    )
    if topic is not None and topic not in imus:
        raise DataError(f"{path}: {topic} holds no {IMU}; topics are {topics}")
    if not imus:
        raise DataError(f"{path}: no topic holds {IMU}; topics are {topics}")
    if topic is None and len(imus) > 1:
        raise DataError(f"{path}: samples may be on {', '.join(imus)}; choose one with gyrodrift convert --topic")
    chosen = topic or imus[0]
    return [connection for connection in reader.connections if connection.topic == chosen and connection.msgtype == IMU]


def _samples(reader: Any, connections: list[Any], decode: Decode) -> Iterator[Sample]:
    for _, log_ns, payload in reader.messages(connections=connections):
        yield decode(bytes(payload), log_ns)


def _ros2_decode() -> Decode:
    """Decoder of CDR messages."""
    decode = deserializer(is_ros1=False)
    return lambda payload, log_ns: imu_sample(decode(payload, IMU), log_ns)


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
