"""Helpers for tests of sources: the events of a link, TCP servers, lines of csv, and reading until enough arrived."""

import socket
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from gyrodrift.link.link import Link
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
