"""Log of closed clients: the first at once, then their number once a second."""

import asyncio
from collections.abc import Callable
from typing import Any

from gyrodrift.io.logger import FilteringBoundLogger

EVERY_S = 1.0


class BoundedEvent:
    """An event that clients can cause, with at most two log lines a second.

    Parameters
    ----------
    write
        Method of a logger; it sets the level.
    event, sum_event
        Name of the event, and of the line with the `count` of later events.
    """

    def __init__(self, write: Callable[..., object], event: str, sum_event: str) -> None:
        self._write = write
        self._event, self._sum_event = event, sum_event
        self._untold = 0
        self._timer: asyncio.TimerHandle | None = None

    def happened(self, **fields: Any) -> None:
        """Log the event, or count it for the next line."""
        if self._timer is None:
            self._write(self._event, **fields)
            self._timer = asyncio.get_running_loop().call_later(EVERY_S, self._sum_up)
        else:
            self._untold += 1

    def close(self) -> None:
        """Log the remaining count."""
        if self._timer is not None:
            self._timer.cancel()
            self._sum_up()

    def _sum_up(self) -> None:
        self._timer = None
        if self._untold:
            self._write(self._sum_event, count=self._untold)
            self._untold = 0


class Refusals:
    """Refused clients of one server, with a bounded log."""

    def __init__(self, log: FilteringBoundLogger) -> None:
        self._closed = BoundedEvent(log.warning, "client_closed", "clients_closed")

    def say(self, client: str, reason: str) -> None:
        """Log that a client was closed, or count it for the next line."""
        self._closed.happened(client=client, reason=reason)

    def close(self) -> None:
        """Log the remaining count."""
        self._closed.close()


def own_mistake(error: Exception) -> str:
    """Message for a client that triggered a bug of this program."""
    return f"this is a bug of gyrodrift, please report it: {type(error).__name__}: {error}"[:200]
