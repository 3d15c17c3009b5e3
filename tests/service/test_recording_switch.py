"""A recording that a person starts and stops while the service runs: the loop never waits for its disk."""

import os
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import structlog
from disk_support import wait_for_disks
from support import PATIENCE_S, Command, never, speaking_on

from firmware_sim.wire.csv import csv_line
from gyrodrift.link.events import LinkEvents
from gyrodrift.link.link import Link
from gyrodrift.link.options import LinkOptions
from gyrodrift.recording.disk import ChangedFileError, RecordingError
from gyrodrift.recording.recorder import Recorder, RecordOptions
from gyrodrift.recording.resilient import ResilientRecorder
from gyrodrift.service.recording_switch import RecordingSwitch
from gyrodrift.values.errors import UsageError
from gyrodrift.values.sample import Sample

SAMPLES = [Sample(i, i / 100, 1.7e9 + i / 100, i / 4.0) for i in range(100)]


@pytest.fixture
def link(port: Path) -> Iterator[Link]:
    with speaking_on(port):
        link = Link(LinkOptions(str(port)), LinkEvents(structlog.get_logger()))
        yield link
        link.close()
    wait_for_disks()


@pytest.fixture
def switch(link: Link, tmp_path: Path) -> RecordingSwitch:
    options = RecordOptions(tmp_path / "sessions", keeps_raw=True)
    return RecordingSwitch(lambda: ResilientRecorder(options, link, structlog.get_logger()))


@pytest.mark.promise("Clients of outputs")
def test_a_stop_does_not_wait_for_a_slow_disk(switch: RecordingSwitch, monkeypatch: pytest.MonkeyPatch) -> None:
    """`ctl record stop` does not wait for a slow disk; no sample waits."""
    go_on, sync = threading.Event(), os.fsync

    def slow(fd: int) -> None:
        go_on.wait(PATIENCE_S)
        sync(fd)

    monkeypatch.setattr(os, "fsync", slow)
    switch.start()
    switch.take(SAMPLES)
    ended = switch.stop()
    assert ended is not None
    assert not ended.is_over
    with pytest.raises(UsageError, match="the disk still writes the last recording"):
        switch.start()
    go_on.set()
    wait_for_disks()
    switch.tick(1.0)
    assert ended.is_over
    switch.start()
    switch.take(SAMPLES)
    switch.close()
    assert len(list(ended.paths[0].parent.glob("*.mcap"))) == 2


@pytest.mark.parametrize("failure", [RecordingError, ChangedFileError])
def test_a_stop_that_fails_leaves_nothing_that_hears_the_link(
    switch: RecordingSwitch, link: Link, failure: type[RecordingError], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Raw bytes that nobody writes would fill the memory."""

    def fail(*_: Any) -> None:
        raise failure("f: recording stopped")

    switch.start()
    switch.take(SAMPLES)
    monkeypatch.setattr(Recorder, "_join_all", fail)
    switch.stop()
    wait_for_disks()
    switch.tick(1.0)
    assert link.tap is None
    assert switch.file is None


def test_an_ended_recording_does_not_take_the_raw_bytes_of_the_next(switch: RecordingSwitch, link: Link) -> None:
    """The end of the first is seen after the second has begun."""
    switch.start()
    first = switch.recorder
    assert first is not None
    assert first.recorder is not None
    switch.take(SAMPLES)
    switch.stop()
    wait_for_disks()
    switch.tick(1.0)
    switch.start()
    first.recorder.abandon()
    assert switch.recorder is not None
    assert switch.recorder.recorder is not None
    assert link.tap == switch.recorder.recorder.take_raw
    switch.close()


def refusal_of_start(control: Path) -> str:
    """The refusal of a start, tried again for as long as the disk still writes the last recording."""
    until_s = time.monotonic() + PATIENCE_S
    while True:
        with Command("ctl", control, "record", "start") as ctl:
            assert ctl.end() == 2
        if "try again" not in ctl.log or time.monotonic() > until_s:
            return ctl.log


@pytest.mark.promise("Clients of outputs")
def test_a_recording_is_started_twice_and_stopped_twice(port: Path, tmp_path: Path) -> None:
    """`ctl record start` and `stop` twice give the same file, and none."""
    control, out = tmp_path / "control", tmp_path / "sessions"
    with speaking_on(port) as device, Command("serve", "--port", port, "--control", control, "--record", out) as serve:
        device.wait_for_reader(never)
        device.send_all(b"".join(csv_line(10_000 * i, i / 4.0, None, None) for i in range(100)), never)
        serve.take_lines(100)
        answers = []
        for word in ("start", "start", "stop", "stop"):
            with Command("ctl", control, "record", word) as ctl:
                assert ctl.end() == 0
            answers.append(ctl.out)
        assert answers[0] == answers[1]
        (path,) = out.glob("*.mcap")
        assert str(path) in answers[2]
        assert answers[3] == '{"ok": true, "files": []}\n'
        out.rename(tmp_path / "elsewhere")
        out.write_text("no folder")
        assert "cannot be written to" in refusal_of_start(control)
        assert serve.stop() == 0


def test_a_stop_after_a_failure_keeps_its_reason_and_its_count(
    switch: RecordingSwitch, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Samples that no recording has are counted up to the last line of the log."""

    def fail(*_: Any) -> None:
        raise RecordingError("f: recording stopped: No space left on device")

    switch.start()
    monkeypatch.setattr(Recorder, "take", fail)
    for _ in range(3):
        switch.take(SAMPLES)
    ended = switch.stop()
    assert ended is not None
    assert ended.failure == "f: recording stopped: No space left on device"
    assert switch.stats() == {"unrecorded": 200}
    switch.tick(1.0)
    switch.close()
    assert switch.stats() == {"unrecorded": 200}
