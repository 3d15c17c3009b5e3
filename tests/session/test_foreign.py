"""Sessions in files that others wrote: every kind of message and of file, torn and damaged ones too."""

import io
import json
import math
import struct
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mcap.writer import CompressionType, IndexType
from mcap.writer import Writer as PlainWriter
from mcap_ros2.writer import Writer as RosWriter

from gyrodrift.errors import DataError
from gyrodrift.session.foreign import read_foreign

FIELDS = ("seq", "t_device_s", "t_host_s", "rate_dps", "encoder_deg", "temp_c")
SAMPLE_TEXT = "int64 seq\n" + "".join(f"float64 {name}\n" for name in FIELDS[1:])
IMU_TEXT = f"""\
std_msgs/Header header
geometry_msgs/Quaternion orientation
float64[9] orientation_covariance
geometry_msgs/Vector3 angular_velocity
float64[9] angular_velocity_covariance
geometry_msgs/Vector3 linear_acceleration
float64[9] linear_acceleration_covariance
{"=" * 80}
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
{"=" * 80}
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
{"=" * 80}
MSG: geometry_msgs/Quaternion
float64 x 0
float64 y 0
float64 z 0
float64 w 1
{"=" * 80}
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
"""
METADATA = {"robot": {"name": "bench"}}
FORMS: dict[str, dict[str, Any]] = {
    "lz4": {"compression": CompressionType.LZ4},
    "zstd": {"compression": CompressionType.ZSTD},
    "stored": {"compression": CompressionType.NONE},
    "data crc": {"compression": CompressionType.LZ4, "enable_data_crcs": True},
    "no crc": {"enable_crcs": False},
    "unchunked": {"use_chunking": False, "enable_data_crcs": True},
    "bare": {
        "use_chunking": False,
        "index_types": IndexType.NONE,
        "repeat_channels": False,
        "repeat_schemas": False,
        "use_statistics": False,
        "use_summary_offsets": False,
    },
}
MAGIC = b"\x89MCAP0\r\n"
CHANNEL, MESSAGE, CHUNK = 4, 5, 6
"""Opcodes."""

Row = dict[str, float]


def rows(count: int) -> list[Row]:
    return [
        {
            "seq": i,
            "t_device_s": i / 100,
            "t_host_s": 1.7e9 + i / 100,
            "rate_dps": math.sin(i),
            "encoder_deg": 0.1 * i,
            "temp_c": 25.0,
        }
        for i in range(count)
    ]


def cdr(row: Row) -> bytes:
    return struct.pack("<Iqddddd", 0x100, *(row[name] for name in FIELDS))


def as_json(row: dict[str, Any]) -> bytes:
    return json.dumps(row).encode()


class Recorder:
    """A file by the public writer, in the form that is asked for; chunks are small, so that there are many."""

    def __init__(self, **form: Any) -> None:
        self.stream = io.BytesIO()
        self.writer = PlainWriter(self.stream, **{"chunk_size": 600} | form)
        self.writer.start("ros2", "somebody")

    def channel(self, topic: str, encoding: str, schema: tuple[str, str, str] | None = None) -> int:
        schema_id = self.writer.register_schema(schema[0], schema[1], schema[2].encode()) if schema else 0
        return self.writer.register_channel(topic, encoding, schema_id)

    def add(self, channel_id: int, payloads: Iterable[bytes]) -> None:
        for i, payload in enumerate(payloads):
            self.writer.add_message(channel_id, 1_600_000_000_000_000_000 + i * 10_000_000, payload, 0, i)

    def content(self) -> bytes:
        self.writer.finish()  # type: ignore[no-untyped-call]  # the package leaves it unannotated
        return self.stream.getvalue()


def own(values: list[Row], topic: str = "/gyro", name: str = "gyrodrift/Sample", **form: Any) -> bytes:
    recorder = Recorder(**form)
    recorder.writer.add_metadata("robot", METADATA["robot"])
    recorder.add(recorder.channel(topic, "cdr", (name, "ros2msg", SAMPLE_TEXT)), map(cdr, values))
    return recorder.content()


def in_json(payloads: Iterable[bytes], topic: str = "/gyro", **form: Any) -> bytes:
    recorder = Recorder(**form)
    recorder.add(recorder.channel(topic, "json"), payloads)
    return recorder.content()


def imu(i: int, **other: Any) -> dict[str, Any]:
    return {
        "header": {"stamp": {"sec": 1_700_000_000 + i, "nanosec": 500_000_001}, "frame_id": "imu_link"},
        "orientation_covariance": [-1.0] + [0.0] * 8,
        "angular_velocity": {"x": 9.0, "y": 9.0, "z": 0.01 * i},
        "angular_velocity_covariance": [0.02] + [0.0] * 8,
        "linear_acceleration_covariance": [0.0] * 9,
        **other,
    }


def ros(messages: Iterable[dict[str, Any]], topic: str = "/imu/data", name: str = "sensor_msgs/msg/Imu") -> bytes:
    stream = io.BytesIO()
    with RosWriter(stream, chunk_size=2000) as writer:
        schema = writer.register_msgdef(name, IMU_TEXT)
        for i, message in enumerate(messages):
            writer.write_message(topic, schema, message, log_time=5_000_000_000 + i * 1000)
    return stream.getvalue()


def written(folder: Path, content: bytes) -> Path:
    path = folder / "s.mcap"
    path.write_bytes(content)
    return path


def refused(folder: Path, content: bytes, topic: str | None = None) -> str:
    """What is said of a file that cannot be read: one line that begins with its path."""
    path = written(folder, content)
    with pytest.raises(DataError) as caught:
        read_foreign(path, topic)
    text = str(caught.value)
    assert text.startswith(f"{path}: ")
    assert "\n" not in text
    return text.removeprefix(f"{path}: ")


@pytest.mark.parametrize("form", FORMS)
def test_samples_come_out_of_every_form_of_file(tmp_path: Path, form: str) -> None:
    """Value by value, with what stands beside them."""
    values = rows(100)
    session = read_foreign(written(tmp_path, own(values, **FORMS[form])))
    for name in FIELDS:
        assert getattr(session, name).tolist() == [row[name] for row in values]
    assert session.name == "s"
    assert session.metadata == METADATA


@pytest.mark.parametrize("form", FORMS)
def test_json_is_understood_in_every_form_of_file(tmp_path: Path, form: str) -> None:
    """With integers where a number is meant."""
    payloads = [as_json({"t_device_s": i, "rate_dps": -i, "seq": i, "note": "passed over"}) for i in range(50)]
    session = read_foreign(written(tmp_path, in_json(payloads, topic="/x", **FORMS[form])))
    assert session.t_device_s.tolist() == list(range(50))
    assert session.rate_dps.tolist() == [-i for i in range(50)]
    assert session.seq is not None
    assert session.seq.tolist() == list(range(50))


@pytest.mark.parametrize("name", ["sensor_msgs/msg/Imu", "sensor_msgs/Imu"])
def test_an_imu_gives_its_turn_about_z_in_degrees(tmp_path: Path, name: str) -> None:
    """Device time from the stamp, host time from the log; there is no angle, temperature or counter."""
    session = read_foreign(written(tmp_path, ros(map(imu, range(60)), name=name)))
    assert session.t_device_s.tolist() == [1_700_000_000.500000001 + i for i in range(60)]
    assert session.rate_dps.tolist() == [math.degrees(0.01 * i) for i in range(60)]
    assert session.t_host_s is not None
    assert session.t_host_s.tolist() == [(5_000_000 + i) / 1e6 for i in range(60)]
    assert (session.seq, session.encoder_deg, session.temp_c) == (None, None, None)


def test_an_imu_without_a_rate_is_told(tmp_path: Path) -> None:
    """By the −1 that the ROS documentation asks for."""
    lacking = imu(3, angular_velocity_covariance=[-1.0] + [0.0] * 8)
    text = refused(tmp_path, ros([imu(0), imu(1), lacking]))
    assert text == "/imu/data: message 3 has no rate: angular_velocity_covariance begins with -1"


def test_json_says_what_is_missing_with_null_or_by_silence(tmp_path: Path) -> None:
    """Host time alone has something to fall back to: the log time, where it is not mentioned."""
    first = {"t_device_s": 0.0, "rate_dps": None, "temp_c": 20.5, "t_host_s": None, "encoder_deg": None}
    payloads = [as_json(first), b'{"t_device_s": 1e-2, "rate_dps": NaN, "seq": null}']
    session = read_foreign(written(tmp_path, in_json(payloads)))
    assert np.isnan(session.rate_dps).all()
    assert session.t_host_s is not None
    assert session.temp_c is not None
    assert session.t_host_s.tolist() == pytest.approx([math.nan, 1_600_000_000.01], nan_ok=True)
    assert session.temp_c.tolist() == pytest.approx([20.5, math.nan], nan_ok=True)
    assert (session.seq, session.encoder_deg) == (None, None)


@pytest.mark.parametrize(
    ("payload", "message"),
    [
        (b"", "is not JSON"),
        (b"{", "is not JSON"),
        (b"\xff\xfe", "is not JSON"),
        (b"[" * 100_000, "is not JSON"),
        (b'{"t_device_s": ' + b"9" * 5000 + b"}", "is not JSON"),
        (b"[1, 2]", "is [1, 2], expected an object with t_device_s and rate_dps"),
        (b"{}", "has no t_device_s, which is required"),
        (b'{"t_device_s": 1}', "has no rate_dps, which is required"),
        (b'{"t_device_s": "1", "rate_dps": 1}', "has '1' as t_device_s, expected a number"),
        (b'{"t_device_s": 1, "rate_dps": true}', "has True as rate_dps, expected a number"),
        (b'{"t_device_s": 1, "rate_dps": {"z": 1}}', "has {'z': 1} as rate_dps, expected a number"),
        (b'{"t_device_s": 1, "rate_dps": 1%s}' % (b"0" * 400), "has a number as rate_dps that no float can hold"),
        (b'{"t_device_s": 1, "rate_dps": 1, "seq": 1.5}', "has 1.5 as seq, expected a whole number of 64 bits"),
        (b'{"t_device_s": 1, "rate_dps": 1, "seq": 1e400}', "has inf as seq, expected a whole number of 64 bits"),
        (b'{"t_device_s": 1, "rate_dps": 1, "seq": 9223372036854775808}', "as seq, expected a whole number of 64 bits"),
    ],
)
def test_a_wrong_message_is_told_with_its_place(tmp_path: Path, payload: bytes, message: str) -> None:
    """Topic, number and what is wrong."""
    good = b'{"t_device_s": 0, "rate_dps": 0}'
    text = refused(tmp_path, in_json([good, payload, good], topic="/imu"))
    assert text.startswith("/imu: message 2 ")
    assert message in text


@pytest.mark.parametrize(
    ("name", "schema", "payload", "message"),
    [
        ("gyrodrift/Sample", SAMPLE_TEXT, b"\0\1\0\0\0", "message 1 does not fit its schema gyrodrift/Sample"),
        ("gyrodrift/Sample", "float64 x", b"\0\1\0\0" + b"\0" * 8, "message 1 has no t_device_s, which is required"),
        (
            "gyrodrift/Sample",
            "float64 t_device_s\nstring rate_dps",
            b"\0\1\0\0" + b"\0" * 8 + b"\3\0\0\0up\0",
            "message 1 has 'up' as rate_dps, expected a number",
        ),
        ("gyrodrift/Sample", "not a ! field", b"", "the schema gyrodrift/Sample cannot be parsed"),
        ("gyrodrift/Sample", "other/Part x", b"\0\1\0\0", "message 1 does not fit its schema gyrodrift/Sample"),
        ("gyrodrift/Sample", "gyrodrift/Sample x", b"\0\1\0\0", "does not fit its schema gyrodrift/Sample"),
        ("sensor_msgs/msg/Imu", "float64 x", b"\0\1\0\0" + b"\0" * 8, "message 1 lacks header.stamp, angular_velocity"),
    ],
)
def test_a_schema_that_lies_is_told(
    tmp_path: Path, name: str, schema: str, payload: bytes, message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """Whatever the decoder makes of it, and nothing is printed on the way."""
    recorder = Recorder()
    recorder.add(recorder.channel("/a", "cdr", (name, "ros2msg", schema)), [payload])
    text = refused(tmp_path, recorder.content())
    assert text.startswith("/a: ")
    assert message in text
    assert capsys.readouterr() == ("", "")


def test_the_topic_is_the_one_given_or_gyro_or_the_only_one(tmp_path: Path) -> None:
    """Channels of other kinds, and such as have no messages, do not count."""
    recorder = Recorder()
    sample = ("gyrodrift/Sample", "ros2msg", SAMPLE_TEXT)
    recorder.add(recorder.channel("/camera", "cdr", ("sensor_msgs/msg/Image", "ros2msg", "uint8[] x")), [b"\0\1\0\0"])
    recorder.channel("/empty", "cdr", sample)
    recorder.add(recorder.channel("/a", "json"), [b'{"t_device_s": 1, "rate_dps": 1}'] * 2)
    assert len(read_foreign(written(tmp_path, recorder.content())).rate_dps) == 2


def test_several_channels_want_a_choice(tmp_path: Path) -> None:
    """Unless one of them is `/gyro`."""
    recorder = Recorder()
    for topic, count in (("/b", 2), ("/a", 3)):
        recorder.add(recorder.channel(topic, "json"), [b'{"t_device_s": 1, "rate_dps": 1}'] * count)
    path = written(tmp_path, recorder.content())
    with pytest.raises(DataError, match="samples may be on /a, /b; choose one with gyrodrift convert --topic"):
        read_foreign(path)
    assert len(read_foreign(path, "/b").rate_dps) == 2
    with pytest.raises(DataError, match=r"has no messages on /c; there are /a \(no schema, json\), /b"):
        read_foreign(path, "/c")

    recorder = Recorder()
    for topic, count in (("/b", 2), ("/gyro", 3)):
        recorder.add(recorder.channel(topic, "json"), [b'{"t_device_s": 1, "rate_dps": 1}'] * count)
    assert len(read_foreign(written(tmp_path, recorder.content())).rate_dps) == 3


def test_two_writers_on_one_topic_are_one_session(tmp_path: Path) -> None:
    """In the order of the file."""
    recorder = Recorder()
    recorder.add(recorder.channel("/a", "json"), [as_json({"t_device_s": 0, "rate_dps": 1})])
    recorder.add(recorder.channel("/a", "cdr", ("gyrodrift/msg/Sample", "ros2msg", SAMPLE_TEXT)), map(cdr, rows(2)))
    assert len(read_foreign(written(tmp_path, recorder.content())).rate_dps) == 3


@pytest.mark.parametrize("topic", [None, "/camera"])
def test_what_is_not_understood_is_listed(tmp_path: Path, topic: str | None) -> None:
    """With schema and encodings, and what would be understood."""
    recorder = Recorder()
    recorder.add(recorder.channel("/camera", "cdr", ("sensor_msgs/msg/Image", "ros2msg", "uint8[] x")), [b""])
    recorder.add(recorder.channel("/p", "protobuf"), [b""])
    recorder.add(recorder.channel("/idl", "cdr", ("sensor_msgs/msg/Imu", "ros2idl", "")), [b""])
    text = refused(tmp_path, recorder.content(), topic)
    assert text == (
        f"{topic or 'no channel'} holds samples; "
        "expected gyrodrift/Sample or sensor_msgs/msg/Imu (ros2msg, cdr), or json with t_device_s and rate_dps; "
        "there are /camera (sensor_msgs/msg/Image, ros2msg, cdr), "
        "/idl (sensor_msgs/msg/Imu, ros2idl, cdr), /p (no schema, protobuf)"
    )


@pytest.mark.parametrize("form", FORMS)
def test_a_file_cut_off_anywhere_keeps_its_beginning(tmp_path: Path, form: str) -> None:
    """Never a value that was not written, never fewer for a later cut, and all once the last one is there."""
    values = rows(60)
    content = own(values, **FORMS[form])
    seen = 0
    for length in range(len(MAGIC), len(content), 37 if form != "unchunked" else 5):
        path = written(tmp_path, content[:length])
        try:
            session = read_foreign(path)
        except DataError as error:
            assert str(error) == f"{path}: has no samples"  # noqa: PT017 - the beginning has none, and that is fine
            assert seen == 0
            continue
        count = len(session.rate_dps)
        assert count >= seen
        assert session.rate_dps.tolist() == [row["rate_dps"] for row in values[:count]]
        seen = count
    assert seen == 60


def test_a_cut_in_a_chunk_costs_the_messages_behind_it(tmp_path: Path) -> None:
    """Where it is stored, to the message; where it is compressed, to the block."""
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


def place_of(content: bytes, wanted: int) -> int:
    """Where the first record of a kind begins."""
    at = len(MAGIC)
    while content[at] != wanted:
        at += 9 + int.from_bytes(content[at + 1 : at + 9], "little")
    return at


def changed(content: bytes, at: int, fresh: bytes) -> bytes:
    return content[:at] + fresh + content[at + len(fresh) :]


CHUNKED = {form: own(rows(60), **FORMS[form]) for form in ("stored", "lz4", "zstd")}
PLAIN, BARE = own(rows(60), **FORMS["unchunked"]), own(rows(60), **FORMS["bare"])
LAST = b"\xff" * 8


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "is no MCAP file: it does not begin as one"),
        (b"t_device_s,rate_dps\n", "is no MCAP file: it does not begin as one"),
        (MAGIC, "has no samples"),
        (MAGIC + b"\xff" * 100, "the record at byte 8 claims to have 18446744073709551615 bytes, 91 are left"),
        (changed(PLAIN, place_of(PLAIN, MESSAGE) + 1, b"\0" * 8), "a message has 0 bytes, fewer than its head"),
        (changed(PLAIN, place_of(PLAIN, MESSAGE) + 1, struct.pack("<Q", 1 << 20)), "claims to have 1048576 bytes"),
        (changed(PLAIN, place_of(PLAIN, MESSAGE) + 60, b"\x01"), "the checksum of its data is wrong"),
        (changed(BARE, place_of(BARE, MESSAGE) + 9, b"\7"), "has messages of a channel 7, which is nowhere declared"),
        (changed(BARE, place_of(BARE, CHANNEL) + 11, b"\7"), "/gyro has a schema 7, which is nowhere declared"),
        (changed(PLAIN, place_of(PLAIN, CHANNEL) + 13, b"\xff\xff\xff\xff"), "a record Channel is damaged"),
        (
            changed(CHUNKED["stored"], place_of(CHUNKED["stored"], CHUNK) + 400, b"\x55"),
            "the checksum of a chunk is wrong",
        ),
        (changed(CHUNKED["lz4"], place_of(CHUNKED["lz4"], CHUNK) + 60, LAST), "a chunk cannot be opened: lz4 says no"),
        (
            changed(CHUNKED["zstd"], place_of(CHUNKED["zstd"], CHUNK) + 60, LAST),
            "a chunk cannot be opened: zstd says no",
        ),
        (
            changed(CHUNKED["zstd"], place_of(CHUNKED["zstd"], CHUNK) + 25, LAST),
            "a chunk claims to have 1844674407370955",
        ),
        (
            changed(CHUNKED["lz4"], place_of(CHUNKED["lz4"], CHUNK) + 25, b"\7\0\0\0"),
            "has not the 7 bytes that it claims",
        ),
        (changed(CHUNKED["lz4"], place_of(CHUNKED["lz4"], CHUNK) + 25, b"\7\0\1\0"), "has not the 65543 bytes that it"),
        (changed(CHUNKED["lz4"], place_of(CHUNKED["lz4"], CHUNK) + 41, b"lz5"), "is compressed with 'lz5'; known are"),
        (changed(CHUNKED["lz4"], place_of(CHUNKED["lz4"], CHUNK) + 41, b"\xff"), "a chunk cannot be opened"),
        (changed(CHUNKED["lz4"], place_of(CHUNKED["lz4"], CHUNK) + 44, LAST), "a chunk cannot be opened"),
    ],
)
def test_a_file_that_lies_is_told_in_one_line(tmp_path: Path, content: bytes, message: str) -> None:
    """Magic, lengths, checksums, compression."""
    assert message in refused(tmp_path, content)


def test_what_cannot_be_opened_is_told(tmp_path: Path) -> None:
    """Missing, or a folder."""
    with pytest.raises(DataError, match="cannot be read: No such file or directory"):
        read_foreign(tmp_path / "none.mcap")
    with pytest.raises(DataError, match="cannot be read: Is a directory"):
        read_foreign(tmp_path)


WHOLE = [*CHUNKED.values(), PLAIN, ros(map(imu, range(4))), in_json([as_json(row) for row in rows(4)])]


@given(
    st.sampled_from(WHOLE),
    st.lists(st.tuples(st.integers(0, 1 << 16), st.binary(min_size=1, max_size=9)), min_size=1, max_size=4),
    st.integers(0, 1 << 16),
)
def test_any_damage_gives_a_session_or_a_data_error(
    tmp_path_factory: pytest.TempPathFactory, content: bytes, changes: list[tuple[int, bytes]], cut: int
) -> None:
    """Never another exception."""
    for at, fresh in changes:
        content = changed(content, len(MAGIC) + at % (len(content) - 20), fresh)
    path = written(tmp_path_factory.mktemp("any"), content[: max(len(MAGIC), len(content) - cut // 16)])
    try:
        session = read_foreign(path)
    except DataError as error:
        assert str(error).startswith(f"{path}: ")  # noqa: PT017 - both outcomes are right
    else:
        assert len(session.rate_dps) == len(session.t_device_s) > 0
