"""Clients that were turned away, in the log: the first at once, and how many more it were once a second."""

import asyncio

from gyrodrift.logger import FilteringBoundLogger

EVERY_S = 1.0


class Refusals:
    """Of one server; a crowd fills no disk with log."""

    def __init__(self, log: FilteringBoundLogger) -> None:
        self._log = log
        self._untold = 0
        self._timer: asyncio.TimerHandle | None = None

    def say(self, client: str, reason: str) -> None:
        """Log that a client was closed, now or in the next sum."""
        if self._timer is None:
            self._log.warning("client_closed", client=client, reason=reason)
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
            self._log.warning("clients_closed", count=self._untold)
            self._untold = 0
