"""A WebSocket server, on the package `websockets`: bounded backlogs, limits on clients, messages and handshakes.

It can answer plain HTTP requests on the same port, to serve a page.
"""

import asyncio
import socket
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from http import HTTPStatus
from typing import TYPE_CHECKING, Any, TypeVar

from gyrodrift.io.logger import FilteringBoundLogger
from gyrodrift.outputs.net.addresses import cannot_listen, shown, warn_of_others
from gyrodrift.outputs.net.limits import DEFAULT_LIMITS, Allowance, Backlog, Limits
from gyrodrift.outputs.net.lines import KERNEL_BYTES
from gyrodrift.outputs.net.servers import ClientServer, own_mistake

if TYPE_CHECKING:
    from websockets.asyncio.server import Server, ServerConnection
    from websockets.http11 import Request, Response

GOING_AWAY = 1001
POLICY_VIOLATION = 1008
INTERNAL_ERROR = 1011
"""Close codes of RFC 6455, section 7.4.1."""

END_S = 2.5
"""Time for all clients to close their connections at the end, s."""

MOST_URGENT = 256
"""Most waiting messages with priority."""

LONGEST_REASON = 120
"""Longest reason in bytes; a close frame allows 123."""


class WebSocketSession:
    """State of an output for one client; this one ignores messages, and tells the client nothing."""

    def message(self, content: str | bytes) -> None:
        """Take a message of the client. ValueError refuses it and closes the connection."""

    def dropped(self, messages: int) -> str | bytes:  # noqa: ARG002 - sessions of other protocols tell it
        """Message for a client that was too slow for some messages; empty for none."""
        return ""

    def closed(self) -> None:
        """End: the client has left."""


class WebSocketClient:
    """One connection after its handshake."""

    def __init__(self, connection: "ServerConnection", limits: Limits) -> None:
        self.connection = connection
        self.peer = shown(*connection.remote_address[:2])
        self.sent = 0
        self._backlog: Backlog[Any] = Backlog(limits.queue_bytes)
        self._urgent: deque[str | bytes] = deque()
        self._has_some = asyncio.Event()

    @property
    def dropped(self) -> int:
        """Messages dropped for this client, which was too slow."""
        return self._backlog.dropped

    def send(self, message: str | bytes) -> None:
        """Queue a message; text becomes a text frame, bytes a binary frame."""
        self._backlog.append(message)
        self._has_some.set()

    def send_first(self, message: str | bytes) -> bool:
        """Queue a message with priority; False if too many wait."""
        if len(self._urgent) >= MOST_URGENT:
            return False
        self._urgent.append(message)
        self._has_some.set()
        return True

    async def write(self, notice_of: Callable[[int], str | bytes]) -> None:
        """Send queued messages, for ever."""
        while True:
            await self._has_some.wait()
            while self._urgent or self._backlog:
                untold = self._backlog.tell()
                notice = notice_of(untold) if untold else ""
                if notice:
                    await self.connection.send(notice)
                message = self._urgent.popleft() if self._urgent else self._backlog.pop()[0]
                await self.connection.send(message)
                self.sent += 1
            self._has_some.clear()


S = TypeVar("S", bound=WebSocketSession)


class WebSocketServer(ClientServer[WebSocketClient, S]):
    """Listens on TCP; a client has its session after its handshake.

    Parameters
    ----------
    answer
        Called with each request before its handshake. A response is sent and the connection closed; None continues.
    options
        Options of `websockets.asyncio.server.serve`: subprotocols, origins.
    """

    def __init__(
        self,
        sessions: Callable[[WebSocketClient], S],
        log: FilteringBoundLogger,
        answer: "Callable[[ServerConnection, Request], Response | None] | None" = None,
        limits: Limits = DEFAULT_LIMITS,
        **options: Any,
    ) -> None:
        super().__init__(sessions, log, limits)
        self._answer = answer
        self._options = options
        self._server: Server | None = None
        self._connections: set[ServerConnection] = set()

    async def listen(self, host: str, port: int) -> str:
        """Listen on a port; returns the address as text.

        Raises
        ------
        OutputError
            If the port is not available, with the program that uses it.
        """
        from gyrodrift.outputs.net.websocket_connection import listen

        answer = self._checked_answer if self._answer is not None else None
        try:
            self._server = await listen(
                self.serve, self._connections, self.limits, host, port, process_request=answer, **self._options
            )
            for listening in self._server.sockets:
                listening.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, KERNEL_BYTES)
            await self._server.start_serving()  # only now: a canceled `listen` leaves a server that can be closed
        except OSError as error:
            raise cannot_listen(error, host, port) from error
        warn_of_others(self.log, host)
        return shown(host, next(iter(self._server.sockets)).getsockname()[1])

    async def serve(self, connection: "ServerConnection") -> None:
        """One client, from its handshake to its end."""
        client = WebSocketClient(connection, self.limits)
        try:
            session = self.open_session(client)
        except Exception as error:  # noqa: BLE001 - a bug of this program ends only this connection
            await self._refuse(client, INTERNAL_ERROR, own_mistake(error))
            return
        self.clients[client] = session
        writing = asyncio.create_task(client.write(session.dropped))
        try:
            await self._hear(connection, client, session)
        finally:
            writing.cancel()
            await asyncio.gather(writing, return_exceptions=True)
            self.forget(client)
            session.closed()

    async def close(self) -> None:
        """Stop listening and close the connections; a client that does not answer in END_S is cut off."""
        server, self._server = self._server, None
        if server is None:
            return
        await super().close()
        server.close(code=GOING_AWAY)
        for connection in self._connections - {client.connection for client in self.clients}:  # before their handshake
            connection.transport.abort()
        waiting = asyncio.create_task(server.wait_closed())
        await asyncio.wait([waiting], timeout=END_S)
        for connection in list(self._connections):
            connection.transport.abort()
        await waiting

    async def _hear(self, connection: "ServerConnection", client: WebSocketClient, session: WebSocketSession) -> None:
        from websockets.exceptions import ConnectionClosed

        allowance = Allowance(self.limits.messages_per_s)
        with suppress(ConnectionClosed):
            async for message in connection:
                if not allowance.take():
                    why = f"more than {self.limits.messages_per_s:g} messages a second"
                    await self._refuse(client, POLICY_VIOLATION, why)
                    return
                try:
                    session.message(message)
                except ValueError as error:
                    await self._refuse(client, POLICY_VIOLATION, str(error))
                    return
                except Exception as error:  # noqa: BLE001 - a bug of this program ends only this connection
                    await self._refuse(client, INTERNAL_ERROR, own_mistake(error))
                    return

    async def _refuse(self, client: WebSocketClient, code: int, why: str) -> None:
        """Log the reason and close a client; the reason may quote the client, so it is escaped."""
        self.refusals.happened(client=client.peer, reason=why)
        await client.connection.close(code, why.encode("ascii", "backslashreplace")[:LONGEST_REASON].decode())

    def _checked_answer(self, connection: "ServerConnection", request: "Request") -> "Response | None":
        """Answer of the output; an exception ends only this request."""
        assert self._answer is not None  # noqa: S101 - only called with it
        try:
            return self._answer(connection, request)
        except Exception as error:  # noqa: BLE001 - a bug of one output must not affect the others
            self.refusals.happened(client=shown(*connection.remote_address[:2]), reason=own_mistake(error))
            return connection.respond(HTTPStatus.BAD_REQUEST, "This request cannot be answered.\n")
