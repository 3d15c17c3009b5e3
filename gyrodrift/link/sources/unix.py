"""Source `unix:PATH`: the bytes of a server on a unix socket of this machine."""

import errno
import socket

from gyrodrift.link.sources.sockets import CONNECT_S, SocketPort
from gyrodrift.link.sources.source import ByteSource, SourceAddress
from gyrodrift.values.errors import LinkError, PortDeniedError, PortMissingError, UsageError

MISSING = {
    errno.ENOENT: "there is no such socket; start the server first",
    errno.ECONNREFUSED: "nothing listens on this socket; start the server first",
}


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
        raise _explained(address.text, error) from error
    return SocketPort(address.text, connection)


def _explained(text: str, error: OSError) -> LinkError:
    if error.errno in MISSING:
        return PortMissingError(f"{text}: {MISSING[error.errno]}")
    if error.errno == errno.EACCES:
        return PortDeniedError(f"{text}: no permission to open it; ask the user who runs the server")
    return LinkError(f"{text}: no connection: {error}; expected the path of a unix socket")


UNIX = ByteSource(
    "unix",
    "unix:PATH",
    "bytes of a server on a unix socket",
    open_unix,
    silence="the server accepted the connection; check that it sends",
)
