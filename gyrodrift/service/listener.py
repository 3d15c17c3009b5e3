"""Receivers of samples as they arrive, before the filter and behind it."""

from collections.abc import Mapping
from typing import Any, Protocol, TypeVar

from gyrodrift.values.sample import Corrected, Sample

T = TypeVar("T")

NO_WAKES: Mapping[int, int] = {}
"""No descriptor to wait for."""


class ReaderGoneError(Exception):
    """The reader has closed the pipe or the terminal."""


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


class IdleListener:
    """Base of a listener that does not need all of them."""

    __slots__ = ()

    def take(self, samples: list[Any]) -> None:
        """Ignore samples."""

    def tick(self, now_s: float) -> None:
        """Do nothing."""

    def stats(self) -> dict[str, Any]:
        """No fields."""
        return {}

    def finish(self) -> None:
        """Do nothing: `close` does all."""

    def close(self) -> None:
        """Nothing is open."""


class JudgedListener:
    """Base of a listener of samples that gets readings that are no measurement without their rates."""

    __slots__ = ()


SampleListener = Listener[Sample]
"""A receiver of samples as measured: the pipeline, a recorder, a live line."""


class Sink(Listener[Corrected], Protocol):
    """Takes corrected samples and writes as many as the reader takes now; raises ReaderGoneError if it is closed."""

    @property
    def is_wanted(self) -> bool:
        """Whether the service must continue for this sink alone."""
        ...

    def wakes(self) -> Mapping[int, int]:
        """Descriptors to wait for, with the events of `poll`; when one is ready, `take` is called."""
        ...

    def finish(self) -> None:
        """Begin to end, without waiting; `close` waits."""
        ...
