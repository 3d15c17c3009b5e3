"""What corrected samples are handed to in the service itself: stdout, and the way to the outputs' process."""

from collections.abc import Mapping
from typing import Protocol

from gyrodrift.sample import Corrected
from gyrodrift.service.listener import Listener


class ReaderGoneError(Exception):
    """Nobody reads any more (the pipe is closed)."""


class Sink(Listener[Corrected], Protocol):
    """Takes corrected samples and hands them on, as many as are taken now; ReaderGoneError where that is over."""

    @property
    def is_wanted(self) -> bool:
        """Whether the service has to go on for this one alone."""
        ...

    def wakes(self) -> Mapping[int, int]:
        """Descriptors that it waits for, with the events of `poll`; when one is ready, `take` is called."""
        ...

    def finish(self) -> None:
        """No more will come: begin to end, without waiting; `close` waits for it."""
        ...
