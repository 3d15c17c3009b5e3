"""Recording beside the filter: a failure is logged, and recording begins again."""

import os
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
import structlog
from disk_support import wait_for_disks
from support import PATIENCE_S, speaking_on

from gyrodrift.link.events import LinkEvents
from gyrodrift.link.link import Link
from gyrodrift.link.options import LinkOptions
from gyrodrift.recording import disk
from gyrodrift.recording import resilient as recording
from gyrodrift.recording.disk import ChangedFileError, RecordingError
from gyrodrift.recording.recorder import RecordOptions
from gyrodrift.recording.resilient import ResilientRecorder
from gyrodrift.session.mcap.read import read_mcap
from gyrodrift.values.sample import Sample


@pytest.fixture(autouse=True)
def disks_at_rest() -> Iterator[None]:
    yield
    wait_for_disks()


@pytest.fixture
def logged() -> Iterator[list[Any]]:
    with structlog.testing.capture_logs() as events:
        yield events


@pytest.fixture
def link(tmp_path: Path, logged: list[Any]) -> Iterator[Link]:
    with speaking_on(tmp_path / "gyro"):
        link = Link(LinkOptions(str(tmp_path / "gyro")), LinkEvents(structlog.get_logger()))
        yield link
        link.close()


def samples(first: int) -> list[Sample]:
    return [Sample(i, i / 100, 1.7e9 + i / 100, float(i)) for i in range(first, first + 100)]


def test_after_a_failure_it_begins_a_new_file(
    tmp_path: Path, link: Link, logged: list[Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """When the time has come; the service notices nothing."""
    beside = ResilientRecorder(RecordOptions(tmp_path / "out"), link, structlog.get_logger())
    beside.take(samples(0))
    assert beside.recorder is not None

    def fail(_now_s: float) -> None:
        raise RecordingError("the disk is on fire")

    monkeypatch.setattr(beside.recorder, "tick", fail)
    beside.tick(0.0)
    assert logged[-1] == {
        "event": "recording_failed",
        "log_level": "error",
        "reason": "the disk is on fire",
        "next_try_s": recording.RETRY_S,
    }
    beside.take(samples(100))
    beside.on_event("gap", {})
    assert beside.stats() == {"recorded": None, "unrecorded": 200}
    beside.tick(beside._failed_s + 0.9 * recording.RETRY_S)
    assert beside.recorder is None
    wait_for_disks()
    beside.tick(beside._failed_s + 2 * recording.RETRY_S)
    beside.take(samples(200))
    tick_until(beside, lambda: logged[-1]["event"] == "recording_resumed")
    assert logged[-1]["unrecorded"] == 200  # what the recorder had and no file, and what came meanwhile
    beside.close()
    files = [read_mcap(path) for path in sorted((tmp_path / "out").glob("*.mcap")) if path.stat().st_size > 5000]
    assert files[-1].rate_dps.tolist() == [float(i) for i in range(200, 300)]


def test_after_another_program_changed_the_file_a_new_one_begins_at_once(
    tmp_path: Path, link: Link, logged: list[Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The disk is well; a file that is changed again and again is tried every 10 s."""
    beside = ResilientRecorder(RecordOptions(tmp_path / "out"), link, structlog.get_logger())

    def fail(_now_s: float) -> None:
        raise ChangedFileError("it was truncated")

    assert beside.recorder is not None
    monkeypatch.setattr(beside.recorder, "tick", fail)
    beside.tick(0.0)
    assert logged[-1]["next_try_s"] == 0.0
    assert beside.recorder is not None
    beside.take(samples(0))
    monkeypatch.setattr(beside.recorder, "tick", fail)
    beside.tick(0.0)
    assert logged[-1]["next_try_s"] == recording.RETRY_S
    assert beside.recorder is None
    beside.close()


def test_where_it_still_fails_it_is_told_again(tmp_path: Path, link: Link, logged: list[Any]) -> None:
    """And tried again later."""
    out = tmp_path / "out"
    beside = ResilientRecorder(RecordOptions(out), link, structlog.get_logger())
    out.rmdir()
    out.touch()
    beside.take(samples(0))
    tick_until(beside, lambda: "recording stopped: File exists" in logged[-1].get("reason", ""))
    beside.tick(beside._failed_s + 2 * recording.RETRY_S)
    beside.take(samples(100))
    tick_until(beside, lambda: [each["event"] for each in logged].count("recording_failed") == 2)
    out.unlink()
    beside.tick(beside._failed_s + 2 * recording.RETRY_S)
    beside.take(samples(200))
    tick_until(beside, lambda: logged[-1]["event"] == "recording_resumed")
    beside.close()
    events = [each["event"] for each in logged if each["event"] in ("recording_failed", "recording_resumed")]
    assert events == ["recording_failed", "recording_failed", "recording_resumed"]


def test_while_a_disk_hangs_nothing_more_is_begun_on_it(
    tmp_path: Path, link: Link, logged: list[Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each try would leave another thread that waits; the service goes on, and counts what is not recorded."""
    go_on = threading.Event()
    real = os.fsync
    monkeypatch.setattr(os, "fsync", lambda fd: go_on.wait(PATIENCE_S) and real(fd))
    monkeypatch.setattr(disk, "MOST_WAITING_BYTES", 15_000)
    beside = ResilientRecorder(RecordOptions(tmp_path / "out"), link, structlog.get_logger())
    for first in range(0, 300, 100):
        beside.take(samples(first))
        beside.tick(0.0)
    assert "the disk is too slow" in logged[-1]["reason"]
    before = threading.active_count()
    for _ in range(3):
        beside.tick(beside._failed_s + 2 * recording.RETRY_S)
        assert logged[-1]["reason"].endswith("the disk hangs")
    assert threading.active_count() == before
    go_on.set()
    wait_for_disks()
    beside.tick(beside._failed_s + 2 * recording.RETRY_S)
    beside.take(samples(300))
    tick_until(beside, lambda: logged[-1]["event"] == "recording_resumed")
    beside.close()
    kept = [rate for path in sorted((tmp_path / "out").iterdir()) for rate in read_mcap(path).rate_dps.tolist()]
    assert len(kept) + logged[-1]["unrecorded"] == 400


def tick_until(beside: ResilientRecorder, is_done: Callable[[], bool]) -> None:
    """The disk has a thread of its own."""
    until_s = time.monotonic() + PATIENCE_S
    while not is_done():
        assert time.monotonic() < until_s
        beside.tick(beside._failed_s)
        time.sleep(0.01)
