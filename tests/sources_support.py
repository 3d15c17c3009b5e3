"""Helpers for tests of links: their events and their clock, TCP servers, lines of csv, reading until enough arrived."""

import socket
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Self

from firmware_sim.pty import PtyDevice
from gyrodrift.link.link import Link
from gyrodrift.link.options import LinkOptions
from gyrodrift.values.sample import Sample

PATIENCE_S = 240.0
"""How long a test waits for what should come at once."""


class Events:
    """Events of a link, and their fields."""

    def __init__(self) -> None:
        self.told: list[tuple[str, dict[str, Any]]] = []

    def __call__(self, event: str, **fields: Any) -> None:
        self.told.append((event, fields))

    def names(self) -> list[str]:
        return [event for event, _ in self.told]


class Host(Events):
    """A link with a clock that the test sets, and its events."""

    def __init__(self, port: Path | str, **options: Any) -> None:
        super().__init__()
        self.now_s = 1000.0
        self.link = Link(LinkOptions(str(port), **options), self, lambda: self.now_s)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.link.close()

    def read(self, after_s: float) -> list[Sample]:
        """Samples after some time."""
        self.now_s += after_s
        return self.link.read()

    def hear(self, device: PtyDevice, frames: Iterable[bytes], step_s: float = 0.01) -> list[Sample]:
        """Samples of frames that are sent and read one by one."""
        samples: list[Sample] = []
        for frame in frames:
            assert device.send(frame)
            samples += self.read(step_s)
        return samples


@contextmanager
def serving(port: int = 0) -> Iterator[socket.socket]:
    """A TCP server on this machine."""
    with socket.create_server(("127.0.0.1", port)) as server:
        server.settimeout(PATIENCE_S)
        yield server


def address(server: socket.socket) -> str:
    return f"tcp://127.0.0.1:{server.getsockname()[1]}"


def lines(first: int, count: int) -> bytes:
    """Lines of csv, 10 ms apart."""
    return b"".join(b"%d,0.5\n" % (10_000 * number) for number in range(first, first + count))


def read_until(link: Link, is_done: Callable[[list[Sample]], bool]) -> list[Sample]:
    """Samples until they are enough."""
    samples: list[Sample] = []
    until_s = time.monotonic() + PATIENCE_S
    while not is_done(samples):
        assert time.monotonic() < until_s
        samples += link.read()
        time.sleep(0.002)
    return samples
