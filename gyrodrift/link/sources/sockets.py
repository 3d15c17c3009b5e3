"""Stream sockets: connect with a clear error, read without waiting, notice a peer that is gone.

Sources `tcp://HOST:PORT`, the bytes of a TCP server, and `unix:PATH`, those of a server on this machine.
"""

import errno
import socket
from contextlib import suppress
from dataclasses import replace
from math import inf
from typing import ClassVar

from gyrodrift.link.port import READ_BYTES, READS_PER_TURN, PortGoneError
from gyrodrift.link.sources.source import ByteSource, SourceAddress, SourcePort
from gyrodrift.values.errors import LinkError, PortDeniedError, PortMissingError, UsageError

CONNECT_S = 5.0
"""Longest wait for a connection, s: the third SYN of Linux leaves after 3 s (RFC 6298, initial timeout 1 s)."""

KEEPALIVE = {"TCP_KEEPIDLE": 5, "TCP_KEEPINTVL": 2, "TCP_KEEPCNT": 3}
"""A peer that vanished is noticed after 5 s + 3 × 2 s of silence. Chosen; Linux would take two hours."""

ABSENT = frozenset({errno.ECONNREFUSED, errno.EHOSTUNREACH, errno.ENETUNREACH, errno.ENETDOWN, errno.EHOSTDOWN})
"""Errors of a host or server that may still come up."""

NO_SERVER = {
    errno.ENOENT: "there is no such socket; start the server first",
    errno.ECONNREFUSED: "nothing listens on this socket; start the server first",
}


class SocketPort(SourcePort):
    """Connected stream socket.

    waits
        Errors of a connection without bytes.
    """

    waits: ClassVar[tuple[type[OSError], ...]] = (BlockingIOError,)

    def __init__(self, path: str, connection: socket.socket) -> None:
        connection.setblocking(False)
        super().__init__(path, connection.fileno())
        self._connection = connection

    def read(self) -> bytes:
        """Available bytes, up to a limit, without waiting; TLS may hold more, which the descriptor does not show.

        Raises
        ------
        PortGoneError
            The connection is closed, and all its bytes have been read.
        """
        chunks: list[bytes] = []
        self.wake_s = 0.0
        for _ in range(READS_PER_TURN):
            try:
                chunk = self._connection.recv(READ_BYTES)
            except self.waits:
                self.wake_s = inf
                break
            except OSError as error:
                if chunks:
                    break
                raise PortGoneError(self.path) from error
            if not chunk:
                if chunks:
                    break
                raise PortGoneError(self.path)
            chunks.append(chunk)
        return b"".join(chunks)

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


def open_tcp(address: SourceAddress) -> SocketPort:
    """Connect to a server."""
    return SocketPort(address.text, connected(address))


def open_unix(address: SourceAddress) -> SocketPort:
    """Connect to a server.

    Raises
    ------
    UsageError
        The address has no path, or this system has no unix sockets.
    LinkError
        There is no connection; the message says why.
    """
    if not address.rest or not hasattr(socket, "AF_UNIX"):
        raise UsageError(f"--port {address.text}: expected unix:PATH, on Linux or macOS")
    connection = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    connection.settimeout(CONNECT_S)
    try:
        connection.connect(address.rest)
    except OSError as error:
        connection.close()
        raise _explained_unix(address.text, error) from error
    return SocketPort(address.text, connection)


def _explained_unix(text: str, error: OSError) -> LinkError:
    if error.errno in NO_SERVER:
        return PortMissingError(f"{text}: {NO_SERVER[error.errno]}")
    if error.errno == errno.EACCES:
        return PortDeniedError(f"{text}: no permission to open it; ask the user who runs the server")
    return LinkError(f"{text}: no connection: {error}; expected the path of a unix socket")


TCP = ByteSource(
    "tcp",
    "tcp://HOST:PORT",
    "bytes of a TCP server, such as an ESP32 or ser2net",
    open_tcp,
    silence="the server accepted the connection; check that the device behind it is on and sends",
)
SOCKET = replace(TCP, scheme="socket", title="socket://HOST:PORT", about="the same as tcp, in the words of pyserial")
UNIX = ByteSource(
    "unix",
    "unix:PATH",
    "bytes of a server on a unix socket",
    open_unix,
    silence="the server accepted the connection; check that it sends",
)
