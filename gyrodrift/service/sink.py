"""Receivers of corrected samples in the service: stdout, and the feed of the outputs."""

from collections.abc import Mapping
from typing import Protocol

from gyrodrift.service.listener import Listener
from gyrodrift.values.sample import Corrected


class ReaderGoneError(Exception):
    """The reader has closed the pipe or the terminal."""


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
