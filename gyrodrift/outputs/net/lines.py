"""A server of text lines, on TCP or on a unix socket.

Messages go to the kernel at once. While its buffer is full they wait in a bounded backlog. The oldest are dropped, and
the client gets their number. Input of clients is split into lines.
"""

import asyncio
import socket
from collections.abc import Callable
from pathlib import Path
from struct import calcsize, unpack
from typing import Any, TypeVar, cast

from gyrodrift.io.logger import FilteringBoundLogger
from gyrodrift.outputs.net.addresses import cannot_listen, shown, warn_of_others
from gyrodrift.outputs.net.limits import DEFAULT_LIMITS, Allowance, Backlog, Limits
from gyrodrift.outputs.net.servers import ClientServer, own_mistake
from gyrodrift.outputs.net.unix_socket import bind_unix, file_of, unlink_unix

KERNEL_BYTES = 64 << 10
"""Buffer of the kernel and of asyncio for a client. Messages there cannot be dropped any more, and are late."""


class LineSession:
    """State of an output for one client; this one ignores lines, and tells the client nothing."""

    def line(self, text: bytes) -> None:
        """Take a line that the client sent, without its end. ValueError refuses it and closes the connection."""

    def dropped(self, messages: int) -> bytes:  # noqa: ARG002 - sessions of other protocols tell it
        """Message for a client that was too slow for some messages; empty for none."""
        return b""

    def refused(self, why: str) -> bytes:  # noqa: ARG002 - likewise
        """Message for a client before its connection is closed; empty for none."""
        return b""

    def closed(self) -> None:
        """End: the client has left."""


class LineClient(asyncio.Protocol):
    """One connection."""

    def __init__(self, server: "LineServer[Any]") -> None:
        self.peer = ""
        self.sent = 0
        self.session: LineSession | None = None
        self._server = server
        self._backlog: Backlog[bytes] = Backlog(server.limits.queue_bytes)
        self._allowance = Allowance(server.limits.messages_per_s)
        self._transport: asyncio.Transport | None = None
        self._is_paused = False
        self._begun = bytearray()

    @property
    def dropped(self) -> int:
        """Messages dropped for this client, which was too slow."""
        return self._backlog.dropped

    def send(self, piece: bytes, messages: int = 1) -> None:
        """Send bytes of some messages, or queue them."""
        if self._transport is None or self._transport.is_closing():
            return
        if self._is_paused:
            self._backlog.append(piece, messages)
        else:
            self._transport.write(piece)
            self.sent += messages

    def close(self, why: str = "") -> None:
        """End the connection; the client gets the reason."""
        if self._transport is None:
            return
        if why:
            self._server.refusals.happened(client=self.peer, reason=why)
            if self.session is not None and not self._is_paused:
                self._transport.write(self.session.refused(why))
        if self._is_paused:
            self._transport.abort()
        else:
            self._transport.close()

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Accept the client, unless there are too many."""
        self._transport = cast("asyncio.Transport", transport)
        self._transport.set_write_buffer_limits(high=KERNEL_BYTES)
        self.peer = _peer_of(self._transport)
        try:
            self._take_in()
        except Exception as error:  # noqa: BLE001 - a bug of this program ends only this connection
            self.close(own_mistake(error))

    def data_received(self, data: bytes) -> None:
        """Split input into lines."""
        *lines, rest = data.split(b"\n")
        for line in lines:
            whole, self._begun = bytes(self._begun) + line, bytearray()
            if len(whole) > self._server.limits.message_bytes:
                break
            if not self._hear(whole.rstrip(b"\r")):
                return
        else:
            self._begun += rest
            if len(self._begun) <= self._server.limits.message_bytes:
                return
        self._begun.clear()
        self.close(f"a line is longer than {self._server.limits.message_bytes} bytes")

    def pause_writing(self) -> None:
        """Queue further messages."""
        self._is_paused = True

    def resume_writing(self) -> None:
        """Report dropped messages, and send the queue."""
        self._is_paused = False
        untold = self._backlog.tell()
        if untold and self.session is not None and self._transport is not None:
            self._transport.write(self.session.dropped(untold))
        while self._backlog and not self._is_paused:
            self.send(*self._backlog.pop())

    def connection_lost(self, _error: Exception | None) -> None:
        """Remove the client."""
        self._transport = None
        if self in self._server.clients:
            self._server.forget(self)
        if self.session is not None:
            self.session.closed()
            self.session = None

    def _take_in(self) -> None:
        self.session = self._server.open_session(self)
        if len(self._server.clients) >= self._server.limits.clients:
            self.close(f"there are {self._server.limits.clients} clients already")
            return
        self._server.clients[self] = self.session
        self._server.greet(self)

    def _hear(self, line: bytes) -> bool:
        """Handle a line; whether the connection stays open."""
        if self.session is None or self._transport is None or self._transport.is_closing():
            return False
        if not self._allowance.take():
            self.close(f"more than {self._server.limits.messages_per_s:g} lines a second")
            return False
        try:
            self.session.line(line)
        except ValueError as error:
            self.close(str(error))
            return False
        except Exception as error:  # noqa: BLE001 - a bug of this program ends only this connection
            self.close(own_mistake(error))
            return False
        return not self._transport.is_closing()


S = TypeVar("S", bound=LineSession)


class LineServer(ClientServer[LineClient, S]):
    """Listens on TCP or on a unix socket.

    Parameters
    ----------
    greet
        Called with an accepted client, to send the first message.
    """

    def __init__(
        self,
        sessions: Callable[[LineClient], S],
        log: FilteringBoundLogger,
        greet: Callable[[LineClient], None] = lambda _: None,
        limits: Limits = DEFAULT_LIMITS,
    ) -> None:
        super().__init__(sessions, log, limits)
        self.greet = greet
        self._server: asyncio.Server | None = None
        self._path: Path | None = None
        self._file = 0, 0

    async def listen_tcp(self, host: str, port: int) -> str:
        """Listen on a port; returns the address as text.

        Raises
        ------
        OutputError
            If the port is not available, with the program that uses it.
        """
        loop = asyncio.get_running_loop()
        try:
            self._server = await loop.create_server(lambda: LineClient(self), host, port, start_serving=False)
            for listening in self._server.sockets:
                listening.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, KERNEL_BYTES)  # the connections inherit it
            await self._server.start_serving()  # only now: a canceled `listen` leaves a server that can be closed
        except OSError as error:
            raise cannot_listen(error, host, port) from error
        warn_of_others(self.log, host)
        return shown(host, self._server.sockets[0].getsockname()[1])

    async def listen_unix(self, path: Path) -> str:
        """Listen on a unix socket for this user alone; returns its path.

        Raises
        ------
        OutputError
            If the socket cannot be made.
        """
        listening = bind_unix(path)
        self._path, self._file = path, file_of(path)
        loop = asyncio.get_running_loop()
        self._server = await loop.create_unix_server(lambda: LineClient(self), sock=listening)
        return str(path)

    async def close(self) -> None:
        """Close the connections and stop listening."""
        if self._server is None:
            return
        await super().close()
        self._server.close()
        for client in list(self.clients):
            client.close()
        if self._path is not None:
            unlink_unix(self._path, self._file)
        self._server = None
        await asyncio.sleep(0)


def _peer_of(transport: asyncio.Transport) -> str:
    """Address of a client, or its process on a unix socket."""
    name = transport.get_extra_info("peername")
    if isinstance(name, tuple):
        return shown(name[0], name[1])
    form = "3i"
    connection = transport.get_extra_info("socket")
    pid, _, _ = unpack(form, connection.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, calcsize(form)))
    return f"process {pid}"
