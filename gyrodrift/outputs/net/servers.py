"""Common part of servers and outputs: clients with sessions and counts, the log of refused clients, periodic calls."""

import asyncio
from collections.abc import Callable, Sequence
from typing import Any, Generic, Protocol, TypeVar

from gyrodrift.io.logger import FilteringBoundLogger
from gyrodrift.outputs.net.limits import DEFAULT_LIMITS, Limits
from gyrodrift.outputs.output import Output
from gyrodrift.outputs.status import ClientStatus

EVERY_S = 1.0
"""Interval of the log lines with a number of events, after the first event, s."""

S = TypeVar("S")

O = TypeVar("O")  # noqa: E741 - the options of an output


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


def own_mistake(error: Exception) -> str:
    """Message for a client that triggered a bug of this program."""
    return f"this is a bug of gyrodrift, please report it: {type(error).__name__}: {error}"[:200]


class Client(Protocol):
    """A connection: its address, and the messages sent and dropped."""

    peer: str
    sent: int

    @property
    def dropped(self) -> int:
        """Messages dropped for this client, which was too slow."""
        ...


C = TypeVar("C", bound=Client)


class ClientServer(Generic[C, S]):
    """Clients of a server and the counts of their messages.

    clients
        Session of each client.

    Parameters
    ----------
    sessions
        Gives the session of a new client.
    """

    def __init__(self, sessions: Callable[[C], S], log: FilteringBoundLogger, limits: Limits = DEFAULT_LIMITS) -> None:
        self.limits, self.log = limits, log
        self.refusals = BoundedEvent(log.warning, "client_closed", "clients_closed")
        self.clients: dict[C, S] = {}
        self.open_session = sessions
        self._gone_sent = self._gone_dropped = 0

    def statuses(self) -> list[ClientStatus]:
        """Status of each client."""
        return [ClientStatus(client.peer, client.sent, client.dropped) for client in self.clients]

    def counts(self) -> tuple[int, int]:
        """Messages sent and dropped, with those of former clients."""
        sent = self._gone_sent + sum(client.sent for client in self.clients)
        return sent, self._gone_dropped + sum(client.dropped for client in self.clients)

    def forget(self, client: C) -> None:
        """Remove a client, and keep its counts."""
        del self.clients[client]
        self._gone_sent += client.sent
        self._gone_dropped += client.dropped

    async def close(self) -> None:
        """Close the connections and stop listening."""
        self.refusals.close()


V = TypeVar("V", bound=ClientServer[Any, Any])


class ServerOutput(Output[O], Generic[O, V]):
    """An output with one server.

    server
        Set by the constructor.
    """

    server: V

    def clients(self) -> Sequence[ClientStatus]:
        """Connected clients."""
        return self.server.statuses()

    def counts(self) -> tuple[int, int]:
        """Messages to clients, sent and dropped."""
        return self.server.counts()

    async def close(self) -> None:
        """Close the connections."""
        await self.server.close()


class Periodic:
    """Calls a function at a fixed interval on the loop; late calls are skipped.

    An exception ends the calls; `close` raises it. With `waits` only calls after `wake` are made: without one the loop
    sleeps.
    """

    def __init__(self, every_s: float, call: Callable[[], object], *, waits: bool = False) -> None:
        self._every_s = every_s
        self._call = call
        self._waits = waits
        self._has_work = asyncio.Event()
        self._task = asyncio.get_running_loop().create_task(self._run())

    def wake(self) -> None:
        """Let the next call be made."""
        self._has_work.set()

    async def close(self) -> None:
        """End the calls."""
        self._task.cancel()
        await asyncio.wait([self._task])
        if not self._task.cancelled():
            self._task.result()

    async def _run(self) -> None:
        loop = asyncio.get_running_loop()
        due_s = loop.time()
        while True:
            if self._waits:
                await self._has_work.wait()
                self._has_work.clear()
            self._call()
            now_s = loop.time()
            due_s = max(due_s + self._every_s, now_s)
            await asyncio.sleep(due_s - now_s)
