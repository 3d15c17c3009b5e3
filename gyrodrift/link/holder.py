"""Who has a port open already: another process, a program that left a lock file, or the kernel's console.

Nothing here opens the port.
"""

import os
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

LOCKS = Path("/var/lock")
"""Where terminal programs and modem daemons leave LCK..ttyUSB0, with the number of their process in it."""

CONSOLES = Path("/sys/class/tty/console/active")
"""The terminals that the kernel writes its messages to."""


@dataclass(frozen=True, slots=True)
class PortHolder:
    """A program that has a port open; `pid` is None for the kernel."""

    name: str
    pid: int | None

    def __str__(self) -> str:
        return self.name if self.pid is None else f"{self.name} (pid {self.pid})"


def holder_of(path: str) -> PortHolder | None:
    """Who holds the port as far as this user may see; our own process is not a suspect.

    Descriptors of other users' processes are seen by root alone; of those only a lock file tells.
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
        pid = int((LOCKS / f"LCK..{Path(device).name}").read_text())
        return _process(pid) if pid != os.getpid() else None
    return None  # no lock, one that says nothing, or one whose process is gone


def _by_console(device: str) -> PortHolder | None:
    with suppress(OSError):
        if Path(device).parent == Path("/dev") and Path(device).name in CONSOLES.read_text().split():
            return PortHolder("the kernel's console", None)
    return None


def _process(pid: int) -> PortHolder:
    return PortHolder(Path(f"/proc/{pid}/comm").read_text(errors="replace").strip(), pid)  # a process may take any name


def _points_to(link: Path, device: str) -> bool:
    try:
        return str(link.readlink()) == device
    except OSError:
        return False
