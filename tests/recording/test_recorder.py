"""A recorder in one process: its files, their names, and what it makes of a disk that fails."""

import json
import subprocess
import threading
import time
from collections.abc import Callable, Iterator
from datetime import datetime
from io import FileIO
from pathlib import Path

import numpy as np
import pytest
from disk_support import fill, small_disk
from mcap.reader import make_reader
from support import PATIENCE_S, speaking_on

from gyrodrift.link.link import Link
from gyrodrift.link.options import LinkOptions
from gyrodrift.recording import disk, recorder
from gyrodrift.recording.disk import DiskFile, RecordingError
from gyrodrift.recording.recorder import Recorder, RecordOptions, recording_path
from gyrodrift.session.mcap.raw import read_raw
from gyrodrift.session.mcap.read import read_mcap
from gyrodrift.values.sample import DeviceYaw, Inertial, Sample


@pytest.fixture
def link(tmp_path: Path) -> Iterator[Link]:
    with speaking_on(tmp_path / "gyro"):
        link = Link(LinkOptions(str(tmp_path / "gyro")), lambda *_news, **_fields: None)
        yield link
        link.close()


@pytest.fixture
def out(tmp_path: Path) -> Path:
    return tmp_path / "out"


def samples(first: int, count: int) -> list[Sample]:
    return [Sample(i, i / 100, 1.7e9 + i / 100, float(i)) for i in range(first, first + count)]


def missing_in(path: Path) -> list[int]:
    with path.open("rb") as file:
        messages = [message.data for _, _, message in make_reader(file).iter_messages(["/link"])]
    return [json.loads(text)["missing"] for text in messages]


def record_until_it_fails(recording: Recorder, count: int) -> None:
    """The disk has a thread of its own, which fails in its own time."""
    for first in range(0, count, 100):
        recording.take(samples(first, 100))
        recording.tick(0.0)
    file = recording._disk
    until(lambda: file is not None and file.is_finished)
    recording.tick(0.0)


def until(is_done: Callable[[], bool]) -> None:
    """Wait for the thread, for as long as a test has patience."""
    waiting = threading.Event()
    for _ in range(round(PATIENCE_S / 0.01)):
        if is_done():
            return
        waiting.wait(0.01)
    raise AssertionError("it never happened")


def test_a_name_that_another_recording_takes_first_costs_nothing(
    out: Path, link: Link, monkeypatch: pytest.MonkeyPatch
) -> None:
    result: list[Path] = []

    def raced(folder: Path, begun: datetime, device: str, profile: str, taken: set[Path]) -> Path:
        path = recording_path(folder, begun, device, profile, taken)
        if not result:
            out.mkdir(exist_ok=True)
            path.write_bytes(b"another's")
        result.append(path)
        return path

    monkeypatch.setattr(recorder, "recording_path", raced)
    recording = Recorder(RecordOptions(out), link)
    recording.take(samples(0, 10))
    recording.close()
    assert result[0].read_bytes() == b"another's"
    assert recording.paths == result[1:]
    assert len(read_mcap(result[1]).rate_dps) == 10


def test_a_failure_is_noticed_while_the_device_is_silent(
    out: Path, link: Link, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(disk, "LOOK_S", 0.01)
    recording = Recorder(RecordOptions(out), link)
    recording.take(samples(0, 10))
    recording.tick(0.0)
    assert recording._disk is not None
    file = recording._disk
    until(lambda: file._written == file._handed_over)
    recording.paths[0].unlink()
    until(lambda: file.is_finished)
    with pytest.raises(RecordingError, match="it was restored with everything that was recorded"):
        recording.tick(1.0)
    with pytest.raises(RecordingError):
        recording.close()
    assert len(read_mcap(recording.paths[0]).rate_dps) == 10


def test_closing_waits_for_every_file_whatever_became_of_the_others(
    out: Path, link: Link, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A file that failed does not keep the one after it from its end."""
    recording = Recorder(RecordOptions(out, rotate_bytes=1), link)
    joined: list[Path] = []

    def join(file: DiskFile, _patience_s: float | None) -> None:
        file._thread.join()
        joined.append(file.path)
        raise RecordingError(f"{file.path}: no")

    monkeypatch.setattr(recorder, "_is_over", lambda _disk: False)
    monkeypatch.setattr(DiskFile, "join", join)
    for first in (0, 10, 20):
        recording.take(samples(first, 10))
        recording.tick(0.0)
    with pytest.raises(RecordingError):
        recording.close()
    assert sorted(joined) == sorted(recording.paths)
    assert len(joined) == 3


def test_between_two_files_reads_and_events_wait_for_the_next(out: Path, link: Link) -> None:
    recording = Recorder(RecordOptions(out, rotate_bytes=1, keeps_raw=True), link)
    for first in range(0, 50, 10):
        recording.take_raw(b"before %d\n" % first, 1.7e9)
        recording.on_event("gap", {"missing": first})
        recording.take(samples(first, 10))
        recording.take_raw(b"behind %d\n" % first, 1.7e9)
        recording.tick(0.0)
    recording.close()
    assert len(recording.paths) == 5
    content = b"".join(read.content for path in recording.paths for read in read_raw(path))
    assert content == b"".join(b"before %d\nbehind %d\n" % (first, first) for first in range(0, 50, 10))
    assert [missing for path in recording.paths for missing in missing_in(path)] == [*range(0, 50, 10)]
    rates = [rate for path in recording.paths for rate in read_mcap(path).rate_dps.tolist()]
    assert rates == [float(i) for i in range(50)]


def test_a_disk_that_stays_full_is_not_littered(out: Path, link: Link) -> None:
    """A service tries again every few seconds, for days."""
    with small_disk(out, "64k"):
        filler = fill(out)
        for _ in range(3):
            recording = Recorder(RecordOptions(out), link)
            recording.take(samples(0, 10))
            with pytest.raises(RecordingError, match=r"No space left on device$"):
                recording.close()
        assert list(out.iterdir()) == [filler]


def test_what_a_disk_took_before_it_was_full_stays(out: Path, link: Link) -> None:
    with small_disk(out, "64k"):
        recording = Recorder(RecordOptions(out), link)
        with pytest.raises(RecordingError, match="No space left on device; 65536 bytes are written"):
            record_until_it_fails(recording, 3000)
        with pytest.raises(RecordingError):
            recording.close()
        (path,) = out.iterdir()
        rates = read_mcap(path).rate_dps.tolist()
        assert len(rates) > 700
        assert rates == [float(i) for i in range(len(rates))]


def test_a_folder_that_takes_no_files_is_told(out: Path, link: Link) -> None:
    recording = Recorder(RecordOptions(out), link)
    with small_disk(out, "64k"):
        subprocess.run(["mount", "-o", "remount,ro", out], check=True)
        with pytest.raises(RecordingError, match=r"recording stopped: Read-only file system$"):
            record_until_it_fails(recording, 1)
        recording.abandon()


def take_turns(recording: Recorder) -> None:
    """Many short files."""
    for first in range(10, 1000, 10):
        recording.take(samples(first, 10))
        recording.tick(0.0)


@pytest.mark.promise("Recovery")
def test_a_frozen_disk_holds_up_nobody_while_files_take_turns(
    out: Path, link: Link, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A disk that hangs delays no sample, even when a new file is due."""
    go_on = threading.Event()

    def frozen(path: Path, mode: str, opener: Callable[[str, int], int]) -> FileIO:
        go_on.wait(PATIENCE_S)
        return FileIO(path, mode, opener=opener)

    monkeypatch.setattr(disk, "FileIO", frozen)
    monkeypatch.setattr(disk, "HANGS_S", 0.01)
    monkeypatch.setattr(recorder, "MOST_WAITING_BYTES", 20_000)
    recording = Recorder(RecordOptions(out, rotate_bytes=1), link)
    recording.take(samples(0, 10))
    recording.tick(0.0)
    with pytest.raises(RecordingError, match="the disk is too slow for this stream"):
        take_turns(recording)
    assert not recording.is_over
    with pytest.raises(RecordingError, match=r"the disk hangs: \d{4,} bytes of \d+ files are not written"):
        recording.close()
    go_on.set()
    until(lambda: recording.is_over)
    rates = [rate for path in recording.paths for rate in read_mcap(path).rate_dps.tolist()]
    assert rates == [float(i) for i in range(len(rates))]
    assert len(rates) >= 20
    assert len(recording.paths) == len(set(recording.paths)) > 2


@pytest.mark.promise("Memory and the end")
def test_raw_bytes_that_nobody_understands_go_to_the_disk_whatever_the_calendar_says(
    out: Path, link: Link, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Raw bytes that cannot be decoded reach the disk within 2 s."""
    now = [100.0]
    recording = Recorder(RecordOptions(out, keeps_raw=True), link, lambda: now[0])
    monkeypatch.setattr(time, "time", lambda: 1.6e9)
    for _ in range(5):
        recording.take_raw(b"noise", 1.7e9)
        recording.tick(now[0])
        now[0] += 1.0
    recording.close()
    assert not recording._waiting
    assert b"".join(read.content for read in read_raw(recording.paths[0])) == 5 * b"noise"


def test_the_config_of_a_file_is_the_one_in_force(out: Path, link: Link) -> None:
    recording = Recorder(RecordOptions(out, rotate_bytes=1, about={"config": {"text": "old"}}), link)
    for number in range(4):
        recording.take(samples(10 * number, 10))
        if number == 1:
            recording.set_about({"config": {"text": "new"}}, 0o600)
        recording.tick(0.0)
    recording.close()
    assert [read_mcap(path).metadata["config"]["text"] for path in recording.paths] == ["old", "new", "new", "new"]


def test_what_happens_before_the_first_sample_is_kept_within_bounds(out: Path, link: Link) -> None:
    """The last of it, however long a device says nothing."""
    recording = Recorder(RecordOptions(out), link)
    for number in range(recorder.MOST_EVENTS + 500):
        recording.on_event("gap", {"missing": number})
    recording.take(samples(0, 1))
    recording.close()
    assert missing_in(recording.paths[0]) == [*range(500, recorder.MOST_EVENTS + 500)]


def test_axes_that_begin_later_begin_another_file(link: Link, out: Path) -> None:
    """A file without axes cannot hold them; a file with axes holds samples without them."""
    out.mkdir()
    recording = Recorder(RecordOptions(out), link)
    recording.take(samples(0, 3))
    axes = Inertial(1.0, 2.0, 3.0, 0.0, 0.0, 9.81)
    turning = [sample._replace(inertial=axes) for sample in samples(3, 3)]
    recording.take(turning)
    recording.take(samples(6, 1))
    recording.close()
    first, second = map(read_mcap, recording.paths)
    assert (len(first.rate_dps), len(second.rate_dps)) == (3, 4)
    assert first.gyro_dps is None
    assert second.gyro_dps is not None
    assert second.gyro_dps[:3].tolist() == [[1.0, 2.0, 3.0]] * 3
    assert second.metadata["recording"]["continues"] == recording.paths[0].name


def test_a_yaw_of_the_device_that_begins_later_begins_another_file(link: Link, out: Path) -> None:
    """Three axes of the file before stay; samples without a result are kept in it."""
    out.mkdir()
    recording = Recorder(RecordOptions(out), link)
    axes = Inertial(1.0, 2.0, 3.0, 0.0, 0.0, 9.81)
    recording.take([sample._replace(inertial=axes) for sample in samples(0, 3)])
    recording.take([sample._replace(device_yaw=DeviceYaw(5.0, 0.5, -0.25)) for sample in samples(3, 2)])
    recording.take(samples(5, 1))
    recording.close()
    first, second = map(read_mcap, recording.paths)
    assert first.device_yaw_deg is None
    assert second.filled("device_yaw_deg")[:2].tolist() == [5.0, 5.0]
    assert (len(first.rate_dps), len(second.rate_dps)) == (3, 3)
    assert np.isnan(second.filled("device_yaw_deg")[2])
