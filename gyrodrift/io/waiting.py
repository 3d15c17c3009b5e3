"""Waiting for descriptors: `select.poll`, or `select.select` where there is no poll, as on Windows.

Windows can wait for sockets only.
"""

import select
import time
from typing import Protocol

POLLIN: int = getattr(select, "POLLIN", 1)
POLLOUT: int = getattr(select, "POLLOUT", 4)


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
