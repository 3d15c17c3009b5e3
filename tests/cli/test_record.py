"""`gyrodrift record`, the real command, on a pty: what was sent is in the file, and the file says where it is from."""

import os
import pty
import subprocess
import sys
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from random import Random

import numpy as np
import pytest
from mcap.reader import make_reader
from support import PATIENCE_S, Command, Recording, are_recorded, near, never, speaking_on

from firmware_sim.measure import measure
from firmware_sim.motion.profile import load_profile
from firmware_sim.rig import load_rig
from firmware_sim.wire.csv import csv_line
from firmware_sim.wire.registry import ENCODERS
from gyrodrift.session.mcap.raw import read_raw
from gyrodrift.session.mcap.read import read_mcap
from gyrodrift.session.session import Session


def lines(count: int, first: int = 0) -> bytes:
    """100 Hz, the rate counts the samples."""
    return b"".join(csv_line(10_000 * i, i / 4.0, None, None) for i in range(first, first + count))


def recorded(folder: Path) -> list[Session]:
    return [read_mcap(path) for path in sorted(folder.glob("*.mcap"))]


def frames(protocol: str, count: int) -> Iterator[bytes]:
    rig = load_rig(None)
    for frame in ENCODERS[protocol].frames(measure(rig, load_profile("turntable"), 1), rig.base):
        if count <= 0:
            return
        count -= frame.rows
        yield frame.content


@pytest.mark.parametrize("protocol", ["native", "csv"])
def test_every_sample_of_a_device_is_recorded(out: Path, protocol: str, recording: Recording) -> None:
    with recording() as (device, record):
        device.send_all(b"".join(frames(protocol, 500)), never)
        device.drain(never)
        record.until(lambda _: are_recorded(495, out), "samples on disk")
        assert record.stop() == 0
    (session,) = recorded(out)
    first = next(iter(measure(load_rig(None), load_profile("turntable"), 1)))
    count = len(session.rate_dps)
    assert count >= 495
    assert session.rate_dps == pytest.approx(first.rate_raw[:count] * 0.00763, rel=1e-6)
    assert session.encoder_deg == pytest.approx(first.encoder_counts[:count] / 100.0)
    assert session.t_device_s == pytest.approx(first.t_device_us[:count] / 1e6)
    assert session.seq is not None
    assert np.diff(session.seq).tolist() == [1] * (count - 1)
    assert record.out.splitlines() == [str(path) for path in out.glob("*.mcap")]
    assert "level=warning" not in record.log


def test_a_device_without_a_clock_is_recorded(port: Path, out: Path) -> None:
    arguments = ("--link", port, "--protocol", "witmotion", "--quiet", "--wait")
    with Command(*arguments, module="firmware_sim"):
        while not port.is_symlink():
            os.sched_yield()
        with Command("record", "--port", port, "--out", out, "--duration", "2") as record:
            assert record.end() == 0
    (session,) = recorded(out)
    assert len(session.rate_dps) == pytest.approx(200, abs=10)
    assert session.metadata["recording"]["protocol"] == "witmotion"


def test_what_is_known_stands_in_the_name_and_in_the_file(port: Path, out: Path, recording: Recording) -> None:
    """Device, profile, note, program and port."""
    options = ("--profile", "slow turns", "--note", "new bearing", "--duration", "1")
    with recording(*options) as (device, record):
        device.send_all(b"".join(frames("native", 300)), never)
        assert record.end() == 0
    (path,) = out.glob("*.mcap")
    assert path.name[4] == path.name[7] == "-"
    assert path.name.endswith("Z_firmware-sim_slow-turns.mcap")
    session = read_mcap(path)
    assert session.metadata["device"]["device_id"] == "firmware_sim"
    about = session.metadata["recording"]
    assert (about["note"], about["profile"], about["port"]) == ("new bearing", "slow turns", str(port))
    assert about["program"].startswith("gyrodrift ")
    assert int(session.metadata["link"]["samples"]) >= len(session.rate_dps)


def test_duration_is_device_time(out: Path, recording: Recording) -> None:
    with recording("--duration", "7") as (device, record):
        device.send_all(lines(1000), never)
        assert record.end() == 0
    (session,) = recorded(out)
    assert session.rate_dps.tolist() == [i / 4.0 for i in range(700)]


def test_duration_ends_for_a_device_that_fell_silent(out: Path, recording: Recording) -> None:
    with recording("--duration", "1.5") as (device, record):
        device.send_all(lines(100), never)
        assert record.end() == 0
    (session,) = recorded(out)
    assert len(session.rate_dps) == 100


@pytest.mark.parametrize("rotate", ["10kB", "0.5s"])
def test_between_two_files_nothing_is_lost(port: Path, out: Path, rotate: str) -> None:
    with speaking_on(port) as device, Command("record", "--port", port, "--out", out, "--rotate", rotate) as record:
        device.wait_for_reader(never)
        sent = 0
        while len(list(out.glob("*.mcap"))) < 4:
            device.send_all(lines(20, sent), never)
            sent += 20
            record._read(0.05)
            assert sent < 20_000
        device.drain(never)
        assert record.stop() == 0
    sessions = recorded(out)
    assert len(sessions) >= 4
    rates = np.concatenate([session.rate_dps for session in sessions])
    assert rates.tolist() == [i / 4.0 for i in range(len(rates))]
    assert len(rates) > sent - 60
    assert all("continues" in session.metadata["recording"] for session in sessions[1:])


def test_raw_bytes_are_kept_as_they_came(out: Path, recording: Recording) -> None:
    """Damage included, each read with its time."""
    random = Random(5)
    sent = lines(200) + random.randbytes(700) + b"\n" + lines(200, 200)
    with recording("--raw") as (device, record):
        device.send_all(sent, never)
        device.drain(never)
        record.until(lambda _: are_recorded(390, out, len(sent)), "all on disk")
        assert record.stop() == 0
    (path,) = out.glob("*.mcap")
    reads = list(read_raw(path))
    assert b"".join(read.content for read in reads) == sent
    assert all(before.t_host_s <= after.t_host_s for before, after in pairwise(reads))
    with path.open("rb") as file:
        topics = {channel.topic for _, channel, _ in make_reader(file, validate_crcs=True).iter_messages()}
    assert topics == {"/gyro", "/raw", "/link"}


def test_two_recordings_into_one_folder_do_not_meet(tmp_path: Path, out: Path) -> None:
    ports = [tmp_path / "a", tmp_path / "b"]
    with (
        speaking_on(ports[0]) as item,
        speaking_on(ports[1]) as peer,
        Command("record", "--port", ports[0], "--out", out, "--duration", "1") as first,
        Command("record", "--port", ports[1], "--out", out, "--duration", "1") as second,
    ):
        for device in (item, peer):
            device.wait_for_reader(never)
        for device in (item, peer):
            device.send_all(lines(150), never)
        assert first.end() == second.end() == 0
    assert [len(session.rate_dps) for session in recorded(out)] == [100, 100]


def test_a_full_disk_is_told_and_what_was_written_stays(port: Path, out: Path) -> None:
    limited = "import resource, sys; resource.setrlimit(resource.RLIMIT_FSIZE, (42000, 42000)); "
    start = "sys.dont_write_bytecode = True; from gyrodrift.cli import main; sys.exit(main(sys.argv[1:]))"
    command = [sys.executable, "-c", limited + start, "record", "--port", str(port), "--out", str(out)]
    with speaking_on(port) as device:
        record = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        device.wait_for_reader(never)
        device.send_all(lines(2000), record.poll)  # type: ignore[arg-type]  # None while it runs
        _, error = record.communicate(timeout=PATIENCE_S)
    assert record.returncode == 4
    assert "recording stopped: File too large; 42000 bytes are written and stay readable" in error
    assert "Traceback" not in error
    (session,) = recorded(out)
    assert session.rate_dps.tolist() == [i / 4.0 for i in range(len(session.rate_dps))]
    assert len(session.rate_dps) > 450


@pytest.mark.promise("Crashes")
def test_a_recording_that_another_program_truncates_ends_with_an_error(out: Path, recording: Recording) -> None:
    """`record` ends with status 4 if another program truncates its file."""
    with recording() as (device, record):
        device.send_all(lines(300), never)
        record.until(lambda _: are_recorded(290, out), "samples on disk")
        (path,) = out.iterdir()
        os.truncate(path, 5000)
        assert record.end() == 4
    assert "another program has truncated it while it was being written" in record.log


@pytest.mark.parametrize(
    ("options", "status", "message"),
    [
        (["--rotate", "often"], 2, "--rotate often: expected a size such as 100MB or 2GB, or a time such as"),
        (["--duration", "-1"], 2, "--duration"),
        (["--out", "{file}/x"], 2, "/x: cannot be written to: Not a directory"),
        (["--port", "/dev/ttyNONE"], 3, "/dev/ttyNONE: there is no such port"),
        (["--timeout", "0.3"], 3, "the device sent nothing within 0.3 s"),
    ],
)
def test_mistakes_are_one_line(port: Path, out: Path, options: list[str], status: int, message: str) -> None:
    (out.parent / "file").touch()
    words = [word.format(file=out.parent / "file") for word in options]
    with speaking_on(port), Command("record", "--port", port, "--out", out, *words) as record:
        assert record.end() == status
    assert message in record.log.splitlines()[-1] or message in record.log
    assert "Traceback" not in record.log
    assert record.out == ""


def test_a_terminal_shows_how_it_goes(port: Path, out: Path) -> None:
    master, slave = pty.openpty()
    command = [sys.executable, "-m", "gyrodrift", "record", "--port", str(port), "--out", str(out), "--duration", "1"]
    with speaking_on(port) as device:
        record = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=slave)
        os.close(slave)
        device.wait_for_reader(never)
        device.send_all(lines(90), never)
        shown = b""
        while True:
            try:
                chunk = os.read(master, 4096)
            except OSError:
                break
            shown += chunk
        record.wait()
        os.close(master)
    line = [part for part in shown.decode().split("\r\x1b[K") if " Hz" in part and "samples" in part][-1]
    assert " 90 samples   0 gaps   0 damaged   " in line
    assert "   yaw " in line
    assert " GB left" in line


def test_a_recording_beside_serve_has_every_sample(port: Path, out: Path) -> None:
    config = out.parent / "c.yaml"
    config.write_text("hdr: {i_c_dps: 0.001, tau_s: 0.1, theta_w_dps: 1, c1: 0, c2: 1}\n")
    bad = csv_line(2_000_000, 1.0, None, None).replace(b"1.0", b"nan")
    with speaking_on(port) as device, Command("serve", "--port", port, "--record", out, "--config", config) as serve:
        device.wait_for_reader(never)
        device.send_all(lines(200) + bad + lines(100, 201), never)
        served = serve.take_lines(300)
        assert serve.stop() == 0
    (session,) = recorded(out)
    assert len(session.rate_dps) == len(served) + 1 == 301
    assert np.isnan(session.rate_dps[200])
    assert session.t_device_s[:200].tolist() == [line["t_s"] for line in served[:200]]
    assert session.metadata["config"]["text"] == config.read_text()
    assert near(session.rate_dps[-1]) == 300 / 4.0


def test_serve_goes_on_when_its_recording_fails(port: Path, out: Path) -> None:
    """The reason is in the log, every sample on stdout, and each in the file that was put back or in the next one."""
    with speaking_on(port) as device, Command("serve", "--port", port, "--record", out) as serve:
        device.wait_for_reader(never)
        device.send_all(lines(200), never)
        serve.take_lines(190)
        serve.until(lambda _: are_recorded(190, out), "samples on disk")
        for path in out.iterdir():
            path.unlink()
        out.rmdir()
        serve.until_log("recording_failed")
        device.send_all(lines(200, 200), never)
        serve.take_lines(200)
        assert serve.stop() == 0
    assert "was removed while it was being written" in serve.log
    assert sum(len(session.t_device_s) for session in recorded(out)) == 400
