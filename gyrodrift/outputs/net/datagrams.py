"""Datagrams to one address, sent without waiting; datagrams that the kernel does not take are dropped and counted."""

import asyncio
import socket

from gyrodrift.outputs.net.addresses import shown
from gyrodrift.outputs.output import OutputError


class DatagramSender:
    """A UDP socket for one address; `sent` and `dropped` count datagrams."""

    def __init__(self) -> None:
        self.sent = 0
        self.dropped = 0
        self._socket: socket.socket | None = None
        self._to: tuple[object, ...] = ()

    async def open(self, host: str, port: int) -> str:
        """Resolve the address; returns it as text. Broadcast addresses are allowed.

        Raises
        ------
        OutputError
            If there is no such host.
        """
        loop = asyncio.get_running_loop()
        try:
            addresses = await loop.getaddrinfo(host, port, type=socket.SOCK_DGRAM)
        except OSError as error:
            raise OutputError(f"{host}: {error.strerror or error}") from error
        family, kind, protocol, _, self._to = addresses[0]
        self._socket = socket.socket(family, kind, protocol)
        self._socket.setblocking(False)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)
        return shown(host, port)

    def send(self, content: bytes) -> None:
        """Send a datagram; a missing network or a full buffer drops it."""
        if self._socket is None:
            return
        try:
            self._socket.sendto(content, self._to)
        except OSError:
            self.dropped += 1
        else:
            self.sent += 1

    def close(self) -> None:
        """Close the socket."""
        if self._socket is not None:
            self._socket.close()
            self._socket = None
