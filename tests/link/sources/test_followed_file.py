"""Source `FILE.mcap`: recordings of ours and of other programs, followed while they grow."""

import json
from collections.abc import Callable
from io import BytesIO
from itertools import pairwise
from math import degrees, isnan, nan
from pathlib import Path

import pytest
from foreign_support import Recorder, as_json, imu, ros
from hypothesis import given
from hypothesis import strategies as st
from mcap.writer import CompressionType, Writer
from sources_support import Events, read_until
from support import Command

from gyrodrift.link.link import Link
from gyrodrift.link.options import LinkOptions
from gyrodrift.link.sources.mcap import McapDecoder
from gyrodrift.session.follow import SampleStream
from gyrodrift.session.mcap.write import McapWriter
from gyrodrift.values.errors import DataError, PortMissingError
from gyrodrift.values.sample import DeviceYaw, Inertial, Sample


def sample(number: int, inertial: Inertial | None = None, still: float = nan) -> Sample:
    return Sample(number, 0.01 * number, 1e9 + 0.01 * number, 0.5 + number, nan, 21.0, still, inertial)


def own_file(count: int, *, is_finished: bool = True, has_axes: bool = False) -> bytes:
    """A recording of ours."""
    content = BytesIO()
    writer = McapWriter(content, {"device": {"device_id": "gyro7", "dps_per_lsb": "0.01"}}, has_axes=has_axes)
    for number in range(count):
        if number == 50:
            writer.add_event("gap", 1e9, {"missing": 1})
        axes = Inertial(1.0, 2.0, 0.5 + number, 0.0, 0.0, 9.8) if has_axes else None
        writer.add(sample(number, axes, 1.0 if number > 60 else nan))
        if number == 61:
            writer.flush()
    writer.flush()
    if is_finished:
        writer.finish()
    return content.getvalue()


def foreign_file(count: int, compression: CompressionType) -> bytes:
    """JSON samples of another program, in chunks."""
    content = BytesIO()
    writer = Writer(content, compression=compression, chunk_size=1000)
    writer.start()
    schema = writer.register_schema("rate", "jsonschema", b"{}")
    unread = writer.register_channel("/other", "protobuf", 0)
    channel = writer.register_channel("/imu", "json", schema)
    for number in range(count):
        writer.add_message(unread, 0, b"x", 0)
        fields = {"t_device_s": 0.01 * number, "rate_dps": 0.5}
        writer.add_message(channel, number * 10_000_000, json.dumps(fields).encode(), 0)
    writer.finish()  # type: ignore[no-untyped-call]
    return content.getvalue()


@given(st.lists(st.integers(0, 12_000), max_size=8))
def test_any_split_of_a_file_gives_the_same_samples(cuts: list[int]) -> None:
    content = own_file(100)
    ends = [0, *sorted(min(cut, len(content)) for cut in cuts), len(content)]
    stream = SampleStream("file")
    samples = [item for a, b in pairwise(ends) for item in stream.push(content[a:b])]
    assert [item[:4] for item in samples] == [sample(number)[:4] for number in range(100)]
    assert [item.still for item in samples[62:]] == [1.0] * 38  # a flag is written after its sample
    assert isnan(samples[60].still)
    assert stream.device["device_id"] == "gyro7"


def test_three_axes_come_along() -> None:
    samples = SampleStream("file").push(own_file(10, has_axes=True))
    assert samples[9].inertial == Inertial(1.0, 2.0, 9.5, 0.0, 0.0, 9.8)


def test_the_result_of_the_device_comes_along() -> None:
    """A sample without a result has none."""
    content = BytesIO()
    writer = McapWriter(content, has_device_yaw=True)
    writer.add(sample(0)._replace(device_yaw=DeviceYaw(1.0, 0.1, 0.01)))
    writer.add(sample(1))
    writer.finish()
    readings = McapDecoder().push(content.getvalue())
    assert [reading.device_yaw for reading in readings] == [DeviceYaw(1.0, 0.1, 0.01), None]


@pytest.mark.parametrize("compression", [CompressionType.NONE, CompressionType.LZ4, CompressionType.ZSTD])
def test_files_of_other_programs_are_read(compression: CompressionType) -> None:
    """Chunk by chunk; a channel that cannot be read is ignored."""
    samples = SampleStream("file").push(foreign_file(200, compression))
    assert [item.rate_dps for item in samples] == [0.5] * 200


@given(st.integers(0, 3000), st.binary(min_size=1, max_size=20))
def test_damage_costs_samples_only(position: int, content: bytes) -> None:
    """The decoder counts it, and nothing raises."""
    file = bytearray(own_file(30))
    file[position : position + len(content)] = content
    decoder = McapDecoder()
    readings = decoder.push(bytes(file))
    assert len(readings) <= 30
    assert decoder.push(b"\x00" * 100) == [] or decoder.counters.damaged == 0


def test_a_record_of_impossible_length_is_damage() -> None:
    with pytest.raises(DataError, match="is damaged: a record claims 1152921504606846976 bytes"):
        SampleStream("file").push(b"\x89MCAP0\r\n\x05" + (1 << 60).to_bytes(8, "little"))


def grow(path: Path, *pieces: bytes) -> None:
    with path.open("ab") as file:
        for piece in pieces:
            file.write(piece)


def test_a_growing_file_is_followed_to_its_end(tmp_path: Path) -> None:
    """The end of the finished file ends the link."""
    path, events = tmp_path / "live.mcap", Events()
    content = own_file(300)
    grow(path, content[:5000])
    link = Link(LinkOptions(str(path)), events)
    samples = read_until(link, lambda samples: len(samples) > 30)
    assert not link.is_over
    grow(path, content[5000:9003])
    samples += read_until(link, lambda samples: len(samples) > 20)
    grow(path, content[9003:])
    samples += read_until(link, lambda _: link.is_over)
    assert [item.seq for item in samples] == list(range(300))
    assert link.device.device_id == "gyro7"
    assert events.names()[-1] == "source_end"


@pytest.mark.parametrize(
    ("change", "event"),
    [
        (lambda path, content: path.write_bytes(content[:3000]), "source_truncated"),
        (lambda path, content: (path.unlink(), path.write_bytes(content)), "source_replaced"),
    ],
)
def test_a_file_that_is_not_the_same_is_said_and_read_again(
    tmp_path: Path, change: Callable[[Path, bytes], object], event: str
) -> None:
    path, events = tmp_path / "live.mcap", Events()
    content = own_file(300, is_finished=False)
    path.write_bytes(content)
    link = Link(LinkOptions(str(path)), events)
    read_until(link, lambda samples: len(samples) == 300)
    change(path, content)
    read_until(link, lambda samples: len(samples) > 10)
    link.close()
    assert event in events.names()
    assert events.names().index(event) < events.names().index("link_lost") < events.names().index("link_restored")


def test_a_missing_file_is_an_error_or_waited_for(tmp_path: Path) -> None:
    path = tmp_path / "later.mcap"
    with pytest.raises(PortMissingError, match="there is no such file; with --timeout 0 it is waited for"):
        Link(LinkOptions(str(path)), Events())
    link = Link(LinkOptions(str(path), timeout_s=0.0), Events())
    path.write_bytes(own_file(20))
    assert len(read_until(link, lambda _: link.is_over)) == 20


def test_serve_follows_a_running_record(port: Path, tmp_path: Path) -> None:
    """A recording of a device, while it is written; `serve` ends with it."""
    with Command("--link", port, "--quiet", module="firmware_sim") as device:
        device.until(lambda _: port.exists(), "port")
        with Command("record", "--port", port, "--out", tmp_path / "out") as record:
            record.until_log("protocol_found")
            record.until(lambda _: any((tmp_path / "out").glob("*.mcap")), "file")
            (path,) = (tmp_path / "out").glob("*.mcap")
            with Command("serve", "--port", path) as serve:
                serve.take_lines(200)
                assert record.stop() == 0
                assert serve.end() == 0
                first, last = serve.all_lines()[0], serve.all_lines()[-1]
    assert last["seq"] - first["seq"] == len(serve.all_lines()) - 1


def test_an_imu_of_ros_has_its_rate_in_deg_per_s() -> None:
    samples = SampleStream("file").push(ros([imu(number) for number in range(5)]))
    assert [item.rate_dps for item in samples] == pytest.approx([degrees(0.01 * number) for number in range(5)])


def test_topics_and_fields_of_a_file_without_samples_are_named() -> None:
    """And those that are needed."""
    content = BytesIO()
    writer = Writer(content)
    writer.start()
    channel = writer.register_channel("/imu", "json", writer.register_schema("my.Imu", "jsonschema", b"{}"))
    camera = writer.register_channel("/cam", "protobuf", writer.register_schema("foxglove.Image", "protobuf", b""))
    for number in range(10):
        writer.add_message(channel, number, json.dumps({"stamp": number, "angular_velocity": {"z": 1.0}}).encode(), 0)
        writer.add_message(camera, number, b"x", 0)
    writer.finish()  # type: ignore[no-untyped-call]
    decoder = McapDecoder()
    assert decoder.push(content.getvalue()) == []
    assert "/imu (my.Imu, jsonschema, json): a message has no t_device_s" in decoder.unread
    assert "its fields are stamp, angular_velocity; /cam (foxglove.Image, protobuf, protobuf)" in decoder.unread
    assert "json with t_device_s and rate_dps" in decoder.unread


def test_the_channel_gyro_is_preferred_wherever_it_stands() -> None:
    """A channel that can be read, and is declared before it, is passed over."""
    recorder = Recorder(use_chunking=False)
    schema = ("rate", "jsonschema", "{}")
    first = recorder.channel("/a_first", "json", schema)
    gyro = recorder.channel("/gyro", "json", schema)
    for number in range(5):
        for channel, rate_dps in ((first, 99.0), (gyro, 0.5)):
            fields = {"t_device_s": 0.01 * number, "rate_dps": rate_dps}
            recorder.writer.add_message(channel, number, as_json(fields), 0)
    content = recorder.content()
    assert [item.rate_dps for item in SampleStream("file").push(content)] == [0.5] * 5
    stream = SampleStream("file")
    assert [item.rate_dps for i in range(len(content)) for item in stream.push(content[i : i + 1])] == [0.5] * 5
    assert stream.other_topics == {"/a_first"}
