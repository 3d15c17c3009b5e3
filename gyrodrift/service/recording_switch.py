"""A recording beside the filter that a person can start and stop while the service runs."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gyrodrift.sample import Sample

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

    def start(self) -> None:
        """Begin a recording, unless there is one.

        Raises
        ------
        UsageError
            If the folder is not writable.
        """
        if self.recorder is None:
            self.recorder = self.make()

    def stop(self) -> list[Path]:
        """End the recording; its files."""
        recorder, self.recorder = self.recorder, None
        if recorder is None:
            return []
        recorder.close()
        return recorder.recorder.paths if recorder.recorder else []

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
        """Let the recorder write and retry."""
        if self.recorder is not None:
            self.recorder.tick(now_s)

    def stats(self) -> dict[str, Any]:
        """Counters of the recorder, for the log."""
        return {} if self.recorder is None else self.recorder.stats()

    def close(self) -> None:
        """Finish the file."""
        self.stop()
