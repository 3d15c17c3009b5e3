"""Sessions in MCAP: the same samples for us and for public readers, whole or torn at any byte."""

import io
import json
import os
import struct
import zlib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mcap.opcode import Opcode
from mcap.reader import make_reader
from mcap.writer import Writer
from mcap_ros2.decoder import DecoderFactory

from gyrodrift.cli import main
from gyrodrift.session.mcap import walk
from gyrodrift.session.mcap.layout import CLOSED_TAIL_BYTES, HEAD, LAYOUTS, MESSAGE, STILLS
from gyrodrift.session.mcap.read import add_chunk, read_mcap
from gyrodrift.session.mcap.rows import ROWS, Rows, checksums
from gyrodrift.session.mcap.write import MESSAGE_HEAD, McapWriter
from gyrodrift.session.session import Session
from gyrodrift.values.errors import DataError
from gyrodrift.values.sample import Sample

any_float = st.floats(width=64)
samples = st.lists(
    st.builds(
        Sample, st.integers(0, 2**62), any_float, st.floats(0, 4e9), any_float, any_float, any_float, aids=st.just(())
    ),
    min_size=1,
)
METADATA = {"device": {"id": "bench", "rate": "100"}, "host": {"name": "here"}}


def recorded(values: list[Sample], *, is_finished: bool = True, flushed_after: int | None = None) -> bytes:
    stream = io.BytesIO()
    writer = McapWriter(stream, METADATA)
    for number, sample in enumerate(values):
        if number == flushed_after:
            writer.flush()
        writer.add(sample)
    writer.flush()
    if is_finished:
        writer.finish()
    return stream.getvalue()


def written(folder: Path, content: bytes) -> Path:
    path = folder / "s.mcap"
    path.write_bytes(content)
    return path


def steady(count: int) -> list[Sample]:
    return [Sample(i, i / 100, 1.7e9 + i / 100, 0.5 * i, 0.1 * i, 25.0) for i in range(count)]


@pytest.mark.parametrize("kind", LAYOUTS)
def test_a_message_has_one_size_for_writer_and_reader(kind: tuple[bool, bool, bool]) -> None:
    """The two descriptions of it agree."""
    has_axes, has_device_yaw, has_checksum = kind
    size = 83 + 48 * has_axes + 24 * has_device_yaw + 4 * has_checksum
    assert LAYOUTS[kind].message.size == ROWS[kind].itemsize == size


@given(st.binary(min_size=1, max_size=4000))
def test_checksums_of_rows_are_those_of_their_bytes(content: bytes) -> None:
    for row in ROWS.values():
        rows = np.frombuffer(content.ljust(row.itemsize, b"x"), row, max(1, len(content) // row.itemsize))
        assert checksums(rows).tolist() == [zlib.crc32(item.tobytes()[:-4]) for item in rows]


@given(samples)
def test_what_is_written_is_read_with_the_same_bits(
    tmp_path_factory: pytest.TempPathFactory, values: list[Sample]
) -> None:
    session = read_mcap(written(tmp_path_factory.mktemp("s"), recorded(values)))
    assert np.array_equal(session.t_device_s, [s.t_device_s for s in values], equal_nan=True)
    assert np.array_equal(session.rate_dps, [s.rate_dps for s in values], equal_nan=True)
    assert session.seq is not None
    assert session.seq.tolist() == [s.seq for s in values]
    angles = [s.encoder_deg for s in values]
    assert (session.encoder_deg is None) == bool(np.isnan(angles).all())
    assert session.encoder_deg is None or np.array_equal(session.encoder_deg, angles, equal_nan=True)


def test_chunks_of_arrays_and_single_samples_make_the_same_file() -> None:
    values = steady(500)
    columns = [np.array(column, dtype=np.float64) for column in zip(*(sample[:6] for sample in values), strict=True)]
    stream = io.BytesIO()
    writer = McapWriter(stream, METADATA)
    for part in (slice(0, 200), slice(200, 500)):
        seq, t_device_s, t_host_s, rate_dps, encoder_deg, temp_c = (column[part] for column in columns)
        chunk = Session("s", t_device_s, rate_dps, t_host_s, seq.astype(np.int64), encoder_deg, temp_c)
        add_chunk(writer, chunk)
    writer.finish()
    assert stream.getvalue() == recorded(values, flushed_after=200)


def test_public_readers_open_it_with_checks_on_and_decode_it() -> None:
    """The `mcap` package with its checksums, and its ROS 2 decoder by our schema."""
    values = steady(50)
    reader = make_reader(io.BytesIO(recorded(values)), validate_crcs=True, decoder_factories=[DecoderFactory()])
    summary = reader.get_summary()
    assert summary is not None
    assert summary.statistics is not None
    assert summary.statistics.message_count == 50
    assert summary.statistics.message_start_time == round(1.7e9 * 1e9)
    assert {record.name: record.metadata for record in reader.iter_metadata()} == METADATA
    decoded = list(reader.iter_decoded_messages(topics=["/gyro"]))
    assert {schema.name for schema, _, _, _ in decoded if schema} == {"gyrodrift/Sample"}
    got = [(m.seq, m.t_device_s, m.t_host_s, m.rate_dps, m.encoder_deg, m.temp_c) for _, _, _, m in decoded]
    assert got == [tuple(sample)[:6] for sample in values]


def test_the_footer_says_where_the_summary_begins() -> None:
    content = recorded(steady(3))
    (start,) = struct.unpack_from("<Q", content, len(content) - CLOSED_TAIL_BYTES + HEAD.size)
    assert content[start] == Opcode.SCHEMA
    assert content[start - HEAD.size - 4] == Opcode.DATA_END


def test_what_is_said_of_rest_is_written_where_it_changes() -> None:
    values = [sample._replace(still=float(i >= 10)) for i, sample in enumerate(steady(20))]
    stills = make_reader(io.BytesIO(recorded(values))).iter_messages(topics=[STILLS.name])
    assert [json.loads(message.data) for _, _, message in stills] == [
        {"sample": 0, "still": 0.0},
        {"sample": 10, "still": 1.0},
    ]


def test_a_file_torn_at_any_byte_of_its_end_keeps_every_whole_sample(tmp_path: Path) -> None:
    """Finished or not; and what is there is never more than was written."""
    values = steady(20)
    for is_finished in (True, False):
        content = recorded(values, is_finished=is_finished)
        ends = len(recorded([], is_finished=False)) + np.arange(1, 21) * MESSAGE.size
        for length in range(int(ends[-3]), len(content)):
            session = read_mcap(written(tmp_path, content[:length]))
            assert len(session.rate_dps) == np.count_nonzero(ends <= length)


def foreign(topic: str, schema: str) -> bytes:
    stream = io.BytesIO()
    writer = Writer(stream, use_chunking=False)
    writer.start()
    schema_id = writer.register_schema(schema, "ros2msg", b"float64 x")
    channel_id = writer.register_channel(topic, "cdr", schema_id)
    writer.add_message(channel_id, 0, b"\0" * 52, 0)
    writer.finish()  # type: ignore[no-untyped-call]  # the package leaves it unannotated
    return stream.getvalue()


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "nothing was recorded before it was cut off"),
        (b"t_device_s,rate_dps\n", "is no MCAP file"),
        (recorded([]), "has no samples"),
        (b"\x89MCAP0\r\n" + b"\xff" * 100, "is damaged: the record at byte 8 claims"),
        (foreign("/gyro", "other/Type"), r"no channel holds samples; .* topics are /gyro \(other/Type"),
    ],
)
def test_what_is_no_session_of_ours_is_told(tmp_path: Path, content: bytes, message: str) -> None:
    with pytest.raises(DataError, match=message):
        read_mcap(written(tmp_path, content))


def test_converting_there_and_back_changes_nothing(tmp_path: Path) -> None:
    """.mcap → .csv → .mcap, byte for byte but for the metadata."""
    first = tmp_path / "a.mcap"
    stream = io.BytesIO()
    writer = McapWriter(stream)
    for sample in steady(300):
        writer.add(sample)
    writer.finish()
    first.write_bytes(stream.getvalue())
    assert main(["convert", str(first), str(tmp_path / "b.csv")]) == 0
    assert main(["convert", str(tmp_path / "b.csv"), str(tmp_path / "c.mcap")]) == 0
    assert (tmp_path / "c.mcap").read_bytes() == first.read_bytes()


def test_an_unknown_ending_is_wrong_usage(tmp_path: Path) -> None:
    first = written(tmp_path, recorded(steady(3)))
    assert main(["convert", str(first), str(tmp_path / "b.bag")]) == 2
    assert [path.name for path in tmp_path.iterdir()] == ["s.mcap"]


def test_samples_that_take_turns_with_reads_are_looked_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    stream = io.BytesIO()
    writer = McapWriter(stream)
    for sample in steady(3000):
        writer.add(sample)
        writer.flush()
        writer.add_read(b"x", 1.0)
        writer.flush()
    writer.finish()
    looked_at: list[int] = []
    run_length = walk._run_length

    def counted(rows: Rows) -> int:
        looked_at.append(len(rows))
        return run_length(rows)

    monkeypatch.setattr(walk, "_run_length", counted)
    assert len(read_mcap(written(tmp_path, stream.getvalue())).t_device_s) == 3000
    assert sum(looked_at) <= 3000 * walk.FIRST_LOOK_ROWS


def test_a_file_that_ends_in_a_hole_is_read_up_to_it(tmp_path: Path) -> None:
    path = written(tmp_path, recorded(steady(100), is_finished=False))
    os.truncate(path, 1 << 40)
    assert len(read_mcap(path).t_device_s) == 100


def test_a_record_of_a_hole_is_not_read(tmp_path: Path) -> None:
    path = written(tmp_path, recorded(steady(100), is_finished=False))
    begun = path.stat().st_size
    with path.open("ab") as file:
        file.write(HEAD.pack(5, (1 << 40) - begun - HEAD.size) + STILLS.channel_id.to_bytes(2, "little"))
    os.truncate(path, (1 << 40) - 1)
    with path.open("ab") as file:
        file.write(b"x")
    with pytest.raises(DataError, match=r"the record at byte \d+ has \d+ bytes|more memory than this computer has"):
        read_mcap(path)


def saying(words: list[bytes]) -> bytes:
    """Ten samples, and messages on /still with these contents."""
    stream = io.BytesIO()
    writer = McapWriter(stream)
    for sample in steady(10):
        writer.add(sample)
    for word in words:
        length = MESSAGE_HEAD.size - HEAD.size + len(word)
        writer._others += writer._message_head(STILLS, length, 1_000_000_000) + word
    writer.finish()
    return stream.getvalue()


@pytest.mark.parametrize(
    "word",
    [b"[" * 100_000, b'{"sample": 1e999, "still": 1}', b'{"sample": "x", "still": 1}', b"[]"],
    ids=["deep", "endless", "text", "list"],
)
def test_what_is_said_of_rest_may_be_anything(tmp_path: Path, word: bytes) -> None:
    """JSON may be as deep, and its numbers as large, as somebody likes."""
    with pytest.raises(DataError, match="a message on /still is damaged; the file was changed since it was written"):
        read_mcap(written(tmp_path, saying([word])))


@given(st.lists(st.tuples(st.integers(-(2**80), 2**80) | st.integers(-3, 12), st.sampled_from([0.0, 1.0])), min_size=1))
def test_what_is_said_of_rest_holds_until_the_next(
    tmp_path_factory: pytest.TempPathFactory, statement: list[tuple[int, float]]
) -> None:
    words = [json.dumps({"sample": first, "still": still}).encode() for first, still in statement]
    still = read_mcap(written(tmp_path_factory.mktemp("s"), saying(words))).still
    expected = [next((item for first, item in reversed(statement) if first <= n), np.nan) for n in range(10)]
    np.testing.assert_array_equal(still, expected)


def test_a_note_that_is_not_utf_8_is_kept_as_far_as_it_goes(tmp_path: Path) -> None:
    stream = io.BytesIO()
    writer = McapWriter(stream, {"recording": {"note": os.fsdecode(b"good \xff\xfe bearing")}})
    writer.add(steady(1)[0])
    writer.finish()
    note = read_mcap(written(tmp_path, stream.getvalue())).metadata["recording"]["note"]
    assert note == r"good \udcff\udcfe bearing"
