"""Clients that were turned away, in the log: the first at once, and how many more it were once a second."""

import asyncio
from collections.abc import Callable
from typing import Any

from gyrodrift.logger import FilteringBoundLogger

EVERY_S = 1.0


class BoundedEvent:
    """An event that others can cause: at most two lines a second, however often it happens.

    Parameters
    ----------
    write
        A method of a logger, which is its level.
    event, sum_event
        Name of the event, and of the line with the `count` of those that followed it.
    """

    def __init__(self, write: Callable[..., object], event: str, sum_event: str) -> None:
        self._write = write
        self._event, self._sum_event = event, sum_event
        self._untold = 0
        self._timer: asyncio.TimerHandle | None = None

    def happened(self, **fields: Any) -> None:
        """Log it now, or count it for the next sum."""
        if self._timer is None:
            self._write(self._event, **fields)
            self._timer = asyncio.get_running_loop().call_later(EVERY_S, self._sum_up)
        else:
            self._untold += 1

    def close(self) -> None:
        """Say what is left to be said."""
        if self._timer is not None:
            self._timer.cancel()
            self._sum_up()

    def _sum_up(self) -> None:
        self._timer = None
        if self._untold:
            self._write(self._sum_event, count=self._untold)
            self._untold = 0


class Refusals:
    """Of one server; a crowd fills no disk with log."""

    def __init__(self, log: FilteringBoundLogger) -> None:
        self._closed = BoundedEvent(log.warning, "client_closed", "clients_closed")

    def say(self, client: str, reason: str) -> None:
        """Log that a client was closed, now or in the next sum."""
        self._closed.happened(client=client, reason=reason)

    def close(self) -> None:
        """Say what is left to be said."""
        self._closed.close()


def own_mistake(error: Exception) -> str:
    """What to say where a client found a mistake of this program: its connection ends, no other."""
    return f"gyrodrift cannot take this, please report it: {type(error).__name__}: {error}"[:200]
