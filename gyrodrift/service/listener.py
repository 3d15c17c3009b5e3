"""What samples are handed to as they come: one shape, before the filter and behind it."""

from typing import Any, Protocol, TypeVar

from gyrodrift.sample import Sample

T = TypeVar("T")


class Listener(Protocol[T]):
    """Something that samples are handed to, in the thread that reads the port; it must never wait."""

    def take(self, samples: list[T]) -> None:
        """Take the samples that arrived together; none where something waits to be written."""
        ...

    def tick(self, now_s: float) -> None:
        """Do what is due a few times a second; `now_s` is on the monotonic clock."""
        ...

    def stats(self) -> dict[str, Any]:
        """Fields for the log."""
        ...

    def close(self) -> None:
        """No more will come."""
        ...


SampleListener = Listener[Sample]
"""What hears the samples as they were measured: the filter with its outputs, a recorder, a live line."""
