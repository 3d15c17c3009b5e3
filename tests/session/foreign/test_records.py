"""The records of files that others wrote: torn, damaged, and lying ones."""

import json
import struct
from pathlib import Path

import pytest
from foreign_support import (
    CHANNEL,
    CHUNK,
    FORMS,
    MAGIC,
    MESSAGE,
    as_json,
    imu,
    in_json,
    own,
    refused,
    ros,
    rows,
    written,
)
from hypothesis import given
from hypothesis import strategies as st
from mcap.writer import CompressionType

from gyrodrift.session.foreign.read import read_foreign
from gyrodrift.values.errors import DataError


@pytest.mark.parametrize("form", FORMS)
def test_a_file_cut_off_anywhere_keeps_its_beginning(tmp_path: Path, form: str) -> None:
    values = rows(60)
    content = own(values, **FORMS[form])
    observed = 0
    for length in range(len(MAGIC), len(content), 37 if form != "unchunked" else 5):
        path = written(tmp_path, content[:length])
        try:
            session = read_foreign(path)
        except DataError as error:
            assert str(error) == f"{path}: has no samples"  # noqa: PT017 - the beginning has none, and that is fine
            assert observed == 0
            continue
        count = len(session.rate_dps)
        assert count >= observed
        assert session.rate_dps.tolist() == [row["rate_dps"] for row in values[:count]]
        observed = count
    assert observed == 60


def test_a_cut_in_a_chunk_costs_the_messages_behind_it(tmp_path: Path) -> None:
    values = rows(20_000)
    for compression, least in ((CompressionType.NONE, 9_000), (CompressionType.LZ4, 6_000)):
        content = own(values, chunk_size=1 << 30, compression=compression)
        start = place_of(content, CHUNK)
        length = int.from_bytes(content[start + 1 : start + 9], "little")
        session = read_foreign(written(tmp_path, content[: start + length // 2]))
        assert least < len(session.rate_dps) < 20_000
        assert session.rate_dps.tolist() == [row["rate_dps"] for row in values[: len(session.rate_dps)]]


def test_zeros_behind_a_cut_are_passed_over(tmp_path: Path) -> None:
    """A power cut may leave them."""
    content = own(rows(60), use_chunking=False)
    session = read_foreign(written(tmp_path, content[:4000] + b"\0" * 3000))
    assert 10 < len(session.rate_dps) < 60


def place_of(content: bytes, expected: int) -> int:
    index = len(MAGIC)
    while content[index] != expected:
        index += 9 + int.from_bytes(content[index + 1 : index + 9], "little")
    return index


def changed(content: bytes, position: int, fresh: bytes) -> bytes:
    return content[:position] + fresh + content[position + len(fresh) :]


CHUNKED = {form: own(rows(60), **FORMS[form]) for form in ("stored", "lz4", "zstd")}
PLAIN, BARE = own(rows(60), **FORMS["unchunked"]), own(rows(60), **FORMS["bare"])
LAST = b"\xff" * 8


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "is no MCAP file: it does not begin as one"),
        (b"t_device_s,rate_dps\n", "is no MCAP file: it does not begin as one"),
        (MAGIC, "has no samples"),
        (MAGIC + b"\xff" * 100, "the record at byte 8 claims 18446744073709551615 bytes, only 91 follow"),
        (changed(PLAIN, place_of(PLAIN, MESSAGE) + 1, b"\0" * 8), "a message has 0 bytes, fewer than its head"),
        (changed(PLAIN, place_of(PLAIN, MESSAGE) + 1, struct.pack("<Q", 1 << 20)), "claims 1048576 bytes"),
        (changed(PLAIN, place_of(PLAIN, MESSAGE) + 60, b"\x01"), "the checksum of its data is wrong"),
        (changed(BARE, place_of(BARE, MESSAGE) + 9, b"\7"), "has messages of channel 7, which is not declared"),
        (changed(BARE, place_of(BARE, CHANNEL) + 11, b"\7"), "/gyro has schema 7, which is not declared"),
        (changed(PLAIN, place_of(PLAIN, CHANNEL) + 13, b"\xff\xff\xff\xff"), "a record Channel is damaged"),
        (
            changed(CHUNKED["stored"], place_of(CHUNKED["stored"], CHUNK) + 400, b"\x55"),
            "the checksum of a chunk is wrong",
        ),
        (
            changed(CHUNKED["lz4"], place_of(CHUNKED["lz4"], CHUNK) + 60, LAST),
            "a chunk cannot be opened: lz4 refuses it",
        ),
        (
            changed(CHUNKED["zstd"], place_of(CHUNKED["zstd"], CHUNK) + 60, LAST),
            "a chunk cannot be opened: zstd refuses it",
        ),
        (changed(CHUNKED["zstd"], place_of(CHUNKED["zstd"], CHUNK) + 25, LAST), "a chunk claims 1844674407370955"),
        (
            changed(CHUNKED["lz4"], place_of(CHUNKED["lz4"], CHUNK) + 25, b"\7\0\0\0"),
            "does not have the 7 bytes that it claims",
        ),
        (
            changed(CHUNKED["lz4"], place_of(CHUNKED["lz4"], CHUNK) + 25, b"\7\0\1\0"),
            "does not have the 65543 bytes that it",
        ),
        (changed(CHUNKED["lz4"], place_of(CHUNKED["lz4"], CHUNK) + 41, b"lz5"), "is compressed with 'lz5'; known are"),
        (changed(CHUNKED["lz4"], place_of(CHUNKED["lz4"], CHUNK) + 41, b"\xff"), "a chunk cannot be opened"),
        (changed(CHUNKED["lz4"], place_of(CHUNKED["lz4"], CHUNK) + 44, LAST), "a chunk cannot be opened"),
    ],
)
def test_a_file_that_lies_is_told_in_one_line(tmp_path: Path, content: bytes, message: str) -> None:
    assert message in refused(tmp_path, content)


WHOLE = [*CHUNKED.values(), PLAIN, ros(map(imu, range(4))), in_json([as_json(row) for row in rows(4)])]


@given(
    st.sampled_from(WHOLE),
    st.lists(st.tuples(st.integers(0, 1 << 16), st.binary(min_size=1, max_size=9)), min_size=1, max_size=4),
    st.integers(0, 1 << 16),
)
def test_any_damage_gives_a_session_or_a_data_error(
    tmp_path_factory: pytest.TempPathFactory, content: bytes, changes: list[tuple[int, bytes]], cut: int
) -> None:
    for index, fresh in changes:
        content = changed(content, len(MAGIC) + index % (len(content) - 20), fresh)
    path = written(tmp_path_factory.mktemp("any"), content[: max(len(MAGIC), len(content) - cut // 16)])
    try:
        session = read_foreign(path)
    except DataError as error:
        assert str(error).startswith(f"{path}: ")  # noqa: PT017 - both outcomes are right
    else:
        assert len(session.rate_dps) == len(session.t_device_s) > 0


def test_a_few_bytes_that_would_open_to_a_great_many_are_not_opened(tmp_path: Path) -> None:
    payload = json.dumps({"t_device_s": 1.0, "rate_dps": 0.0, "note": "x" * 250_000}).encode()
    item = in_json([payload] * 80, chunk_size=1 << 30, compression=CompressionType.ZSTD)
    many = in_json([payload] * 80, chunk_size=1 << 20, compression=CompressionType.ZSTD)
    for content in (item, many):
        assert len(content) < 50_000
        assert "too many for this file" in refused(tmp_path, content)
