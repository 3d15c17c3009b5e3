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
    next_to = ResilientRecorder(RecordOptions(tmp_path / "out"), link, structlog.get_logger())
    next_to.take(samples(0))
    assert next_to.recorder is not None

    def fail(_now_s: float) -> None:
        raise RecordingError("the disk is on fire")

    monkeypatch.setattr(next_to.recorder, "tick", fail)
    next_to.tick(0.0)
    assert logged[-1] == {
        "event": "recording_failed",
        "log_level": "error",
        "reason": "the disk is on fire",
        "next_try_s": recording.RETRY_S,
    }
    next_to.take(samples(100))
    next_to.on_event("gap", {})
    assert next_to.stats() == {"recorded": None, "unrecorded": 200}
    next_to.tick(next_to._failed_s + 0.9 * recording.RETRY_S)
    assert next_to.recorder is None
    wait_for_disks()
    next_to.tick(next_to._failed_s + 2 * recording.RETRY_S)
    next_to.take(samples(200))
    tick_until(next_to, lambda: logged[-1]["event"] == "recording_resumed")
    assert logged[-1]["unrecorded"] == 200  # what the recorder had and no file, and what came meanwhile
    next_to.close()
    files = [read_mcap(path) for path in sorted((tmp_path / "out").glob("*.mcap")) if path.stat().st_size > 5000]
    assert files[-1].rate_dps.tolist() == [float(i) for i in range(200, 300)]


@pytest.mark.promise("Crashes")
def test_after_another_program_changed_the_file_a_new_one_begins_at_once(
    tmp_path: Path, link: Link, logged: list[Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """`serve` starts a new file at once if another program changes its file."""
    next_to = ResilientRecorder(RecordOptions(tmp_path / "out"), link, structlog.get_logger())

    def fail(_now_s: float) -> None:
        raise ChangedFileError("it was truncated")

    assert next_to.recorder is not None
    monkeypatch.setattr(next_to.recorder, "tick", fail)
    next_to.tick(0.0)
    assert logged[-1]["next_try_s"] == 0.0
    assert next_to.recorder is not None
    next_to.take(samples(0))
    monkeypatch.setattr(next_to.recorder, "tick", fail)
    next_to.tick(0.0)
    assert logged[-1]["next_try_s"] == recording.RETRY_S
    assert next_to.recorder is None
    next_to.close()


def test_where_it_still_fails_it_is_told_again(tmp_path: Path, link: Link, logged: list[Any]) -> None:
    out = tmp_path / "out"
    next_to = ResilientRecorder(RecordOptions(out), link, structlog.get_logger())
    out.rmdir()
    out.touch()
    next_to.take(samples(0))
    tick_until(next_to, lambda: "recording stopped: File exists" in logged[-1].get("reason", ""))
    next_to.tick(next_to._failed_s + 2 * recording.RETRY_S)
    next_to.take(samples(100))
    tick_until(next_to, lambda: [item["event"] for item in logged].count("recording_failed") == 2)
    out.unlink()
    next_to.tick(next_to._failed_s + 2 * recording.RETRY_S)
    next_to.take(samples(200))
    tick_until(next_to, lambda: logged[-1]["event"] == "recording_resumed")
    next_to.close()
    events = [item["event"] for item in logged if item["event"] in ("recording_failed", "recording_resumed")]
    assert events == ["recording_failed", "recording_failed", "recording_resumed"]


@pytest.mark.promise("Recovery")
def test_while_a_disk_hangs_nothing_more_is_begun_on_it(
    tmp_path: Path, link: Link, logged: list[Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """While a disk hangs, no further file is started on it; `unrecorded` counts the samples."""
    go_on = threading.Event()
    real = os.fsync
    monkeypatch.setattr(os, "fsync", lambda fd: go_on.wait(PATIENCE_S) and real(fd))
    monkeypatch.setattr(disk, "MOST_WAITING_BYTES", 15_000)
    next_to = ResilientRecorder(RecordOptions(tmp_path / "out"), link, structlog.get_logger())
    for first in range(0, 300, 100):
        next_to.take(samples(first))
        next_to.tick(0.0)
    assert "the disk is too slow" in logged[-1]["reason"]
    before = threading.active_count()
    for _ in range(3):
        next_to.tick(next_to._failed_s + 2 * recording.RETRY_S)
        assert logged[-1]["reason"].endswith("the disk hangs")
    assert threading.active_count() == before
    go_on.set()
    wait_for_disks()
    next_to.tick(next_to._failed_s + 2 * recording.RETRY_S)
    next_to.take(samples(300))
    tick_until(next_to, lambda: logged[-1]["event"] == "recording_resumed")
    next_to.close()
    kept = [rate for path in sorted((tmp_path / "out").iterdir()) for rate in read_mcap(path).rate_dps.tolist()]
    assert len(kept) + logged[-1]["unrecorded"] == 400


def tick_until(beside: ResilientRecorder, is_done: Callable[[], bool]) -> None:
    """The disk has a thread of its own."""
    until_s = time.monotonic() + PATIENCE_S
    while not is_done():
        assert time.monotonic() < until_s
        beside.tick(beside._failed_s)
        time.sleep(0.01)
