"""Recording beside the filter: a failure is logged, and recording begins again."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import structlog
from disk_support import wait_for_disks
from support import speaking_on

from gyrodrift.link.events import LinkEvents
from gyrodrift.link.link import Link, LinkOptions
from gyrodrift.recording import resilient as recording
from gyrodrift.recording.disk import RecordingError
from gyrodrift.recording.recorder import RecordOptions
from gyrodrift.recording.resilient import ResilientRecorder
from gyrodrift.sample import Sample
from gyrodrift.session.mcap.read import read_mcap


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
    assert beside.stats() == {"recorded": None}
    beside.tick(beside._failed_s + 0.9 * recording.RETRY_S)
    assert beside.recorder is None
    beside.tick(beside._failed_s + 2 * recording.RETRY_S)
    assert logged[-1]["event"] == "recording_resumed"
    beside.take(samples(200))
    beside.close()
    files = [read_mcap(path) for path in sorted((tmp_path / "out").glob("*.mcap")) if path.stat().st_size > 5000]
    assert files[-1].rate_dps.tolist() == [float(i) for i in range(200, 300)]


def test_where_it_still_fails_it_is_told_again(tmp_path: Path, link: Link, logged: list[Any]) -> None:
    """And tried again later."""
    out = tmp_path / "out"
    beside = ResilientRecorder(RecordOptions(out), link, structlog.get_logger())
    out.rmdir()
    out.touch()
    beside.take(samples(0))
    assert logged[-1]["event"] == "recording_failed"
    beside.tick(beside._failed_s + 2 * recording.RETRY_S)
    assert "cannot be written to: File exists" in logged[-1]["reason"]
    out.unlink()
    beside.tick(beside._failed_s + 2 * recording.RETRY_S)
    assert logged[-1]["event"] == "recording_resumed"
    beside.close()
