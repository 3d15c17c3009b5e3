"""`gyrodrift record` and its link, to the last sample and byte: what was sent is what is recorded."""

import json
import os
import pty
import signal
import subprocess
import sys
from itertools import islice
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest
from disk_support import fill, read_only_disk, small_disk
from mcap.reader import make_reader
from mcap.stream_reader import StreamReader
from support import PATIENCE_S, Command, Recording, are_recorded, never, speaking_on

from firmware_sim.measure import measure
from firmware_sim.motion.profile import load_profile
from firmware_sim.rig import Base, Rig
from firmware_sim.wire.csv import csv_line
from firmware_sim.wire.registry import ENCODERS
from gyrodrift.link.protocols.registry import PROTOCOLS
from gyrodrift.session.mcap.raw import read_raw
from gyrodrift.session.mcap.read import read_mcap

RIG = Rig(base=Base(bias_dps=0.3))


def spoken(protocol: str, count: int) -> list[bytes]:
    frames = ENCODERS[protocol].frames(measure(RIG, load_profile("turntable"), 1), RIG.base)
    return [frame.content for frame in islice(frames, count)]


def lines(first: int, count: int) -> bytes:
    """100 Hz, the rate counts the samples."""
    return b"".join(csv_line(10_000 * i, i / 4.0, None, None) for i in range(first, first + count))


def rates_in(folder: Path) -> list[float]:
    return [rate for path in in_order(folder) for rate in read_mcap(path).rate_dps.tolist()]


def in_order(folder: Path) -> list[Path]:
    """Files by when they begin: those of one second have numbers, not digits, in their names."""
    return sorted(folder.glob("*.mcap"), key=lambda path: path.stat().st_ino)


def check_closed(path: Path) -> None:
    with path.open("rb") as file:
        assert type(list(StreamReader(file, validate_crcs=True).records)[-1]).__name__ == "Footer"


def events_in(path: Path) -> list[dict[str, Any]]:
    with path.open("rb") as file:
        return [json.loads(message.data) for _, _, message in make_reader(file).iter_messages(["/link"])]


@pytest.mark.parametrize("given", ["auto", "named"])
@pytest.mark.parametrize("protocol", ["native", "csv", "witmotion"])
def test_every_sample_that_was_sent_is_recorded_to_the_last(
    out: Path, protocol: str, given: str, recording: Recording
) -> None:
    content = b"".join(spoken(protocol, 700))
    expected = PROTOCOLS[protocol].decoder().push(content)
    assert len(expected) > 690
    options = ("--protocol", protocol, "--baud", "115200") if given == "named" else ()
    with recording(*options) as (device, record):
        for index in range(0, len(content), len(content) // 10):  # arrivals are the clock of a device that has none
            device.send_all(content[index : index + len(content) // 10], never)
            device.drain(never)
        assert record.stop() == 0
    (path,) = out.glob("*.mcap")
    check_closed(path)
    session = read_mcap(path)
    assert session.rate_dps.tolist() == [reading.rate_dps for reading in expected]
    assert session.temp_c is not None
    assert session.temp_c.tolist() == [reading.temp_c for reading in expected]
    if protocol == "witmotion":
        assert session.encoder_deg is None
        assert (np.diff(session.t_device_s) > 0.0).all()
    else:
        assert session.encoder_deg is not None
        assert session.encoder_deg.tolist() == [reading.encoder_deg for reading in expected]
        assert session.t_device_s.tolist() == [(reading.t_us or 0) / 1e6 for reading in expected]
    if protocol == "native":
        assert session.seq is not None
        assert session.seq.tolist() == [reading.seq for reading in expected]
    assert session.metadata["recording"]["protocol"] == protocol
    assert session.metadata["link"]["samples"] == str(len(expected))


def test_the_simulator_is_recorded_in_real_time(port: Path, out: Path) -> None:
    """Two processes that know nothing of each other; its counter has no hole."""
    with Command("--link", port, "--quiet", "--wait", module="firmware_sim") as simulator:
        simulator.until(lambda _: port.is_symlink(), "port")
        with Command("record", "--port", port, "--out", out, "--duration", "2") as record:
            assert record.end() == 0
    (path,) = out.glob("*.mcap")
    session = read_mcap(path)
    assert len(session.rate_dps) == 200
    assert session.seq is not None
    assert set(np.diff(session.seq).tolist()) == {1}
    assert record.out == f"{path}\n"


@pytest.mark.parametrize("rotate", ["3kB", "1s"])
def test_with_rotation_every_sample_and_byte_is_in_one_of_the_files(
    out: Path, rotate: str, recording: Recording
) -> None:
    """The last one too; each file is closed, and its name is on stdout."""
    options = ("--rotate", rotate, "--raw")
    sent = b""
    with recording(*options) as (device, record):
        while len(list(out.glob("*.mcap"))) < 4:
            piece = lines(sent.count(b"\n"), 20)
            device.send_all(piece, never)
            sent += piece
            record._read(0.05)
            assert len(sent) < 1_000_000
        device.drain(never)
        assert record.stop() == 0
    paths = [Path(line) for line in record.out.splitlines()]
    assert sorted(paths) == sorted(out.glob("*.mcap"))
    for path in paths:
        check_closed(path)
    assert [rate for path in paths for rate in read_mcap(path).rate_dps.tolist()] == [
        i / 4.0 for i in range(sent.count(b"\n"))
    ]
    assert b"".join(read.content for path in paths for read in read_raw(path)) == sent
    before = [read_mcap(path).metadata["recording"].get("continues") for path in paths]
    assert before == [None, *(path.name for path in paths[:-1])]


def test_what_happened_on_the_link_is_in_the_file(out: Path, recording: Recording) -> None:
    with recording() as (device, record):
        device.send_all(lines(0, 100) + lines(150, 100), never)
        record.until_log("event=gap")
        device.send_all(lines(0, 100), never)
        record.until_log("event=device_reset")
        device.drain(never)
        assert record.stop() == 0
    (path,) = out.glob("*.mcap")
    events = events_in(path)
    assert [event["event"] for event in events] == ["protocol_found", "gap", "device_reset"]
    assert (events[1]["holes"], events[1]["missing"]) == (1, 50)
    assert len(read_mcap(path).rate_dps) == 300
    with path.open("rb") as file:
        times_s = [message.log_time * 1e-9 for _, _, message in make_reader(file).iter_messages(["/link"])]
    assert times_s == pytest.approx([event["t_host_s"] for event in events])
    assert read_mcap(path).metadata["link"]["gaps"] == "1"


def test_bytes_of_a_device_that_nobody_understands_are_in_a_closed_file(
    port: Path, out: Path, recording: Recording
) -> None:
    """The status is that of the link, the file is whole all the same, and its name is on stdout."""
    sent = Random(8).randbytes(5000).replace(b"\n", b"x")
    options = ("--raw", "--baud", "9600", "--timeout", "1")
    with recording(*options) as (device, record):
        device.send_all(sent, never)
        assert record.end() == 3
    (path,) = out.glob("*.mcap")
    check_closed(path)
    assert b"".join(read.content for read in read_raw(path)) == sent
    assert record.out == f"{path}\n"
    assert record.log.splitlines()[-1].startswith(f"gyrodrift: {port}: 5000 bytes arrived within 1 s")


@pytest.mark.parametrize("options", [(), ("--duration", "1000"), ("--raw", "--rotate", "1h")])
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_in_the_middle_of_a_stream_closes_the_file(
    out: Path, number: signal.Signals, options: tuple[str, ...], recording: Recording
) -> None:
    with recording(*options) as (device, record):
        for first in range(0, 4000, 20):
            if first == 2000:
                record.until(lambda _: are_recorded(500, out), "samples")
                record.process.send_signal(number)
            if not device.send_all(lines(first, 20), lambda: record.process.poll() is not None):
                break
        assert record.end() == 0
    rates = [rate for line in record.out.splitlines() for rate in read_mcap(Path(line)).rate_dps.tolist()]
    assert len(rates) > 500
    assert rates == [i / 4.0 for i in range(len(rates))]
    for path in out.glob("*.mcap"):
        check_closed(path)


def test_a_pipe_gets_no_live_line(out: Path, recording: Recording) -> None:
    """Log lines on stderr, paths on stdout, and nothing else on either."""
    with recording("--duration", "0.5") as (device, record):
        device.send_all(lines(0, 100), never)
        assert record.end() == 0
    assert all(line.startswith("timestamp=") for line in record.log.splitlines())
    assert "\x1b" not in record.log
    assert "\r" not in record.log
    assert record.out.splitlines() == [str(path) for path in out.glob("*.mcap")]


def test_a_terminal_that_is_hung_up_does_not_end_a_recording(port: Path, out: Path) -> None:
    master, slave = pty.openpty()
    command = [sys.executable, "-m", "gyrodrift", "record", "--port", str(port), "--out", str(out)]
    with speaking_on(port) as device:
        record = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=slave)
        os.close(slave)
        device.wait_for_reader(never)
        device.send_all(lines(0, 100), never)
        shown = b""
        while b" 100 samples" not in shown:
            shown += os.read(master, 4096)
        os.close(master)
        device.send_all(lines(100, 100) + lines(300, 100), never)
        device.drain(never)
        record.terminate()
        assert record.wait(PATIENCE_S) == 0
    assert rates_in(out) == [i / 4.0 for i in [*range(200), *range(300, 400)]]


def test_a_full_disk_ends_it_with_one_line(port: Path, out: Path) -> None:
    """A real one, of 64 kB."""
    with small_disk(out, "64k"), speaking_on(port) as device:
        with Command("record", "--port", port, "--out", out) as record:
            device.wait_for_reader(never)
            for first in range(0, 100_000, 20):
                if not device.send_all(lines(first, 20), lambda: record.process.poll() is not None):
                    break
            assert record.end() == 4
        report = [line for line in record.log.splitlines() if line.startswith("gyrodrift: ")]
        assert len(report) == 1
        assert "recording stopped: No space left on device; 65536 bytes are written and stay readable" in report[0]
        assert "Traceback" not in record.log
        assert record.out.splitlines() == [str(path) for path in out.glob("*.mcap")]
        rates = rates_in(out)
        assert len(rates) > 700
        assert rates == [i / 4.0 for i in range(len(rates))]


def test_a_disk_that_is_full_from_the_start_is_told_and_no_file_is_left(port: Path, out: Path) -> None:
    with small_disk(out, "64k"), speaking_on(port) as device:
        fill(out)
        with Command("record", "--port", port, "--out", out) as record:
            device.wait_for_reader(never)
            device.send_all(lines(0, 200), lambda: record.process.poll() is not None)
            assert record.end() == 4
        assert "No space left on device" in record.log.splitlines()[-1]
        assert (record.out, [path.name for path in out.iterdir()]) == ("", ["fill"])


def test_a_disk_that_takes_nothing_is_told_before_anything_is_recorded(port: Path, out: Path) -> None:
    with (
        read_only_disk(out),
        speaking_on(port),
        Command("record", "--port", port, "--out", out, "--log-level", "error") as record,
    ):
        assert record.end() == 2
    assert len(record.log.splitlines()) == 1
    assert record.log.startswith(f"gyrodrift: {out}: cannot be ")
    assert record.log.endswith(": Read-only file system\n")


def test_a_folder_removed_under_a_silent_device_is_noticed_at_once(out: Path, recording: Recording) -> None:
    with recording() as (device, record):
        device.send_all(lines(0, 100), never)
        device.drain(never)
        record.until(lambda _: are_recorded(100, out), "samples on disk")
        for path in out.iterdir():
            path.unlink()
        out.rmdir()
        assert record.end() == 4
    assert "event=link_silent" not in record.log
    assert "was removed while it was being written; it was restored with everything that was recorded" in record.log
    assert len(rates_in(out)) == 100


def test_a_damaged_file_in_the_folder_does_not_keep_it_from_recording(out: Path, recording: Recording) -> None:
    out.mkdir()
    (out / "a.mcap").write_bytes(b"\x89MCAP0\r\n" + b"\x01" + bytes(8) + b"\x05" + (3).to_bytes(8, "little") + b"abc")
    (out / "b.mcap").symlink_to("nowhere")
    (out / "c.mcap").mkdir()
    (out / "d.mcap").touch()
    with recording("--duration", "0.5") as (device, record):
        device.send_all(lines(0, 100), never)
        assert record.end() == 0
    assert record.log.count("event=not_repaired") == 1  # in d nothing has begun
    assert len(read_mcap(Path(record.out.strip())).rate_dps) == 50
