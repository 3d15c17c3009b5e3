"""What every sink is."""

from typing import Protocol

from gyrodrift.sample import Corrected


class ReaderGoneError(Exception):
    """Nobody reads any more (the pipe is closed)."""


class Sink(Protocol):
    """Takes every corrected sample; must never wait."""

    def on_sample(self, corrected: Corrected) -> None:
        """Take one sample."""
        ...

    def flush(self) -> None:
        """The samples that arrived together have all been handed over: send them on."""
        ...

    def close(self) -> None:
        """No more will come."""
        ...
