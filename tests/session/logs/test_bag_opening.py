"""Compressed bags: a few bytes that open to gigabytes cost nothing."""

import bz2
from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from typing import Any

import lz4.frame
import pytest
import zstandard

from gyrodrift.session.logs.bag import LimitedOpening, TooLargeError, limited_opening
from gyrodrift.session.tables.parquet import parquet_rows
from gyrodrift.values.errors import DataError

ZEROS = bytes(1 << 20)
PACKED = {
    "bz2": bz2.compress(ZEROS),
    "lz4": lz4.frame.compress(ZEROS),
    "decompress": zstandard.ZstdCompressor().compress(ZEROS),
}


@pytest.mark.promise("Files of other programs")
@pytest.mark.parametrize("kind", PACKED)
def test_compressed_content_has_a_limit_before_it_is_opened(kind: str) -> None:
    """Compressed content of a bag, a Parquet file or an .mcap file has a limit: 16 MiB, or 100 times the file."""
    opening = LimitedOpening(3 << 20)
    for _ in range(3):
        assert getattr(opening, kind)(PACKED[kind]) == ZEROS
    with pytest.raises(TooLargeError, match="above 3 MiB, too much for its size"):
        getattr(opening, kind)(PACKED[kind])


def test_a_compressed_file_has_the_same_limit() -> None:
    with LimitedOpening(3 << 20).open(BytesIO(zstandard.ZstdCompressor().compress(bytes(1 << 22))), "rb") as file:
        assert sum(len(file.read(1 << 16)) for _ in range(48)) == 3 << 20
        with pytest.raises(TooLargeError):
            file.read(1 << 16)


def test_a_parquet_file_is_read_by_its_used_columns(tmp_path: Path) -> None:
    pa, pq = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    pq.write_table(pa.table({"a": [1, 2], "b": ["x", "y"], "c": [[1], [2]]}), tmp_path / "f.parquet")
    assert list(parquet_rows(tmp_path / "f.parquet", [0])) == [(1, ["1", "", ""]), (2, ["2", "", ""])]
    assert list(parquet_rows(tmp_path / "f.parquet", [1, 2])) == [(1, ["", "x", ""]), (2, ["", "y", ""])]


@pytest.mark.parametrize("cells", [{"a": ["x" * (1 << 24)] * 2}, {"a": [0] * 3_000_000}])
def test_a_parquet_file_that_opens_to_too_much_is_refused(tmp_path: Path, cells: dict[str, list[object]]) -> None:
    pa, pq = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    pq.write_table(pa.table(cells), tmp_path / "f.parquet", compression="zstd")
    with pytest.raises(DataError, match="too many for its size"):
        next(parquet_rows(tmp_path / "f.parquet", [0]))


def test_a_damaged_parquet_file_is_an_error_with_its_name(tmp_path: Path) -> None:
    pa, pq = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    path = tmp_path / "f.parquet"
    pq.write_table(pa.table({"a": list(range(20_000))}), path)
    content = bytearray(path.read_bytes())
    content[1000:20_000] = bytes(19_000)
    path.write_bytes(content)
    with pytest.raises(DataError, match=r"f\.parquet: is no Parquet file, or damaged: ."):
        list(parquet_rows(path, [0]))


def test_rosbags_decompresses_within_the_limit_alone() -> None:
    """Chunks of ROS 1, chunks of MCAP, and files and messages of ROS 2; afterwards its own functions are back."""
    ros1: Any = pytest.importorskip("rosbags.rosbag1.reader")
    ros2: Any = pytest.importorskip("rosbags.rosbag2.reader")
    mcap: Any = pytest.importorskip("rosbags.rosbag2.storage_mcap")
    calls: dict[str, Callable[[], Any]] = {
        "bz2 of ROS 1": lambda: ros1.decompressors["bz2"](PACKED["bz2"]),
        "lz4 of ROS 1": lambda: ros1.decompressors["lz4"](PACKED["lz4"]),
        "lz4 of MCAP": lambda: mcap.DECOMPRESSORS["lz4"](PACKED["lz4"], 1 << 20),
        "zstd of MCAP": lambda: mcap.DECOMPRESSORS["zstd"](PACKED["decompress"], 1 << 20),
        "a message of ROS 2": lambda: ros2.zstd.decompress(PACKED["decompress"]),
    }
    for name, call in calls.items():
        with limited_opening(1000), pytest.raises(TooLargeError):
            call()
        assert bytes(call()) == ZEROS, name
