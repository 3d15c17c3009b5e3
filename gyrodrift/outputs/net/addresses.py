"""Addresses and names of others: is an address in the network, which program has a port, datagrams to one address."""

import asyncio
import errno
import ipaddress
import os
import re
import socket
from collections.abc import Iterator
from pathlib import Path

from gyrodrift.io.logger import FilteringBoundLogger
from gyrodrift.outputs.output import OutputError

LISTENING = "0A"
"""State of a listening socket in /proc/net/tcp; bound datagram sockets have the state 07 in /proc/net/udp."""
BOUND = "07"

LONGEST_NAME = 40
"""Longest foreign name in `status`, in the log, on the page and in metrics, in characters."""


def is_loopback(host: str) -> bool:
    """Whether an address, or the name in a URL, stands for this machine alone; no name but localhost counts."""
    if host == "localhost":
        return True
    try:
        address = ipaddress.ip_address(host)
    except ValueError:
        return False
    return (getattr(address, "ipv4_mapped", None) or address).is_loopback


def warn_of_others(log: FilteringBoundLogger, host: str) -> None:
    """Warn that the network can read the output."""
    if not is_loopback(host):
        log.warning("output_open_to_network", host=host, hint="anyone who reaches this address can read; no password")


def shown(host: str, port: int) -> str:
    """`host:port`, with brackets around an IPv6 address."""
    return f"[{host}]:{port}" if ":" in host else f"{host}:{port}"


def cannot_listen(error: OSError, host: str, port: int) -> OutputError:
    """Error for a failed bind, with the program that has the port if /proc shows it."""
    where = shown(host, port)
    if error.errno == errno.EADDRINUSE:
        holder = holder_of(port)
        return OutputError(f"port {where} is used by {holder or 'another program'}; choose another with port=")
    if error.errno == errno.EACCES:
        return OutputError(f"port {where} may not be opened by this user; ports below 1024 belong to the system")
    if error.errno == errno.EADDRNOTAVAIL:
        return OutputError(f"{host} is no address of this machine")
    return OutputError(f"cannot listen on {where}: {error.strerror or error}")


def holder_of(port: int) -> str | None:
    """Name and number of the process that listens on a port; None if unknown."""
    inodes = set(_inodes(port))
    if not inodes:
        return None
    for folder in Path("/proc").glob("[0-9]*"):
        if inodes & set(_sockets_of(folder)):
            if int(folder.name) == os.getpid():
                return "another output of this service"
            return f"{_name_of(folder)} (process {folder.name})"
    return None


def _inodes(port: int) -> Iterator[str]:
    """Inodes of sockets that are bound to a port."""
    for table, state in (("tcp", LISTENING), ("tcp6", LISTENING), ("udp", BOUND), ("udp6", BOUND)):
        try:
            rows = Path("/proc/net", table).read_text().splitlines()[1:]
        except OSError:
            continue
        for row in rows:
            columns = row.split()
            if columns[3] == state and int(columns[1].rpartition(":")[2], 16) == port:
                yield columns[9]


def _sockets_of(folder: Path) -> Iterator[str]:
    """Inodes of the open sockets of a process; none without permission."""
    try:
        links = list((folder / "fd").iterdir())
    except OSError:
        return
    for link in links:
        try:
            match = re.fullmatch(r"socket:\[(\d+)\]", str(link.readlink()))
        except OSError:
            continue  # closed meanwhile
        if match:
            yield match[1]


def _name_of(folder: Path) -> str:
    try:
        return (folder / "comm").read_text(errors="replace").strip()
    except OSError:
        return "a process"


def shown_name(name: str | bytes) -> str:
    """A name with escapes for unprintable characters, shortened if it is long."""
    text = name if isinstance(name, str) else name.decode("utf-8", "backslashreplace")
    cut = text[:LONGEST_NAME] + "…" * (len(text) > LONGEST_NAME)
    return "".join(character if character.isprintable() else repr(character)[1:-1] for character in cut)


def well_formed(name: str) -> str:
    """A name as valid UTF-8, with escapes for other bytes."""
    return name.encode("utf-8", "backslashreplace").decode()


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
