"""Recording in the service: a failure does not stop the filter, and recording is tried again later."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from math import inf
from pathlib import Path
from typing import Any

from gyrodrift.io.files import check_writable
from gyrodrift.io.logger import FilteringBoundLogger
from gyrodrift.link.link import Link
from gyrodrift.recording.disk import ChangedFileError, RecordingError
from gyrodrift.recording.recorder import Recorder, RecordOptions
from gyrodrift.session.mcap.ending import interrupted
from gyrodrift.values.errors import DataError
from gyrodrift.values.sample import Sample

RETRY_S = 10.0


@dataclass(slots=True)
class ResilientRecorder:
    """A `Recorder` whose failures go to the log instead of the caller.

    `unrecorded` counts the samples that could not be recorded.

    Raises
    ------
    UsageError
        From the constructor: the folder cannot be written to.
    """

    options: RecordOptions
    link: Link
    log: FilteringBoundLogger
    recorder: Recorder | None = field(init=False)
    unrecorded: int = 0
    _failed_s: float = -inf
    failure: str = ""
    _failed_paths: list[Path] = field(default_factory=list)
    _abandoned: Recorder | None = None
    _is_tried: bool = False

    def __post_init__(self) -> None:
        check_writable(self.options.folder)
        self.recorder = Recorder(self.options, self.link)

    def take(self, samples: list[Sample]) -> None:
        """Record samples."""
        if self.recorder is None:
            self.unrecorded += len(samples)
            return
        try:
            self.recorder.take(samples)
        except RecordingError as error:
            self._fail(self.recorder, error)

    def on_event(self, event: str, fields: dict[str, Any]) -> None:
        """Record a link event."""
        if self.recorder is not None:
            try:
                self.recorder.on_event(event, fields)
            except RecordingError as error:
                self._fail(self.recorder, error)

    def set_about(self, about: Mapping[str, dict[str, str]], mode: int) -> None:
        """Change the metadata tables and the permissions, after a new config."""
        self.options = replace(self.options, about=about, mode=mode)
        if self.recorder is not None:
            try:
                self.recorder.set_about(about, mode)
            except RecordingError as error:
                self._fail(self.recorder, error)

    def tick(self, now_s: float) -> None:
        """Flush the recording; after a failure, try again when `RETRY_S` has passed."""
        if self.recorder is None:
            if now_s - self._failed_s >= RETRY_S:
                self._retry(now_s)
            return
        try:
            self.recorder.tick(now_s)
        except RecordingError as error:
            self._fail(self.recorder, error)
            return
        if self._is_tried and self.recorder.is_writing:
            self._is_tried, self.failure = False, ""
            self.log.info("recording_resumed", folder=str(self.options.folder), unrecorded=self.unrecorded)

    def stats(self) -> dict[str, Any]:
        """Fields for the log."""
        stats = self.recorder.stats() if self.recorder else {"recorded": None}
        return stats | ({"unrecorded": self.unrecorded} if self.unrecorded else {})

    @property
    def is_over(self) -> bool:
        """Whether all files are on the disk, or the recording has failed."""
        return self.recorder is None or self.recorder.is_over

    @property
    def paths(self) -> list[Path]:
        """Files so far, in order of time."""
        return [*self._failed_paths, *([] if self.recorder is None else self.recorder.paths)]

    def finish(self) -> None:
        """Finish the file without waiting for the disk; `close` follows when `is_over`."""
        if self.recorder is not None:
            self._end(self.recorder.finish)

    def close(self) -> None:
        """Finish the file and wait for the disk."""
        if self.recorder is not None:
            self._end(self.recorder.close)

    def _end(self, end: Callable[[], None]) -> None:
        recorder = self.recorder
        assert recorder is not None  # noqa: S101 - checked by the callers
        try:
            end()
        except RecordingError as error:
            self._fail(recorder, error)
            if self.recorder is not None:  # the disk works, but no other recording begins
                self.recorder.abandon()
                self.recorder = None

    def _fail(self, recorder: Recorder, error: RecordingError) -> None:
        now_s = time.monotonic()
        is_disk_working = isinstance(error, ChangedFileError) and now_s - self._failed_s >= RETRY_S
        self.log.error("recording_failed", reason=str(error), next_try_s=0.0 if is_disk_working else RETRY_S)
        self._failed_s = now_s
        self.unrecorded += recorder.unflushed
        self.failure = str(error)
        self._failed_paths += filter(Path.exists, recorder.paths)
        recorder.abandon()
        self._abandoned, self.recorder = recorder, None
        if is_disk_working:
            self.recorder, self._abandoned, self._is_tried = Recorder(self.options, self.link), None, True

    def _retry(self, now_s: float) -> None:
        """Start another recorder; wait while a disk still hangs."""
        self._failed_s = now_s
        if self._abandoned is not None and not self._abandoned.is_over:
            self.log.error("recording_failed", reason=f"{self.options.folder}: the disk hangs", next_try_s=RETRY_S)
            return
        self.recorder, self._abandoned, self._is_tried = Recorder(self.options, self.link), None, True


def repair_interrupted(folder: Path, log: FilteringBoundLogger) -> None:
    """Close the files that an interrupted recording left open; a file that cannot be repaired is only logged."""
    for path in interrupted(folder):
        from gyrodrift.session.mcap.repair import repair  # noqa: PLC0415 - imports numpy

        try:
            repaired = repair(path, rebuilds=False)
        except DataError as error:
            log.warning("not_repaired", reason=str(error))
        else:
            if repaired is not None:
                tail = str(repaired.tail) if repaired.tail else None
                log.info("repaired", file=str(path), samples=repaired.samples, cut=repaired.cut_bytes, tail=tail)
