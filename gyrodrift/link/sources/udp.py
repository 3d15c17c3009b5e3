"""Source `udp://[HOST]:PORT`: datagrams that a device sends to this machine.

Without a host it listens on loopback. `udp://0.0.0.0:PORT` listens on all networks.
"""

import errno
import socket
import time
from collections.abc import Callable
from contextlib import suppress
from math import inf

from gyrodrift.link.heard import LineEnds
from gyrodrift.link.sources.source import ByteSource, SourceAddress, SourcePort
from gyrodrift.values.errors import LinkError, PortBusyError, PortDeniedError, PortMissingError

LOOPBACK = "127.0.0.1"

LONGEST_DATAGRAM = 65_535
"""Length field of UDP, 16 bits (RFC 768)."""

DATAGRAMS_PER_TURN, BYTES_PER_TURN = 1024, 65_536
"""Largest number of datagrams and bytes at a time, so that a flood does not block the loop.

After a stall of WiFi a second of samples arrives at once. Read in several turns, the first ones would look like a gap.
"""

BUFFER_BYTES = 1 << 20
"""Wanted size of the receive buffer; the kernel may give less (`net.core.rmem_max`)."""

SENDER_S = 2.0
"""Time without samples of a sender after which any sender is heard, s: a restarted board has a new address or port."""

Sender = tuple[object, ...]


class UdpPort(SourcePort):
    """Bound datagram socket that follows the first sender of samples.

    Two senders would mix two streams. Until one of them sends samples, a read gives the datagrams of one sender, and
    the next read those of the next one. Then datagrams of others are dropped; the first one is noted. `is_text` is
    False for frames that may look like a text without a line end.
    """

    def __init__(
        self,
        path: str,
        bound: socket.socket,
        monotonic: Callable[[], float] = time.monotonic,
        *,
        is_text: bool = True,
    ) -> None:
        bound.setblocking(False)
        super().__init__(path, bound.fileno())
        self._bound = bound
        self._monotonic = monotonic
        self.stream: Sender | None = None
        self._followed: Sender | None = None
        self._understood_s = 0.0
        self._candidates: dict[Sender, list[bytes]] = {}
        self._is_told = False
        self._line_ends = LineEnds(is_text=is_text)

    def read(self) -> bytes:
        """Content of the waiting datagrams of one sender, up to a limit, without waiting."""
        if self._followed is not None and self._monotonic() - self._understood_s >= SENDER_S:
            self._followed = None
        if not self._candidates:
            self._receive()
        if not self._candidates:
            return b""
        self.stream = next(iter(self._candidates))
        chunk = b"".join(self._candidates.pop(self.stream))
        self.wake_s = 0.0 if self._candidates else inf
        return chunk

    def understood(self) -> None:
        """Follow the sender of the last read; what others have sent is dropped."""
        self._followed, self._understood_s = self.stream, self._monotonic()
        if self._candidates:
            self._tell(next(iter(self._candidates)))
            self._candidates.clear()
            self.wake_s = inf

    def _receive(self) -> None:
        """Take datagrams from the kernel, those of all senders while none is followed."""
        size = 0
        for _ in range(DATAGRAMS_PER_TURN):
            if size >= BYTES_PER_TURN:
                break
            try:
                content, sender = self._bound.recvfrom(LONGEST_DATAGRAM)
            except OSError:  # nothing waits, or an answer of ICMP to what was sent
                break
            size += len(content)
            if self._followed in (None, sender):
                self._candidates.setdefault(sender, []).append(self._line_ends.add(content))
            else:
                self._tell(sender)

    def write(self, content: bytes) -> int:
        """Send to the device that was heard last; nothing before the first datagram."""
        if self.stream is None:
            return 0
        try:
            return self._bound.sendto(content, self.stream)
        except OSError:
            return 0

    def close(self) -> None:
        """Close the socket."""
        with suppress(OSError):
            self._bound.close()

    def _tell(self, sender: Sender) -> None:
        if not self._is_told:
            self._is_told = True
            followed = self._followed or sender
            self.note("other_sender", ignored=f"{sender[0]}:{sender[1]}", followed=f"{followed[0]}:{followed[1]}")


def open_udp(address: SourceAddress) -> UdpPort:
    """Bind the address.

    Raises
    ------
    UsageError
        The address has another form.
    LinkError
        The address cannot be bound; the message says why.
    """
    return UdpPort(address.text, bound_socket(address))


def bound_socket(address: SourceAddress) -> socket.socket:
    """Datagram socket at the `[HOST]:PORT` of an address.

    Raises
    ------
    UsageError
        The address has another form.
    LinkError
        The address cannot be bound; the message says why.
    """
    host, port = address.host_port(LOOPBACK)
    try:
        family, kind, protocol, _, socket_address = socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)[0]
        bound = socket.socket(family, kind, protocol)
    except (OSError, UnicodeError) as error:
        raise PortMissingError(f"{address.text}: the name {host!r} is not known; check its spelling") from error
    try:
        bound.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, BUFFER_BYTES)
        bound.bind(socket_address)
    except OSError as error:
        bound.close()
        raise _explained(address.text, host, port, error) from error
    return bound


def _explained(text: str, host: str, port: int, error: OSError) -> LinkError:
    match error.errno:
        case errno.EADDRINUSE:
            return PortBusyError(f"{text}: another program listens on UDP port {port}; stop it, or use another port")
        case errno.EACCES:
            return PortDeniedError(f"{text}: this user may not listen on port {port}; use one above 1023")
        case errno.EADDRNOTAVAIL:
            return PortMissingError(
                f"{text}: {host} is not an address of this machine; name one of them, or 0.0.0.0 for all networks"
            )
    return LinkError(f"{text}: cannot listen on port {port} of {host}: {error}")


UDP = ByteSource(
    "udp",
    "udp://[HOST]:PORT",
    "datagrams that a device sends to this machine",
    open_udp,
    silence="the device must send to this machine and port; without a host only this machine is heard, "
    "udp://0.0.0.0:PORT listens on all networks",
)
