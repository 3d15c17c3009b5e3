"""Waiting for descriptors, and writing to a shared one without waiting for its reader.

The wait is `select.poll`, or `select.select` where there is no poll, as on Windows, which can wait for sockets only.
"""

import os
import select
import socket
import stat
import time
from typing import Protocol

POLLIN: int = getattr(select, "POLLIN", 1)
POLLOUT: int = getattr(select, "POLLOUT", 4)

CAN_REFUSE_TO_WAIT = hasattr(os, "O_NONBLOCK")
"""Windows waits for a slow reader of a pipe."""

PIECE_BYTES = 512
"""Bytes that a writable pipe takes at once (POSIX); a terminal guarantees one byte only."""


class Poller(Protocol):
    """The part of `select.poll` that this package uses."""

    def register(self, fd: int, eventmask: int, /) -> None:
        """Wait for these events of a descriptor too."""

    def poll(self, timeout_ms: float, /) -> list[tuple[int, int]]:
        """Descriptors with events, at the latest after `timeout_ms`."""
        ...


def new_poller() -> Poller:
    """A poller without descriptors."""
    return select.poll() if hasattr(select, "poll") else SelectPoller()


def wait_readable(fd: int | None, seconds: float) -> None:
    """Wait until a descriptor is readable, at most so long; without a descriptor, so long."""
    poller = new_poller()
    if fd is not None:
        poller.register(fd, POLLIN)
    poller.poll(seconds * 1e3)


class SelectPoller:
    """`select.poll` by means of `select.select`."""

    def __init__(self) -> None:
        self._events: dict[int, int] = {}

    def register(self, fd: int, eventmask: int, /) -> None:
        """Wait for these events of a descriptor too."""
        self._events[fd] = eventmask

    def poll(self, timeout_ms: float, /) -> list[tuple[int, int]]:
        """Descriptors with events, at the latest after `timeout_ms`."""
        reading = [fd for fd, events in self._events.items() if events & POLLIN]
        writing = [fd for fd, events in self._events.items() if events & POLLOUT]
        if not reading and not writing:  # Windows refuses to wait for nothing
            time.sleep(timeout_ms / 1e3)
            return []
        readable, writable, _ = select.select(reading, writing, [], timeout_ms / 1e3)
        ready = dict.fromkeys(readable, POLLIN)
        for fd in writable:
            ready[fd] = ready.get(fd, 0) | POLLOUT
        return list(ready.items())


def send_unwaiting(fd: int, data: bytes) -> int:
    """Write as much as the reader takes at once, and return the number of bytes.

    O_NONBLOCK belongs to the open file, which other programs share, so a pipe or a terminal is opened again for every
    write. If that is not allowed (after `su`, or in a container), small pieces are written instead, which never block.

    Raises
    ------
    OSError
        The reader is gone, or the disk is full.
    """
    if not CAN_REFUSE_TO_WAIT:
        return os.write(fd, data)
    mode = os.fstat(fd).st_mode
    try:
        if stat.S_ISSOCK(mode):
            with socket.socket(fileno=os.dup(fd)) as end:
                return end.send(data, socket.MSG_DONTWAIT)
        if stat.S_ISREG(mode):
            return os.write(fd, data)
        return _write_reopened(fd, data)
    except BlockingIOError:
        return 0


def send_within(fd: int, data: bytes, patience_s: float) -> int:
    """Write as much as the reader takes within a time, and return the number of bytes; raises as `send_unwaiting`."""
    if not CAN_REFUSE_TO_WAIT:
        return os.write(fd, data)
    poller, until_s, sent = new_poller(), time.monotonic() + patience_s, 0
    poller.register(fd, POLLOUT)
    while sent < len(data) and (remaining_s := until_s - time.monotonic()) > 0.0:
        if poller.poll(1e3 * remaining_s):
            sent += send_unwaiting(fd, data[sent:])
    return sent


def _write_reopened(fd: int, data: bytes) -> int:
    try:
        own = os.open(f"/proc/self/fd/{fd}", os.O_WRONLY | os.O_NONBLOCK | os.O_NOCTTY | os.O_CLOEXEC)
    except (PermissionError, FileNotFoundError):  # FileNotFoundError without /proc
        return _send_a_piece(fd, data)
    try:
        return os.write(own, data)
    finally:
        os.close(own)


def _send_a_piece(fd: int, data: bytes) -> int:
    """Write a piece that never blocks if the reader has any space."""
    poller = new_poller()
    poller.register(fd, POLLOUT)
    if not poller.poll(0):
        return 0
    return os.write(fd, data[:1] if os.isatty(fd) else data[:PIECE_BYTES])
