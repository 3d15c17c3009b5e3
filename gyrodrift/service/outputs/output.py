"""What every output is: a listener of corrected samples that may wait for its reader without keeping others waiting."""

from collections.abc import Mapping
from typing import Protocol

from gyrodrift.sample import Corrected
from gyrodrift.service.listener import Listener


class ReaderGoneError(Exception):
    """Nobody reads any more (the pipe is closed)."""


class Output(Listener[Corrected], Protocol):
    """Takes corrected samples and sends them on, as many as its reader takes now."""

    def wakes(self) -> Mapping[int, int]:
        """Descriptors that it waits for, with the events of `poll`; when one is ready, `take` is called."""
        ...
