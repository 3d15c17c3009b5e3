"""The file that is written by a thread: whoever hands it bytes never waits, and learns what went wrong."""

import fcntl
import os
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from support import PATIENCE_S

from gyrodrift.recording import disk
from gyrodrift.recording.disk import ChangedFileError, DiskFile, RecordingError
from gyrodrift.session.mcap.ending import lock


def until(is_done: Callable[[], bool]) -> None:
    """Wait for the thread, for as long as a test has patience."""
    waiting = threading.Event()
    for _ in range(round(PATIENCE_S / 0.01)):
        if is_done():
            return
        waiting.wait(0.01)
    raise AssertionError("it never happened")


def never_asked() -> Path:
    raise AssertionError("nobody has taken the path")


def disk_file(path: Path) -> DiskFile:
    """One that is there and is to be named so."""
    file = DiskFile(path, never_asked)
    until(lambda: file.is_there)
    return file


def test_what_is_handed_over_is_in_the_file_before_it_is_closed(tmp_path: Path) -> None:
    file = disk_file(tmp_path / "f")
    file.write(b"abc")
    file.write(b"def")
    until(lambda: (tmp_path / "f").read_bytes() == b"abcdef")
    file.finish()
    file.join()
    assert file.is_finished


@pytest.mark.promise("Crashes")
def test_it_is_synced_every_few_seconds_and_at_the_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A power cut loses at most the last five seconds: files are synced every three."""
    assert disk.SYNC_S + disk.LOOK_S < 5.0
    synced: list[int] = []
    monkeypatch.setattr(os, "fsync", lambda fd: synced.append(os.fstat(fd).st_size))
    monkeypatch.setattr(disk, "SYNC_S", 0.02)
    monkeypatch.setattr(disk, "LOOK_S", 0.01)
    file = disk_file(tmp_path / "f")
    file.write(b"x" * 10)
    until(lambda: 10 in synced)
    before = len(synced)
    file.write(b"x" * 5)
    file.finish()
    file.join()
    assert synced[before:][-1] == 15


def test_a_file_that_is_there_is_never_written_over(tmp_path: Path) -> None:
    """Somebody's recording, which came between: another name is asked for."""
    (tmp_path / "f").write_bytes(b"precious")
    file = DiskFile(tmp_path / "f", lambda: tmp_path / "g")
    file.write(b"abc")
    file.finish()
    file.join()
    assert file.path == tmp_path / "g"
    assert [(tmp_path / name).read_bytes() for name in "fg"] == [b"precious", b"abc"]


@pytest.mark.promise("Memory and the end")
def test_who_makes_a_file_does_not_wait_for_the_disk_to_make_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The end waits at most 5 s for a disk, and reports the unwritten bytes."""
    monkeypatch.setattr(disk, "HANGS_S", 0.05)
    go_on = threading.Event()

    def other_path() -> Path:
        go_on.wait(PATIENCE_S)
        return tmp_path / "g"

    (tmp_path / "f").touch()
    file = DiskFile(tmp_path / "f", other_path)
    file.write(b"abc")
    file.check()
    file.finish()
    with pytest.raises(RecordingError, match="the disk hangs: 3 bytes are not written"):
        file.join()
    go_on.set()
    until(lambda: file.is_finished)
    assert (tmp_path / "g").read_bytes() == b"abc"


def test_nobody_else_takes_it_for_an_interrupted_one(tmp_path: Path) -> None:
    file = disk_file(tmp_path / "f")
    with (tmp_path / "f").open("rb") as second, pytest.raises(Exception, match="is being written"):
        lock(tmp_path / "f", second)
    file.finish()
    file.join()


class SlowFile:
    """A file whose disk hangs until it is let go."""

    def __init__(self, file: Any, go_on: threading.Event) -> None:
        self._file, self._go_on = file, go_on

    def write(self, content: bytes) -> int:
        self._go_on.wait(PATIENCE_S)
        return int(self._file.write(content[:3]))

    def __getattr__(self, name: str) -> Any:
        return getattr(self._file, name)


def test_a_disk_that_hangs_keeps_nobody_waiting_up_to_a_bound(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(disk, "MOST_WAITING_BYTES", 100)
    go_on = threading.Event()
    file = disk_file(tmp_path / "f")
    file._file = SlowFile(file._file, go_on)  # type: ignore[assignment]  # as far as it is used
    for _ in range(6):
        file.write(b"0123456789" * 2)
    with pytest.raises(RecordingError, match="the disk is too slow"):
        file.write(b"x")
    go_on.set()
    file.finish()
    file.join()
    assert (tmp_path / "f").read_bytes() == b"0123456789" * 12


def test_who_asks_what_a_disk_has_left_does_not_wait_for_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The thread looks, and what it saw last is told."""
    go_on, request = threading.Event(), []

    def hang(folder: Path) -> int | None:
        request.append(threading.current_thread().name)
        assert len(request) == 1 or go_on.wait(PATIENCE_S)
        return 1000 * len(request)

    monkeypatch.setattr(disk, "disk_left_bytes", hang)
    monkeypatch.setattr(disk, "LOOK_S", 0.01)
    file = disk_file(tmp_path / "f")
    until(lambda: len(request) == 2)
    assert file.left_bytes == 1000
    go_on.set()
    file.finish()
    file.join()
    assert set(request[1:]) == {"disk"}


def test_what_the_disk_refuses_is_told_to_the_next_who_writes(tmp_path: Path) -> None:
    file = disk_file(tmp_path / "f")
    file.write(b"good")
    until(lambda: (tmp_path / "f").stat().st_size == 4)
    with Path("/dev/full").open("wb", buffering=0) as full:
        file._file = full
        file.write(b"bad")
        until(lambda: file.is_finished)
    with pytest.raises(RecordingError, match="No space left on device; 4 bytes are written"):
        file.write(b"more")
    with pytest.raises(RecordingError, match="No space left"):
        file.join()
    assert (tmp_path / "f").read_bytes() == b"good"


@pytest.mark.parametrize("is_folder_gone", [False, True])
def test_a_removed_file_is_put_back(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, *, is_folder_gone: bool) -> None:
    monkeypatch.setattr(disk, "LOOK_S", 0.01)
    path = tmp_path / "out" / "f"
    path.parent.mkdir()
    file = disk_file(path)
    file.write(b"all of it")
    until(lambda: path.stat().st_size == 9)
    if is_folder_gone:
        path.parent.rename(tmp_path / "gone")  # first, since the file would be back in a folder that is still there
        (tmp_path / "gone" / "f").unlink()
    else:
        path.unlink()
    until(lambda: file.is_finished)
    with pytest.raises(RecordingError, match="it was restored with everything that was recorded"):
        file.join()
    assert path.read_bytes() == b"all of it"


def test_who_makes_a_file_does_not_wait_for_the_folder_to_be_synced(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    go_on, synced = threading.Event(), threading.Event()

    def slow(fd: int) -> None:
        go_on.wait(PATIENCE_S)
        synced.set()

    monkeypatch.setattr(os, "fsync", slow)
    file = disk_file(tmp_path / "f")
    file.write(b"abc")
    assert not synced.is_set()
    go_on.set()
    file.finish()
    file.join()
    assert (tmp_path / "f").read_bytes() == b"abc"


def test_the_name_of_a_new_file_is_synced_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A file without a name is lost in a power cut, however well its bytes were synced."""
    synced: list[str] = []
    monkeypatch.setattr(os, "fsync", lambda fd: synced.append(str(Path(f"/proc/self/fd/{fd}").readlink())))
    file = disk_file(tmp_path / "f")
    file.write(b"abc")
    file.finish()
    file.join()
    assert synced == [str(tmp_path), str(tmp_path / "f")]


def test_who_looks_at_a_new_file_does_not_spoil_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Looking for interrupted files locks each for a moment, also one that is just being made."""
    real, looks = fcntl.flock, []

    def looked_at(file: Any, how: int) -> None:
        second = (tmp_path / "f").open("rb")
        real(second, fcntl.LOCK_EX)
        looks.append(threading.Timer(0.05, second.close))
        looks[0].start()
        real(file, how)

    monkeypatch.setattr(fcntl, "flock", looked_at)
    file = disk_file(tmp_path / "f")
    file.write(b"abc")
    file.finish()
    file.join()
    looks[0].join()
    assert (tmp_path / "f").read_bytes() == b"abc"


def test_a_failure_is_told_to_who_asks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(disk, "LOOK_S", 0.01)
    file = disk_file(tmp_path / "f")
    file.check()
    (tmp_path / "f").unlink()
    until(lambda: file.is_finished)
    with pytest.raises(RecordingError, match="was removed"):
        file.check()


def test_a_removed_file_is_put_back_with_what_was_still_waiting(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(disk, "LOOK_S", 0.01)
    go_on = threading.Event()
    file = disk_file(tmp_path / "f")
    file._file = SlowFile(file._file, go_on)  # type: ignore[assignment]  # as far as it is used
    for _ in range(5):
        file.write(b"0123456789")
    (tmp_path / "f").unlink()
    go_on.set()
    until(lambda: file.is_finished)
    with pytest.raises(RecordingError, match="it was restored"):
        file.join()
    assert (tmp_path / "f").read_bytes() == b"0123456789" * 5


@pytest.mark.promise("Crashes")
@pytest.mark.parametrize(
    ("size", "statement"), [(4, "has truncated it .* 6 bytes are lost"), (99, "has written to it")]
)
def test_a_file_that_another_program_changes_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, size: int, statement: str
) -> None:
    """A change of the file by another program is detected."""
    monkeypatch.setattr(disk, "LOOK_S", 0.01)
    file = disk_file(tmp_path / "f")
    file.write(b"0123456789")
    until(lambda: (tmp_path / "f").stat().st_size == 10)
    os.truncate(tmp_path / "f", size)
    until(lambda: file.is_finished)
    with pytest.raises(ChangedFileError, match=statement):
        file.join()
    assert (tmp_path / "f").read_bytes() == b"0123456789".ljust(size, b"\0")[:size]


def test_a_truncated_file_is_told_also_where_it_is_written_to_at_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(disk, "LOOK_S", PATIENCE_S)
    file = disk_file(tmp_path / "f")
    file.write(b"0123456789")
    until(lambda: (tmp_path / "f").stat().st_size == 10)
    os.truncate(tmp_path / "f", 0)
    file.write(b"abc")
    until(lambda: file.is_finished)
    with pytest.raises(ChangedFileError, match="10 bytes are lost"):
        file.join()
    assert (tmp_path / "f").read_bytes() == b"abc"


def test_a_file_whose_name_was_taken_meanwhile_is_put_back_under_another(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(disk, "LOOK_S", 0.01)
    file = DiskFile(tmp_path / "f", lambda: tmp_path / "f_2")
    file.write(b"ours")
    until(lambda: (tmp_path / "f").exists() and (tmp_path / "f").stat().st_size == 4)
    (tmp_path / "g").write_bytes(b"another's")
    (tmp_path / "g").replace(tmp_path / "f")
    until(lambda: file.is_finished)
    with pytest.raises(ChangedFileError, match="it was restored as"):
        file.join()
    assert (tmp_path / "f").read_bytes() == b"another's"
    assert (tmp_path / "f_2").read_bytes() == b"ours"
