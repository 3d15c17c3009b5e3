"""A device for other programs: its samples one after the other, until the program has enough."""

import time
from collections import deque
from collections.abc import Callable, Iterator
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

from gyrodrift.waiting import POLLIN, new_poller

if TYPE_CHECKING:
    from gyrodrift.link.link import EventHandler, Link, LinkCounters
    from gyrodrift.sample import Sample


class LinkReader:
    """An open link: an iterator of samples that waits for them, and a context manager that gives the port back.

    A device that is unplugged is waited for and goes on under its stable name. One thread drives it.
    """

    def __init__(self, link: "Link") -> None:
        self._link = link
        self._waiting: deque[Sample] = deque()
        self._is_closed = False

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __iter__(self) -> "Iterator[Sample]":
        return self

    def __next__(self) -> "Sample":
        """The next sample, as soon as it is there; the end after `close`.

        Raises
        ------
        LinkError
            Where nothing decodable came in time, or the device clock turns out to be none.
        """
        while not self._waiting:
            if self._is_closed:
                raise StopIteration
            self._waiting.extend(self._read(None))
        return self._waiting.popleft()

    def read(self, wait_s: float = 0.0) -> "list[Sample]":
        """What has come, after waiting at most `wait_s` for the first of it; for programs with a loop of their own.

        Raises
        ------
        LinkError
            As above.
        """
        until_s = time.monotonic() + wait_s
        found = [*self._waiting]
        self._waiting.clear()
        while not self._is_closed:
            found += self._read(max(0.0, until_s - time.monotonic()) if not found else 0.0)
            if found or time.monotonic() >= until_s:
                break
        return found

    def fileno(self) -> int | None:
        """The descriptor that becomes readable with new samples, for `select`; None while the device is unplugged."""
        return self._link.fileno()

    @property
    def counters(self) -> "LinkCounters":
        """Samples, gaps, resets and reconnects since it was opened."""
        return self._link.counters

    def close(self) -> None:
        """Give the port back; iterating ends."""
        self._is_closed = True
        self._link.close()

    def _read(self, most_s: float | None) -> "list[Sample]":
        """Wait for what the link wakes for, no longer than `most_s`, and read."""
        wait_s = self._link.wake_s() if most_s is None else min(most_s, self._link.wake_s())
        fd = self._link.fileno()
        if fd is None:
            time.sleep(wait_s)
        else:
            poller = new_poller()
            poller.register(fd, POLLIN)
            poller.poll(wait_s * 1e3)
        return self._link.read()


def open_link(
    port: str,
    *,
    baud: int | None = None,
    protocol: str = "auto",
    columns: str | None = None,
    timeout_s: float = 10.0,
    send: bytes = b"",
    on_event: "EventHandler | None" = None,
) -> LinkReader:
    """Open a device on a serial port.

    Parameters
    ----------
    port
        Such as `/dev/ttyUSB0`.
    baud
        Line rate in baud; None to find it.
    protocol
        As the option `--protocol` of `serve` names it.
    columns
        Of lines of text, as its option `--columns`.
    timeout_s
        Give up where nothing decodable came within so many seconds of the start; 0 waits for ever.
    send
        What a device that waits is sent after its port was opened, as with the option `--send`.
    on_event
        Called with the name and the fields of what happens on the link: `on_event("gap", missing=3, seconds=0.04)`.

    Raises
    ------
    UsageError
        Where there is no such protocol, or the columns are not understood.
    LinkError
        Where the port cannot be opened.
    """
    from gyrodrift.link.link import Link, LinkOptions

    tell: Callable[..., Any] = on_event or _untold
    return LinkReader(Link(LinkOptions(str(port), baud, protocol, timeout_s, columns, send), tell))


def _untold(_event: str, **_fields: Any) -> None:
    """Nobody asked for events."""
