"""Receivers of samples as they arrive, before the filter and behind it."""

from typing import Any, Protocol, TypeVar

from gyrodrift.values.sample import Sample

T = TypeVar("T")


class Listener(Protocol[T]):
    """A receiver of samples. It runs in the thread that reads the port and must never wait."""

    def take(self, samples: list[T]) -> None:
        """Take the samples that arrived together; an empty list lets it continue a pending write."""
        ...

    def tick(self, now_s: float) -> None:
        """Do periodic work, a few times a second; `now_s` is on the monotonic clock."""
        ...

    def stats(self) -> dict[str, Any]:
        """Fields for the log."""
        ...

    def close(self) -> None:
        """End; no more samples come."""
        ...


SampleListener = Listener[Sample]
"""A receiver of samples as measured: the filter, a recorder, a live line."""
