"""Program that has a port open: a process, the owner of a lock file, or the kernel console.

The port itself is not opened.
"""

import os
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

LOCKS = Path("/var/lock")
"""Folder of lock files such as LCK..ttyUSB0, which hold a process number."""

CONSOLES = Path("/sys/class/tty/console/active")
"""Terminals that the kernel writes messages to."""


@dataclass(frozen=True, slots=True)
class PortHolder:
    """Program that has a port open; `pid` is None for the kernel."""

    name: str
    pid: int | None

    def __str__(self) -> str:
        return self.name if self.pid is None else f"{self.name} (pid {self.pid})"


def holder_of(path: str) -> PortHolder | None:
    """Holder of a port as far as this user may see it; the own process is ignored.

    Only root sees the descriptors of other users; without root, a lock file may show them.
    """
    device = os.path.realpath(path)
    return _by_descriptor(device) or _by_lock(device) or _by_console(device)


def _by_descriptor(device: str) -> PortHolder | None:
    for process in Path("/proc").glob("[0-9]*"):
        if int(process.name) == os.getpid():
            continue
        with suppress(OSError):
            if any(_points_to(link, device) for link in (process / "fd").iterdir()):
                return _process(int(process.name))
    return None


def _by_lock(device: str) -> PortHolder | None:
    with suppress(OSError, ValueError):
        pid = int((LOCKS / f"LCK..{Path(device).name}").read_text(encoding="ascii"))
        return _process(pid) if pid != os.getpid() else None
    return None  # no lock file, an invalid one, or its process is gone


def is_console(path: str) -> bool:
    """Whether the kernel writes its messages to this port."""
    device = Path(os.path.realpath(path))
    with suppress(OSError):
        return device.parent == Path("/dev") and device.name in CONSOLES.read_text(encoding="ascii").split()
    return False


def _by_console(device: str) -> PortHolder | None:
    return PortHolder("the kernel's console", None) if is_console(device) else None


def _process(pid: int) -> PortHolder:
    return PortHolder(
        Path(f"/proc/{pid}/comm").read_text(encoding="utf-8", errors="replace").strip(), pid
    )  # a process may have any name


def _points_to(link: Path, device: str) -> bool:
    try:
        return str(link.readlink()) == device
    except OSError:
        return False
