"""`gyrodrift serve --record`: every sample in the file too, and a recording that fails is nobody else's trouble."""

import resource
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import structlog
from disk_support import fill, small_disk, wait_for_disks
from support import PATIENCE_S, Command, never, speaking_on

from firmware_sim.wire.csv import csv_line
from gyrodrift.link.events import LinkEvents
from gyrodrift.link.link import Link
from gyrodrift.link.options import LinkOptions
from gyrodrift.recording import resilient as recording
from gyrodrift.recording.recorder import RecordOptions
from gyrodrift.recording.resilient import ResilientRecorder
from gyrodrift.session.mcap.read import read_mcap
from gyrodrift.values.sample import Sample

SMALL = 40_000


@pytest.fixture(autouse=True)
def disks_at_rest() -> Iterator[None]:
    yield
    wait_for_disks()


@pytest.fixture
def out(tmp_path: Path) -> Path:
    return tmp_path / "sessions"


@pytest.fixture
def link(port: Path, logged: list[Any]) -> Iterator[Link]:
    with speaking_on(port):
        link = Link(LinkOptions(str(port)), LinkEvents(structlog.get_logger()))
        yield link
        link.close()


def rate_dps(i: int) -> float:
    return (i % 64) / 4.0


def lines(first: int, count: int) -> bytes:
    """100 Hz; the rate counts 64 samples again and again."""
    return b"".join(csv_line(10_000 * i, rate_dps(i), None, None) for i in range(first, first + count))


def samples(first: int, count: int) -> list[Sample]:
    return [Sample(i, i / 100, 1.7e9 + i / 100, rate_dps(i)) for i in range(first, first + count)]


def rates_in(path: Path) -> list[float]:
    rates: list[float] = read_mcap(path).rate_dps.tolist()
    return rates


def test_samples_that_the_filter_passes_by_are_in_the_file(port: Path, out: Path) -> None:
    """Time that stands still and rates that are no numbers, each in its place; stdout has the others."""
    stand_still = csv_line(990_000, 777.0, None, None)
    no_number = b"%d,nan\n%d,inf\n" % (2_000_000, 2_010_000)
    content = lines(0, 100) + stand_still + lines(100, 100) + no_number + lines(202, 100)
    with speaking_on(port) as device, Command("serve", "--port", port, "--record", out) as serve:
        device.wait_for_reader(never)
        device.send_all(content, never)
        served = serve.take_lines(300)
        serve.until_log("samples_rejected")
        assert serve.stop() == 0
    (path,) = out.glob("*.mcap")
    numbers = [*range(100), *range(100, 200), *range(202, 302)]
    assert [line["rate_dps"] for line in served] == [rate_dps(i) for i in numbers]
    rates = rates_in(path)
    assert len(rates) == 303
    assert rates[100] == 777.0
    assert [str(rate) for rate in rates[201:203]] == ["nan", "inf"]
    assert [*rates[:100], *rates[101:201], *rates[203:]] == [rate_dps(i) for i in numbers]


def check_that_lines_go_on(serve: Command, device: Any, sent: int) -> None:
    """After its recording has failed."""
    serve.until_log("event=recording_failed")
    device.send_all(lines(sent, 500), never)
    serve.until(lambda command: command.out.count("\n") == sent + 500, "line of every sample")
    assert [line["rate_dps"] for line in serve.all_lines()] == [rate_dps(i) for i in range(sent + 500)]
    assert serve.stop() == 0
    assert "Traceback" not in serve.log


def send_until_it_fails(serve: Command, device: Any) -> int:
    """Samples in portions, with time between them for the disk; how many."""
    sent = 0
    until_s = time.monotonic() + PATIENCE_S
    while "event=recording_failed" not in serve.log:
        device.send_all(lines(sent, 20), never)
        sent += 20
        serve._read(0.005)
        assert time.monotonic() < until_s, serve.log
    return sent


def test_a_file_that_must_not_grow_is_told_and_every_sample_is_still_a_line(
    port: Path, out: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A limit on the size of files stands for a full disk; half a file of bytecode must not stay for others."""
    monkeypatch.setenv("PYTHONDONTWRITEBYTECODE", "1")
    with speaking_on(port) as device, Command("serve", "--port", port, "--record", out) as serve:
        resource.prlimit(serve.process.pid, resource.RLIMIT_FSIZE, (SMALL, SMALL))
        device.wait_for_reader(never)
        check_that_lines_go_on(serve, device, send_until_it_fails(serve, device))
    assert f"recording stopped: File too large; {SMALL} bytes are written and stay readable" in serve.log
    rates = rates_in(next(out.glob("*.mcap")))
    assert len(rates) > 400
    assert rates == [rate_dps(i) for i in range(len(rates))]


def test_a_full_disk_is_told_and_every_sample_is_still_a_line(port: Path, out: Path) -> None:
    """A real one, of 256 kB."""
    with small_disk(out, "256k"), speaking_on(port) as device:
        with Command("serve", "--port", port, "--record", out) as serve:
            device.wait_for_reader(never)
            check_that_lines_go_on(serve, device, send_until_it_fails(serve, device))
        assert "recording stopped: No space left on device; 262144 bytes are written" in serve.log
        rates = rates_in(next(out.glob("*.mcap")))
        assert len(rates) > 2700  # of 3000; a line of link statistics each 10 s takes room, too
        assert rates == [rate_dps(i) for i in range(len(rates))]


@pytest.mark.promise("Recovery")
def test_recording_goes_on_when_a_full_disk_has_room_again(out: Path, link: Link, logged: list[Any]) -> None:
    """A full disk ends the recording of `serve`, not the service; recording is tried again after 10 s."""
    with small_disk(out, "64k"):
        filler = fill(out)
        next_to = ResilientRecorder(RecordOptions(out), link, structlog.get_logger())
        now_s = 0.0
        for _ in range(3):
            next_to.take(samples(0, 100))
            while next_to.recorder is not None:
                now_s = max(now_s, next_to._failed_s) + 0.25
                next_to.tick(now_s)
            assert "No space left on device" in logged[-1]["reason"]
            now_s = max(now_s, next_to._failed_s) + recording.RETRY_S + 0.25
            next_to.tick(now_s)
        assert list(out.iterdir()) == [filler]
        filler.unlink()
        next_to.take(samples(100, 100))
        next_to.close()
        (path,) = out.iterdir()
        assert rates_in(path) == [rate_dps(i) for i in range(100, 200)]
    assert [event["event"] for event in logged].count("recording_failed") == 3


def test_a_name_taken_by_another_recording_is_no_failure(
    out: Path, link: Link, logged: list[Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two services may write into one folder."""
    item, second = (ResilientRecorder(RecordOptions(out), link, structlog.get_logger()) for _ in range(2))
    item.take(samples(0, 10))
    second.take(samples(10, 10))
    item.close()
    second.close()
    assert sorted(rates_in(path)[0] for path in out.iterdir()) == [0.0, 2.5]
    assert not [event for event in logged if event["event"] == "recording_failed"]


@pytest.mark.promise("Crashes")
def test_a_config_that_changes_while_it_is_recorded_is_in_the_recording(port: Path, out: Path, tmp_path: Path) -> None:
    """A recording holds the config that was in force."""
    config = tmp_path / "c.yaml"
    config.write_text("filter: hdr\nhdr: {theta_w_dps: 0.5}\n")
    words = ("--port", port, "--config", config, "--record", out, "--rotate", "2kB")
    with speaking_on(port) as device, Command("serve", *words) as serve:
        device.wait_for_reader(never)
        device.send_all(lines(0, 100), never)
        serve.take_lines(100)
        config.write_text("filter: hdr\nhdr: {theta_w_dps: 0.9}\n")
        serve.until_log("config_applied")
        for first in (100, 200):
            device.send_all(lines(first, 100), never)
            serve.take_lines(100)
            time.sleep(0.3)  # a file ends with the turn of the loop after it is full
        assert serve.stop() == 0
    files = sorted(out.glob("*.mcap"), key=lambda path: float(read_mcap(path).t_device_s[0]))
    texts = [read_mcap(path).metadata["config"]["text"] for path in files]
    assert texts[0].endswith("{theta_w_dps: 0.5}\n")
    assert texts[-1].endswith("{theta_w_dps: 0.9}\n")
    assert any(b"theta_w_dps: 0.5 \\u2192 0.9" in path.read_bytes() for path in files)
