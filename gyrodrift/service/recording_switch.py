"""A recording beside the filter that a person can start and stop while the service runs."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from gyrodrift.values.errors import UsageError
from gyrodrift.values.sample import Sample

if TYPE_CHECKING:  # brings the writer of mcap, which a service that records nothing does without
    from gyrodrift.recording.resilient import ResilientRecorder


@dataclass(slots=True)
class RecordingSwitch:
    """Hands samples and events to a recorder while there is one.

    make
        Gives a new recorder. UsageError if its folder is not writable.
    recorder
        None while nothing is recorded.
    """

    make: "Callable[[], ResilientRecorder]"
    recorder: "ResilientRecorder | None" = None
    _unrecorded: int = 0
    _ending: "list[ResilientRecorder]" = field(default_factory=list)

    def start(self) -> None:
        """Begin a recording, unless there is one.

        Raises
        ------
        UsageError
            If the folder is not writable, or the disk still writes the last recording.
        """
        if self.recorder is not None:
            return
        if self._ending:  # its disk may hang, and the loop must not
            raise UsageError("the disk still writes the last recording; try again")
        self.recorder = self.make()

    def stop(self) -> "ResilientRecorder | None":
        """End the recording without waiting for the disk; the recording that ends, if there was one."""
        ended, self.recorder = self.recorder, None
        if ended is not None:
            ended.finish()
            self._ending.append(ended)
        return ended

    @property
    def file(self) -> str | None:
        """The file being written, or its folder before the first sample; None while nothing is recorded."""
        if self.recorder is None:
            return None
        paths = self.recorder.recorder.paths if self.recorder.recorder else []
        return str(paths[-1] if paths else self.recorder.options.folder)

    def on_event(self, event: str, fields: dict[str, Any]) -> None:
        """Record an event of link, filter or config."""
        if self.recorder is not None:
            self.recorder.on_event(event, fields)

    def set_about(self, about: Mapping[str, dict[str, str]], mode: int) -> None:
        """Record a new config in the metadata."""
        if self.recorder is not None:
            self.recorder.set_about(about, mode)

    def take(self, samples: list[Sample]) -> None:
        """Record samples."""
        if self.recorder is not None:
            self.recorder.take(samples)

    def tick(self, now_s: float) -> None:
        """Let the recorder write and retry, and let ended ones report a failure."""
        for ended in [recorder for recorder in self._ending if recorder.is_over]:
            self._close(ended)
            self._ending.remove(ended)
        if self.recorder is not None:
            self.recorder.tick(now_s)

    def stats(self) -> dict[str, Any]:
        """Counters of the recorder, and the samples that no recording has, for the log."""
        stats = {} if self.recorder is None else self.recorder.stats()
        unrecorded = self._unrecorded + sum(ended.unrecorded for ended in self._ending) + stats.get("unrecorded", 0)
        return stats | ({"unrecorded": unrecorded} if unrecorded else {})

    def close(self) -> None:
        """Finish the file, and wait for the disk."""
        self.stop()
        for ended in self._ending:
            self._close(ended)
        self._ending.clear()

    def _close(self, ended: "ResilientRecorder") -> None:
        ended.close()
        self._unrecorded += ended.unrecorded
