"""Keeps the memory of the filter about a device across restarts: loaded before the first sample, then written."""

import threading
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from math import isfinite
from pathlib import Path
from typing import Any

from gyrodrift.filters.filter import FilterMemory
from gyrodrift.io.files import check_writable
from gyrodrift.io.logger import FilteringBoundLogger
from gyrodrift.service.listener import IdleListener
from gyrodrift.service.memory_file import MemoryDamagedError, MemoryFile, read_memory, set_aside, write_memory
from gyrodrift.service.pipeline import Pipeline
from gyrodrift.values.calibration import of_this_device
from gyrodrift.values.errors import UsageError
from gyrodrift.values.sample import Sample

SAVE_S = 60.0
"""Interval of writing, s; a kill loses at most this."""

HANGS_S = 5.0
"""Longest wait for a disk at the end, s. The file is written under another name first, so it is never partial."""


@dataclass(slots=True)
class MemoryKeeper(IdleListener):
    """A listener before filter and recording, so that both begin with the memory.

    state
        As in `ctl status`: `none` before the first sample, `new`, `used`, or `refused`.

    Raises
    ------
    UsageError
        From the constructor, if the file cannot be read or its folder cannot be written to.
    """

    path: Path
    pipeline: Pipeline
    log: FilteringBoundLogger
    now: Callable[[], float] = time.time
    state: str = "none"
    reason: str = ""
    device: str = ""
    _filter: str = ""
    _calibration: str = ""
    _file: MemoryFile | None = None
    _before: Any = None
    _saved_s: float = 0.0
    _begun_s: float = 0.0
    _writing: threading.Thread | None = None
    _failed: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        check_writable(self.path.resolve().parent)
        try:
            self._file = read_memory(self.path)
        except MemoryDamagedError as error:
            self._put_aside(str(error))

    def take(self, samples: list[Sample]) -> None:
        """Check the memory before the first sample, and hand it to the filter."""
        if samples and self.state == "none":
            self._begin(samples[0])

    def tick(self, now_s: float) -> None:
        """Write the memory periodically."""
        if self._writing is not None and not self._writing.is_alive():
            self._join()
        if now_s - self._saved_s >= SAVE_S:
            self._saved_s = now_s
            self._save()

    def close(self) -> None:
        """Write the memory a last time."""
        self._join()
        if self._writing is None:
            self._save()
            self._join()
        if self._writing is not None:
            self.log.error("memory_not_written", reason=f"{self.path}: the disk hangs")

    def status(self) -> dict[str, str]:
        """Fields for `ctl status`."""
        return {"file": str(self.path), "state": self.state, "reason": self.reason, "device": self.device}

    def _begin(self, first: Sample) -> None:
        link, kind = self.pipeline.link, self.pipeline.filter
        self.device = link.device.device_id or link.name
        self._begun_s, self._saved_s, self._filter = self.now(), time.monotonic(), kind.name
        self._calibration = self._calibrated()
        if kind.memory is None:
            self._refuse(f"the filter {kind.name} has no memory")
            return
        file, self.state = self._file, "new"
        if file is None:
            self.log.info("memory_new", file=str(self.path), device=self.device)
            return
        if file.device != self.device:
            self._refuse(f"it is for device {file.device}, and this is {self.device}; use one file per device")
        elif file.filter != kind.name:
            self._refuse(f"it is for the filter {file.filter}, and {kind.name} runs; use one file per filter")
        elif file.calibration != self._calibration:
            self._begin_new("the calibration has changed, and with it the bias")
        else:
            self._use(file, kind.memory, first)

    def _calibrated(self) -> str:
        """Date of the calibration at the start of this run; empty for none."""
        link = self.pipeline.link
        applied = of_this_device(self.pipeline.calibrating.given, link.device.device_id, link.name)
        return "" if applied is None else applied.date

    def _use(self, file: MemoryFile, memory: FilterMemory, first: Sample) -> None:
        age_s = file.age_s(self._begun_s)
        try:
            self._before = memory.read(file.knowledge)
        except ValueError as error:
            self._put_aside(" ".join(str(error).split()))
            return
        if self.pipeline.run.has_axes(first.inertial) and memory.axes(self._before) == 1:
            self._begin_new("it is of one axis, and the device sends three")
            return
        temp_c = first.temp_c if isfinite(first.temp_c) else None
        self.pipeline.begin_with(memory.begun(self.pipeline.params, self._before, age_s, temp_c))
        self.state = "used"
        self.log.info("memory_used", file=str(self.path), device=self.device, age_s=round(age_s, 1))

    def _begin_new(self, reason: str) -> None:
        """Begin without the file, which is replaced at the next sure rest."""
        self._file, self._before, self.reason = None, None, reason
        self.log.warning("memory_new", file=str(self.path), device=self.device, reason=reason)

    def _refuse(self, reason: str) -> None:
        self.state, self.reason = "refused", reason
        self.log.error("memory_refused", file=str(self.path), reason=reason, hint="nothing is written to it")

    def _put_aside(self, reason: str) -> None:
        aside = set_aside(self.path)
        self.reason = f"the old file was damaged and is now {aside}: {reason}"
        self.log.error("memory_damaged", file=str(self.path), reason=reason, set_aside=str(aside))

    def _save(self) -> None:
        """Write the memory in a thread: a slow disk must not delay the port."""
        kind, now_s = self.pipeline.filter, self.now()
        if self.state not in {"new", "used"} or kind.memory is None or self._writing is not None:
            return
        if kind.name != self._filter:  # a new config has changed the filter
            return
        learner = self.pipeline.run.learner
        if learner is None:
            self._refuse(f"the filter {kind.name} has no memory of three axes; --axes 1 keeps the bias about z")
            return
        knowledge = learner(self._before, 0.0 if self._file is None else self._file.age_s(now_s))
        if knowledge is None:
            return
        memory = MemoryFile(self.device, kind.name, now_s, asdict(knowledge), self._calibration)
        self._writing = threading.Thread(target=self._write, args=(memory,), name="memory", daemon=True)
        self._writing.start()

    def _write(self, memory: MemoryFile) -> None:
        try:
            write_memory(self.path, memory)
        except (UsageError, ValueError) as error:
            self._failed.append(str(error))

    def _join(self) -> None:
        if self._writing is not None:
            self._writing.join(HANGS_S)
            self._writing = self._writing if self._writing.is_alive() else None
        for reason in self._failed:
            self.log.error("memory_not_written", reason=reason)
        self._failed.clear()
