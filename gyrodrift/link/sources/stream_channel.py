"""Stream socket with or without TLS: wait for answers while it is opened, later read without waiting."""

import ssl
import time
from collections.abc import Mapping
from pathlib import Path
from socket import socket

from gyrodrift.io.files import UnreadableError, read_ordinary
from gyrodrift.link.port import READ_BYTES, PortGoneError
from gyrodrift.link.sources.sockets import SocketPort, connected
from gyrodrift.link.sources.source import SourceAddress
from gyrodrift.values.errors import LinkError, UsageError

TLS_OPTIONS = ("ca", "certificate", "key")
"""Options of an address with TLS."""

LONGEST_PEM_BYTES = 1 << 20
"""Largest file of certificates; those of all authorities of a system have 200 kB."""

ANSWER_S = 5.0
"""Longest wait for all answers while a channel is opened, s. Chosen: as for a connection."""


class StreamChannel(SocketPort):
    """Connected socket, with or without TLS."""

    waits = (BlockingIOError, ssl.SSLWantReadError, ssl.SSLWantWriteError)

    def __init__(self, path: str, connection: socket) -> None:
        super().__init__(path, connection)
        self._until_s = time.monotonic() + ANSWER_S

    def wait(self) -> bytes:
        """Next bytes, while the channel is opened.

        Raises
        ------
        LinkError
            The peer closes the connection, or does not answer.
        """
        left_s = self._until_s - time.monotonic()
        silence = f"{self.path}: the server does not answer within {ANSWER_S:g} s"
        if left_s <= 0.0:  # a peer that sends bytes for ever, and no answer
            raise LinkError(silence)
        self._connection.settimeout(left_s)
        try:
            chunk = self._connection.recv(READ_BYTES)
        except TimeoutError as error:
            raise LinkError(silence) from error
        except OSError as error:
            raise LinkError(f"{self.path}: the server ends the connection: {error}") from error
        if not chunk:
            raise LinkError(f"{self.path}: the server closes the connection; is it another kind of server?")
        self._connection.setblocking(False)
        return chunk

    def send(self, content: bytes) -> None:
        """Send a few bytes.

        Raises
        ------
        PortGoneError
            The peer does not read, or the connection is closed.
        """
        if self.write(content) != len(content):
            raise PortGoneError(self.path)


def connected_socket(address: SourceAddress, host: str, port: int, context: ssl.SSLContext | None) -> socket:
    """Connection, with TLS if there is a context.

    Raises
    ------
    LinkError
        There is no connection, or the certificate is not trusted.
    """
    connection = connected(SourceAddress(address.text, address.scheme, f"[{host}]:{port}"))
    if context is None:
        return connection
    try:
        return context.wrap_socket(connection, server_hostname=host)
    except ssl.SSLCertVerificationError as error:
        connection.close()
        why = error.verify_message
        raise LinkError(f"{address.text}: the certificate of {host} is not trusted: {why}; append ?ca=FILE") from error
    except OSError as error:  # SSLError is an OSError
        connection.close()
        raise LinkError(f"{address.text}: no TLS with {host}: {error}; is it a port without TLS?") from error


def tls_context(address: SourceAddress, options: Mapping[str, str]) -> ssl.SSLContext:
    """Context that checks the certificate of the server against `ca=FILE`, or those of the system.

    `certificate=FILE` is shown to the server, and `key=FILE` holds its key, if that is a separate file.

    Raises
    ------
    UsageError
        The file cannot be used.
    """
    files = {name: options[name] for name in TLS_OPTIONS if name in options}
    try:
        for path in files.values():
            read_ordinary(Path(path), LONGEST_PEM_BYTES)
        context = ssl.create_default_context(cafile=files.get("ca"))
        if "certificate" in files:
            context.load_cert_chain(files["certificate"], files.get("key"))
    except (OSError, ValueError, UnreadableError) as error:  # ssl.SSLError is an OSError
        named = ", ".join(f"{name}={path}" for name, path in files.items())
        raise UsageError(
            f"--port {address.text}: cannot use {named or 'the certificates of this system'}: {error}"
        ) from error
    return context


def host_and_path(address: SourceAddress, rest: str, usual_port: int) -> tuple[str, int, str]:
    """Host, port and path of `HOST[:PORT]/PATH`.

    Raises
    ------
    UsageError
        The address has another form.
    """
    authority, _, path = rest.partition("/")
    has_port = ":" in authority.rpartition("]")[2]
    host, port = SourceAddress(
        address.text, address.scheme, authority if has_port else f"{authority}:{usual_port}"
    ).host_port()
    return host, port, path
