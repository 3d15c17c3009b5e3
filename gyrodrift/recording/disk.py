"""A file with its own writer thread: a slow disk never delays the thread that reads the serial port."""

import os
import shutil
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from io import FileIO
from pathlib import Path
from queue import Empty, SimpleQueue

from gyrodrift.io.system import lock_file, sync_folder
from gyrodrift.values.errors import DataError

SYNC_S = 3.0
"""Longest time from one fsync to the next, s."""

LOOK_S = 0.5
"""Time between two checks of the file and of the free space, s."""

MOST_WAITING_BYTES = 64 << 20

HANGS_S = 5.0
"""At the end a disk that has written nothing for this long is not waited for, s."""

JOIN_S = 0.1
"""Time between two checks while waiting for the disk, s."""


class RecordingError(DataError):
    """The recording cannot go on; what was written stays."""


class ChangedFileError(RecordingError):
    """Another program removed, replaced or truncated the file; the disk works."""


class DiskFile:
    """A new file; bytes go to the system at once and are synced every few seconds.

    `mode` limits who may read it, besides the umask. `other_path` gives another free path if another program has just
    taken `path`. `left_bytes` is the free space for this user at the last check, None before the first check or if the
    folder is gone. Only the thread touches the disk, because a disk may hang.

    A file without a byte in it is removed again: a full disk would collect empty files.

    Raises
    ------
    RecordingError
        From `write`, `check` and `join`: the disk is full, gone or too slow, or another program has removed, replaced
        or changed the file.
    """

    def __init__(self, path: Path, other_path: Callable[[], Path], mode: int = 0o666) -> None:
        self.path = path
        self.is_there = False
        self.failure: RecordingError | None = None
        self.left_bytes: int | None = None
        self._other_path = other_path
        self._mode = mode | 0o600  # the user who records may repair it
        self._queue: SimpleQueue[bytes | None] = SimpleQueue()
        self._handed_over = self._written = 0
        self._looked_s = self._synced_s = time.monotonic()
        self._is_dirty = False
        self._thread = threading.Thread(target=self._run, name="disk", daemon=True)
        self._thread.start()

    @property
    def is_taking(self) -> bool:
        """Whether any byte is written."""
        return self._written > 0

    @property
    def waiting_bytes(self) -> int:
        """Bytes that are not written yet."""
        return self._handed_over - self._written

    def write(self, content: bytes) -> None:
        """Queue bytes for writing without waiting."""
        self.check()
        if self.waiting_bytes > MOST_WAITING_BYTES:
            raise RecordingError(f"{self.path}: recording stopped: the disk is too slow for this stream")
        self._handed_over += len(content)
        self._queue.put(content)

    def check(self) -> None:
        """Raise the failure of the thread, if it has failed."""
        if self.failure is not None:
            raise self.failure

    def finish(self) -> None:
        """Let the thread write, sync and close the file without waiting for it."""
        self._queue.put(None)

    @property
    def is_finished(self) -> bool:
        """Whether the thread has ended."""
        return not self._thread.is_alive()

    def join(self, patience_s: float | None = None) -> None:
        """Wait until everything is on the disk; give up after `patience_s` (HANGS_S) without a byte written."""
        patience_s = HANGS_S if patience_s is None else patience_s
        written, since_s = self._written, time.monotonic()
        while self._thread.is_alive() and time.monotonic() - since_s < patience_s:
            self._thread.join(JOIN_S)
            if self._written != written:
                written, since_s = self._written, time.monotonic()
        self.check()
        if self._thread.is_alive():
            raise RecordingError(f"{self.path}: the disk hangs: {self.waiting_bytes} bytes are not written")

    def _run(self) -> None:
        try:
            with self._opened() as self._file:
                sync_folder(self.path.parent)
                while self._take():
                    pass
        except OSError as error:
            outcome = f"; {self._written} bytes are written and stay readable" if self._written else ""
            outcome += f", {self.waiting_bytes} bytes are lost" if self._written and self.waiting_bytes else ""
            if not self._written and self.is_there:
                with suppress(OSError):
                    self.path.unlink()
            self.failure = RecordingError(f"{self.path}: recording stopped: {error.strerror}{outcome}")
        except RecordingError as error:
            self.failure = error

    def _opened(self) -> FileIO:
        self.path.parent.mkdir(parents=True, exist_ok=True)
        while True:
            try:
                file = FileIO(self.path, "xb+", opener=self._open)
            except FileExistsError:
                self.path = self._other_path()
                continue
            lock_file(file, wait=True)  # a search for interrupted files holds the lock for a moment
            self.left_bytes, self.is_there = disk_left_bytes(self.path.parent), True
            return file

    def _open(self, name: str, flags: int) -> int:
        """Open a new file with `mode`, less the umask, for appending.

        With appending, a file that another program truncates gets no hole that would hide the truncation.
        """
        return os.open(name, flags | os.O_APPEND, self._mode)

    def _take(self) -> bool:
        """Write the next piece if there is one; False after the last."""
        try:
            content = self._queue.get(timeout=LOOK_S)
        except Empty:
            content = b""
        if content:
            self._write(content)
        now_s = time.monotonic()
        if self._is_dirty and (content is None or now_s - self._synced_s >= SYNC_S):
            os.fsync(self._file.fileno())
            self._synced_s, self._is_dirty = now_s, False
        if now_s - self._looked_s >= LOOK_S:
            self.left_bytes, self._looked_s = disk_left_bytes(self.path.parent), now_s
        self._look()
        return content is not None

    def _write(self, content: bytes) -> None:
        rest = memoryview(content)
        while rest:
            count = self._file.write(rest) or 0
            self._written += count
            rest = rest[count:]
        self._is_dirty = True

    def _look(self) -> None:
        """Check that the file still has a name, and exactly the bytes that were written."""
        status = os.fstat(self._file.fileno())
        if status.st_nlink == 0:
            self._save_again()
        why = f"{self.path}: recording stopped: another program has"
        if status.st_size < self._written:
            lost = self._written - status.st_size
            raise ChangedFileError(f"{why} truncated it while it was being written: {lost} bytes are lost")
        if status.st_size > self._written:
            raise ChangedFileError(f"{why} written to it, too; gyrodrift info says which samples are whole")

    def _save_again(self) -> None:
        """Restore a file that was removed while open: its bytes can still be read."""
        before, why = self.path, f"{self.path}: recording stopped: the file was removed while it was being written"
        while not self._queue.empty():
            self._write(self._queue.get() or b"")
        try:
            try:
                self._put_back()
            except OSError:  # the folder disappeared meanwhile: removing a tree takes a moment
                self._put_back()
        except OSError as error:
            raise RecordingError(f"{why}, and could not be restored: {error.strerror}") from error
        size = os.fstat(self._file.fileno()).st_size
        if size < self._written:
            raise ChangedFileError(f"{why}; it was truncated before: {self._written - size} bytes are lost")
        where = "" if self.path == before else f" as {self.path}"
        raise ChangedFileError(f"{why}; it was restored{where} with everything that was recorded")

    def _put_back(self) -> None:
        self.path.parent.mkdir(parents=True, exist_ok=True)
        if os.path.lexists(self.path):  # another program has created a file with its name
            self.path = self._other_path()
        with open(self.path, "xb", opener=self._open) as copy:
            self._file.seek(0)
            shutil.copyfileobj(self._file, copy)
            copy.flush()
            os.fsync(copy.fileno())


def disk_left_bytes(folder: Path) -> int | None:
    """Free space for this user, bytes; None if the folder is gone."""
    try:
        return shutil.disk_usage(folder).free
    except OSError:
        return None
