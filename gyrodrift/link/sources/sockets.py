"""Stream socket as a source: connect with a clear error, read without waiting, notice a peer that is gone."""

import errno
import socket
from contextlib import suppress

from gyrodrift.link.port import READ_BYTES, READS_PER_TURN, PortGoneError
from gyrodrift.link.sources.source import SourceAddress, SourcePort
from gyrodrift.values.errors import LinkError, PortMissingError

CONNECT_S = 5.0
"""Longest wait for a connection, s: the third SYN of Linux leaves after 3 s (RFC 6298, initial timeout 1 s)."""

KEEPALIVE = {"TCP_KEEPIDLE": 5, "TCP_KEEPINTVL": 2, "TCP_KEEPCNT": 3}
"""A peer that vanished is noticed after 5 s + 3 × 2 s of silence. Chosen; Linux would take two hours."""

ABSENT = frozenset({errno.ECONNREFUSED, errno.EHOSTUNREACH, errno.ENETUNREACH, errno.ENETDOWN, errno.EHOSTDOWN})
"""Errors of a host or server that may still come up."""


class SocketPort(SourcePort):
    """Connected stream socket."""

    def __init__(self, path: str, connection: socket.socket) -> None:
        connection.setblocking(False)
        super().__init__(path, connection.fileno())
        self._connection = connection

    def read(self) -> bytes:
        """Available bytes, up to a limit, without waiting."""
        content, _ = received(self._connection, self.path)
        return content

    def write(self, content: bytes) -> int:
        """Send without waiting; the next read reports a closed connection."""
        try:
            return self._connection.send(content)
        except OSError:
            return 0

    def close(self) -> None:
        """Close the connection."""
        with suppress(OSError):
            self._connection.close()


def received(
    connection: socket.socket, path: str, waits: tuple[type[OSError], ...] = (BlockingIOError,)
) -> tuple[bytes, bool]:
    """Available bytes, up to a limit, without waiting, and whether more may be there.

    Parameters
    ----------
    path
        Address for the error.
    waits
        Errors of a connection without bytes.

    Raises
    ------
    PortGoneError
        The connection is closed, and all its bytes have been read.
    """
    chunks: list[bytes] = []
    for _ in range(READS_PER_TURN):
        try:
            chunk = connection.recv(READ_BYTES)
        except waits:
            return b"".join(chunks), False
        except OSError as error:
            if chunks:
                break
            raise PortGoneError(path) from error
        if not chunk:
            if chunks:
                break
            raise PortGoneError(path)
        chunks.append(chunk)
    return b"".join(chunks), True


def connected(address: SourceAddress) -> socket.socket:
    """Connection to the `HOST:PORT` of an address.

    Raises
    ------
    UsageError
        The address has another form.
    LinkError
        There is no connection; the message says why.
    """
    host, port = address.host_port()
    try:
        connection = socket.create_connection((host, port), CONNECT_S)
    except (OSError, UnicodeError) as error:
        raise _explained(address.text, host, port, error) from error
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    for name, value in KEEPALIVE.items():
        if hasattr(socket, name):
            connection.setsockopt(socket.IPPROTO_TCP, getattr(socket, name), value)
    return connection


def _explained(text: str, host: str, port: int, error: Exception) -> LinkError:
    if isinstance(error, (socket.gaierror, UnicodeError)):
        return PortMissingError(f"{text}: the name {host!r} is not known; check its spelling and the network")
    if isinstance(error, TimeoutError):
        return PortMissingError(f"{text}: {host} does not answer within {CONNECT_S:g} s; is it in this network?")
    if isinstance(error, ConnectionRefusedError):
        return PortMissingError(
            f"{text}: nothing listens on port {port} of {host}; start the server, or check the port"
        )
    kind = PortMissingError if getattr(error, "errno", None) in ABSENT else LinkError
    return kind(f"{text}: no connection to {host}: {error}; check the network")
