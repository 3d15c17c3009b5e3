"""`gyrodrift convert`: between files of ours, of other people, and for other tools."""

import io
import json
import math
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer
from mcap_ros2.decoder import DecoderFactory
from support import ended_here

from gyrodrift.cli import main
from gyrodrift.session.files import load_session
from gyrodrift.session.mcap.write import McapWriter
from gyrodrift.values.sample import Sample

CSV = """\
t_device_s,t_host_s,seq,rate_dps,encoder_deg,temp_c
0.000000,1700000000.250000,7,0.1,0.0,25.0
0.010000,1700000000.260000,8,-0.2,,25.125
0.020000,1700000000.270000,,1e-09,0.30000000000000004,
"""


def session(folder: Path) -> Path:
    path = folder / "s.csv"
    path.write_text(CSV)
    return path


def rest(folder: Path, *topics: str) -> Path:
    """A chunked file with JSON samples on each topic, a different rate on each."""
    stream = io.BytesIO()
    writer = Writer(stream, compression=CompressionType.LZ4)
    writer.start()
    writer.add_metadata("robot", {"name": "bench"})
    for rate_dps, topic in enumerate(topics):
        channel_id = writer.register_channel(topic, "json", 0)
        for i in range(20):
            payload = json.dumps({"t_device_s": i / 10, "rate_dps": rate_dps}).encode()
            writer.add_message(channel_id, i * 100_000_000, payload, 0)
    writer.finish()  # type: ignore[no-untyped-call]  # the package leaves it unannotated
    path = folder / "others.mcap"
    path.write_bytes(stream.getvalue())
    return path


def test_json_and_back_keeps_every_digit(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """.csv → JSON in .mcap → .csv, byte for byte."""
    assert main(["convert", str(session(tmp_path)), str(tmp_path / "j.mcap"), "--as", "json"]) == 0
    assert main(["convert", str(tmp_path / "j.mcap"), str(tmp_path / "b.csv"), "--topic", "/gyro"]) == 0
    assert (tmp_path / "b.csv").read_text() == CSV
    size = (tmp_path / "b.csv").stat().st_size
    shown = capsys.readouterr()
    assert shown.out == ""
    assert shown.err.splitlines()[-1] == f"gyrodrift: {tmp_path / 'b.csv'} written: 3 samples, {size} bytes"


def test_imu_is_written_for_ros_and_says_what_it_lacks(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "i.mcap"
    assert main(["convert", str(session(tmp_path)), str(out), "--as", "imu"]) == 0
    report = capsys.readouterr()
    assert report.out == ""
    assert report.err.startswith(
        f"gyrodrift: {out}: rate in rad/s (sensor_msgs/msg/Imu); left out: encoder angle, temperature and counter\n"
    )
    reader = make_reader(io.BytesIO(out.read_bytes()), validate_crcs=True, decoder_factories=[DecoderFactory()])
    rates = [imu.angular_velocity.z for _, _, _, imu in reader.iter_decoded_messages()]
    assert rates == [math.radians(rate_dps) for rate_dps in (0.1, -0.2, 1e-9)]
    assert main(["convert", str(out), str(tmp_path / "b.csv"), "--topic", "/imu"]) == 0
    assert load_session(tmp_path / "b.csv").rate_dps == pytest.approx(np.array([0.1, -0.2, 1e-9]))


WITHOUT = "left out: encoder angle, temperature, counter,"


def recorded(folder: Path) -> Path:
    """A recording with raw bytes and events of its link, as `record --raw` writes it."""
    path = folder / "r.mcap"
    with path.open("wb") as file:
        writer = McapWriter(file, {"recording": {"note": "bench"}, "device": {"device_id": "7"}})
        writer.add_all([Sample(i, i / 100, i / 100, 0.5, 0.1 * i, 25.0) for i in range(10)])
        for i in range(4):
            writer.add_read(b"0,0.5\n", i / 100)
        writer.add_event("gap", 0.03, {"missing": 1})
        writer.finish()
    return path


@pytest.mark.parametrize(
    ("target", "options", "message_part"),
    [
        ("o.csv", [], "left out: 1 link event, 4 reads of raw bytes and metadata (recording, device)"),
        ("o.mcap", [], "left out: 1 link event and 4 reads of raw bytes"),
        ("o.mcap", ["--as", "json"], "left out: 1 link event and 4 reads of raw bytes"),
        (
            "o.mcap",
            ["--as", "imu"],
            f"rate in rad/s (sensor_msgs/msg/Imu); {WITHOUT} 1 link event and 4 reads of raw bytes",
        ),
    ],
)
def test_what_a_target_has_no_room_for_is_named(
    tmp_path: Path, target: str, options: list[str], message_part: str, capsys: pytest.CaptureFixture[str]
) -> None:
    path, out = recorded(tmp_path), str(tmp_path / target)
    for content in (path.read_bytes(), path.read_bytes()[:-200]):
        path.write_bytes(content)
        assert main(["convert", str(path), out, *options, "--force"]) == 0
        assert capsys.readouterr().err.startswith(f"gyrodrift: {out}: {message_part}\n")


def test_channels_of_others_and_comments_are_named_too(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = str(tmp_path / "o.csv")
    assert main(["convert", str(rest(tmp_path, "/a", "/b", "/c")), out, "--topic", "/b"]) == 0
    report = capsys.readouterr().err
    assert report.startswith(f"gyrodrift: {out}: left out: 20 messages on /a, 20 messages on /c and metadata (robot)\n")
    commented = tmp_path / "c.csv"
    commented.write_text(f"# bench\n{CSV}# the end\n")
    imu = str(tmp_path / "i.mcap")
    assert main(["convert", str(commented), imu, "--as", "imu"]) == 0
    assert "temperature, counter and 2 comment lines\n" in capsys.readouterr().err
    assert main(["convert", imu, out, "--force"]) == 0
    assert capsys.readouterr().err.startswith(f"gyrodrift: {out}: left out: orientation\n")


@pytest.mark.parametrize("options", [[], ["--as", "sample"]])
def test_own_samples_are_what_an_mcap_file_gets(tmp_path: Path, options: list[str]) -> None:
    assert main(["convert", str(session(tmp_path)), str(tmp_path / "o.mcap"), *options]) == 0
    reader = make_reader(io.BytesIO((tmp_path / "o.mcap").read_bytes()), validate_crcs=True)
    assert {schema.name for schema, _, _ in reader.iter_messages() if schema} == {"gyrodrift/Sample"}


def test_a_topic_of_another_file_becomes_a_session_of_ours(tmp_path: Path) -> None:
    path = rest(tmp_path, "/a", "/b")
    assert main(["convert", str(path), str(tmp_path / "o.mcap"), "--topic", "/b"]) == 0
    got = load_session(tmp_path / "o.mcap")
    assert got.rate_dps.tolist() == [1.0] * 20
    assert got.metadata["robot"] == {"name": "bench"}


def test_a_topic_of_our_own_file_may_be_named(tmp_path: Path) -> None:
    assert main(["convert", str(session(tmp_path)), str(tmp_path / "o.mcap")]) == 0
    assert main(["convert", str(tmp_path / "o.mcap"), str(tmp_path / "b.csv"), "--topic", "/gyro"]) == 0
    assert (tmp_path / "b.csv").read_text() == CSV


@pytest.mark.parametrize(
    ("arguments", "status", "message"),
    [
        (["others.mcap", "o.csv", "--topic", "/c"], 4, "has no messages on /c; topics are /a (no schema, json), /b"),
        (["none.mcap", "o.csv", "--topic", "/c"], 4, "none.mcap: cannot be read: No such file or directory"),
        (["others.mcap", "o.csv"], 4, "samples may be on /a, /b; choose one with gyrodrift convert --topic"),
        (["none.mcap", "o.csv"], 4, "none.mcap: there is no such session"),
        (["torn.mcap", "o.csv", "--topic", "/a"], 4, "torn.mcap: is damaged: a chunk cannot be opened"),
        (["s.csv", "o.mcap", "--topic", "/a"], 2, "--topic /a: needs an .mcap file or a bag as IN, s.csv is none"),
        (["s.csv", "o.csv", "--as", "json"], 2, "--as json: needs an .mcap file as OUT, o.csv is none"),
        (["s.csv", "o.csv", "--as", "sample"], 2, "--as sample: needs an .mcap file as OUT"),
        (["s.csv", "o.bag", "--as", "imu"], 2, "--as imu: needs an .mcap file as OUT"),
        (["s.csv", "o.mcap", "--as", "bag"], 2, "--as bag: there are sample, imu, json"),
        (
            ["late.csv", "o.mcap", "--as", "imu"],
            4,
            "o.mcap: sample 1 has 10000000000.0 as t_device_s, which does not fit header",
        ),
        (["s.csv", "none/o.mcap", "--as", "json"], 2, "none/o.mcap: cannot be written: No such file or directory"),
    ],
)
def test_mistakes_are_one_line_and_leave_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str], status: int, message: str
) -> None:
    monkeypatch.chdir(tmp_path)
    session(tmp_path)
    content = bytearray(rest(tmp_path, "/a", "/b").read_bytes())
    index = content.index(b"\x04\x22\x4d\x18")  # how a frame of lz4 begins
    content[index : index + 4] = b"\0\0\0\0"
    (tmp_path / "torn.mcap").write_bytes(content)
    (tmp_path / "late.csv").write_text("t_device_s,rate_dps\n1e10,0\n")
    before = sorted(tmp_path.iterdir())
    run = ended_here("convert", *arguments)
    assert run.status == status
    assert message in run.log
    assert run.log.startswith(("gyrodrift: ", "usage: "))
    assert "Traceback" not in run.log
    assert sorted(tmp_path.iterdir()) == before
