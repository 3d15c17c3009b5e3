"""A device for other programs: an iterator of its samples."""

import time
from collections import deque
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any, Self

from gyrodrift.io.waiting import POLLIN, new_poller

if TYPE_CHECKING:
    from gyrodrift.link.link import Link
    from gyrodrift.link.options import EventHandler, LinkCounters
    from gyrodrift.values.sample import Sample


class LinkReader:
    """An open link: an iterator that waits for samples, and a context manager that closes the port.

    After an unplugged cable it waits for the device and continues. Use it from one thread.
    """

    def __init__(self, link: "Link") -> None:
        self._link = link
        self._waiting: deque[Sample] = deque()
        self._is_closed = False

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __iter__(self) -> "Iterator[Sample]":
        return self

    def __next__(self) -> "Sample":
        """Wait for the next sample; iteration ends after `close`, or at the end of a source.

        Raises
        ------
        LinkError
            If no decodable data arrives in time, or the device clock is invalid.
        """
        while not self._waiting:
            if self._is_closed or self._link.is_over:
                raise StopIteration
            self._waiting.extend(self._read(None))
        return self._waiting.popleft()

    def read(self, wait_s: float = 0.0) -> "list[Sample]":
        """Samples received so far, after a wait of at most `wait_s` for the first; for a program with its own loop.

        Raises
        ------
        LinkError
            As in iteration.
        """
        until_s = time.monotonic() + wait_s
        samples = [*self._waiting]
        self._waiting.clear()
        while not self._is_closed and not self._link.is_over:
            samples += self._read(max(0.0, until_s - time.monotonic()) if not samples else 0.0)
            if samples or time.monotonic() >= until_s:
                break
        return samples

    def fileno(self) -> int | None:
        """File descriptor for `select`, readable with new samples; None while the device is unplugged."""
        return self._link.fileno()

    @property
    def counters(self) -> "LinkCounters":
        """Counts of samples, gaps, resets and reconnects since the link was opened."""
        return self._link.counters

    def close(self) -> None:
        """Close the port; iteration ends."""
        self._is_closed = True
        self._link.close()

    def _read(self, most_s: float | None) -> "list[Sample]":
        """Wait for the link, at most `most_s`, and read."""
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
        Such as `/dev/ttyUSB0`, or a source such as `tcp://HOST:PORT`.
    baud
        Line rate in baud; None to find it.
    protocol
        Protocol, as in the option `--protocol` of `serve`.
    columns
        Columns of text lines, as in the option `--columns`.
    timeout_s
        Longest wait for decodable data from the start, s; 0 waits forever.
    send
        Bytes to send after the port is opened, as with the option `--send`.
    on_event
        Called with the name and the fields of each link event: `on_event("gap", missing=3, seconds=0.04)`.

    Raises
    ------
    UsageError
        If the protocol does not exist, or the columns are wrong.
    LinkError
        If the port cannot be opened.
    """
    from gyrodrift.link.link import Link
    from gyrodrift.link.options import LinkOptions

    tell: Callable[..., Any] = on_event or _untold
    return LinkReader(Link(LinkOptions(str(port), baud, protocol, timeout_s, columns, send), tell))


def _untold(_event: str, **_fields: Any) -> None:
    """Ignore events."""
