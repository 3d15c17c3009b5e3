"""Reservation of a link by a running simulated device: exclusive, visible to other programs, gone with its process.

A reservation is a bound socket in the abstract namespace of Linux (unix(7)). The kernel refuses a second socket of
the same name and removes the name when the process ends, however it ends.
"""

import os
import socket
from hashlib import sha256
from pathlib import Path

PREFIX = "gyrodrift-device:"
NAME_BYTES_MAX = 107
"""Length of sockaddr_un.sun_path less the zero byte that marks an abstract name (unix(7))."""

SOCKETS = Path("/proc/net/unix")
NAME_COLUMN = 7


def reserve(link: Path) -> socket.socket | None:
    """A socket that holds the link until it is closed; None if another device holds it."""
    holder = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    try:
        holder.bind(f"\0{_name(link)}")
    except OSError:
        holder.close()
        return None
    return holder


def reserved_links() -> list[Path]:
    """Links of all simulated devices that run on this machine, by name.

    A path that does not fit into the name of a socket (90 bytes) is missing.
    """
    try:
        rows = [row.split(maxsplit=NAME_COLUMN) for row in SOCKETS.read_text(errors="surrogateescape").splitlines()]
    except OSError:
        return []
    names = {row[NAME_COLUMN].removeprefix("@") for row in rows if len(row) > NAME_COLUMN}
    return sorted(Path(name.removeprefix(PREFIX)) for name in names if name.startswith(f"{PREFIX}/"))


def _name(link: Path) -> str:
    """Name of the socket: the absolute path, or its hash if it is too long. Symbolic links of folders are resolved."""
    path = str(link.parent.resolve() / link.name)
    name = f"{PREFIX}{path}"
    return name if len(os.fsencode(name)) <= NAME_BYTES_MAX else f"{PREFIX}{sha256(os.fsencode(path)).hexdigest()}"
