"""Functions of Linux that other systems lack, each with a substitute.

macOS has all but the count of usable processors. Windows has none of them. Everything else in the package calls this
file, so that reading and analyzing sessions runs on all three.
"""

import os
import socket
import sys
from typing import IO

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]

CAN_FORK = hasattr(os, "fork")
"""Whether worker processes can inherit the memory of this process."""

UNKNOWN_MEMORY_BYTES = 4 << 30
"""Windows 11 needs 4 GiB."""

PR_SET_PDEATHSIG = 1
"""Linux, prctl(2): asks for a signal when the parent ends."""

OPEN_AT_ONCE: int = getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_NOCTTY", 0)
"""Flags of os.open: do not wait for the other end of a pipe, and take no terminal as the controlling terminal."""


def processor_count() -> int:
    """Processors that this process may use."""
    if sys.platform == "linux" and hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def memory_bytes_of_machine() -> int:
    """Memory of the machine, bytes; UNKNOWN_MEMORY_BYTES where the system does not say."""
    if sys.platform != "win32" and hasattr(os, "sysconf"):
        return os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    return UNKNOWN_MEMORY_BYTES


def lock_file(file: IO[bytes], *, wait: bool) -> None:
    """Lock an open file against other processes until it is closed. Windows has no such lock and keeps none.

    Raises
    ------
    BlockingIOError
        If another process holds the lock and `wait` is false.
    """
    if fcntl is not None:
        fcntl.flock(file, fcntl.LOCK_EX if wait else fcntl.LOCK_EX | fcntl.LOCK_NB)


def read_at(fd: int, count: int, offset: int) -> bytes:
    """Read up to `count` bytes at an offset of a file; its position stays."""
    if hasattr(os, "pread"):
        return os.pread(fd, count, offset)
    position = os.lseek(fd, 0, os.SEEK_CUR)
    try:
        os.lseek(fd, offset, os.SEEK_SET)
        return os.read(fd, count)
    finally:
        os.lseek(fd, position, os.SEEK_SET)


def set_mode(fd: int, mode: int) -> None:
    """Set the permissions of an open file where the system has them."""
    if hasattr(os, "fchmod"):
        os.fchmod(fd, mode)


def set_owner(fd: int, user_id: int, group_id: int) -> None:
    """Set the owner or the group of an open file where the system has them; -1 keeps.

    Raises
    ------
    OSError
        If this user may not.
    """
    if hasattr(os, "fchown"):
        os.fchown(fd, user_id, group_id)


def sync_folder(folder: os.PathLike[str]) -> None:
    """Make the names of new files survive a power failure. Windows cannot open folders and skips this."""
    if not hasattr(os, "O_DIRECTORY"):
        return
    fd = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        os.fsync(fd)
    finally:
        os.close(fd)


class WakePipe:
    """Two descriptors, neither of which waits: a byte written to `write_fd` makes `fd` readable.

    A pipe; without `os.pipe2` a pair of sockets, since Windows can wait for sockets only.
    """

    def __init__(self) -> None:
        self._sockets: tuple[socket.socket, ...] = ()
        if sys.platform != "win32" and hasattr(os, "pipe2"):
            self.fd, self.write_fd = os.pipe2(os.O_NONBLOCK | os.O_CLOEXEC)
            return
        self._sockets = socket.socketpair()
        for end in self._sockets:
            end.setblocking(False)
        self.fd, self.write_fd = (end.fileno() for end in self._sockets)

    def close(self) -> None:
        """Close both."""
        for end in self._sockets:
            end.close()
        if not self._sockets:
            os.close(self.fd)
            os.close(self.write_fd)


def kill_with(parent: int) -> None:
    """Have Linux kill this process when the process of that id, its parent, ends."""
    if sys.platform != "linux":
        return
    import ctypes  # noqa: PLC0415 - only workers need it
    from signal import SIGKILL  # noqa: PLC0415 - likewise

    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, int(SIGKILL), 0, 0, 0)
    if os.getppid() != parent:  # it ended before the call
        os._exit(1)
