"""A source that aids a gyro: it runs in the loop of the gyros, and its measurements join the samples of one of them."""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from gyrodrift.columns.spec import parsed
from gyrodrift.config.sources import SourceSettings
from gyrodrift.io.logger import FilteringBoundLogger
from gyrodrift.io.waiting import POLLIN
from gyrodrift.link.connection import Connection
from gyrodrift.link.events import LinkEvents
from gyrodrift.link.options import LinkCounters, LinkOptions
from gyrodrift.link.second_source import SecondSource
from gyrodrift.link.sources.registry import address_of
from gyrodrift.service.loop import TICK_S, Service, Statements
from gyrodrift.values.secret import without_secrets

PATIENCE_S = 5.0
"""Time after which a source that is not understood is told, and the next baud rate is tried, s. Chosen: receivers
speak once a second."""

MAVLINK, CAN, ROSBRIDGE = "mavlink", "can", ("ws", "wss")


class AidService:
    """A second source on a link of its own, with the members of a `Service` that the loop of several gyros needs.

    gyro
        Service of the gyro that it aids, with which it ends.
    """

    def __init__(
        self, settings: SourceSettings, gyro: Service, statements: Statements, log: FilteringBoundLogger
    ) -> None:
        self.gyro, self.log = gyro, log
        self._statements = statements
        self._events = LinkEvents(log)
        address = address_of(settings.port)
        scheme = "" if address is None else address.scheme
        port = _own_values(settings, scheme)
        is_mavlink = scheme == MAVLINK
        self._source = SecondSource(settings.name, settings.columns, settings.late_s, is_mavlink=is_mavlink)
        self._is_baud_known = settings.baud is not None
        options = LinkOptions(port, settings.baud, waits=True, timeout_s=0.0)
        self.link = AidLink(Connection(options, LinkCounters(), self._events, lambda: None))
        self._since_s = 0.0
        self._is_told = False

    def begin(self) -> None:
        """Open the link, or begin to wait for it."""
        self._since_s = time.monotonic()
        self.link.connection.begin()

    @contextmanager
    def open_listeners(self) -> Iterator[None]:
        """Nothing is open besides the link."""
        yield

    def end(self) -> None:
        """Close the link, and log how much was understood."""
        self.link.connection.close()
        counted = {"messages": self._source.messages, "understood": self._source.understood}
        summary = f"{counted['understood']} measurements in {counted['messages']} messages for the gyro."
        self.log.info("service_end", summary=summary, **counted)

    @property
    def is_over(self) -> bool:
        """Whether the source or its gyro has ended."""
        return self.link.connection.is_over or self.gyro.is_over

    def descriptors(self) -> dict[int, int]:
        """Descriptor of the link."""
        port = self.link.connection.port
        return {} if port is None or port.fd is None else {port.fd: POLLIN}

    def wake_s(self) -> float:
        """Longest time to wait for the descriptor, s."""
        return self.link.connection.wake_s(TICK_S)

    def turn(self, _ready: set[int]) -> None:
        """Read, and hand measurements to the gyro."""
        connection = self.link.connection
        received = connection.read()
        for aid in self._source.take(received) if received else ():
            self._statements.take(aid)
        now_s = time.monotonic()
        if self._source.understood:
            connection.understood(now_s)
        elif self._source.messages and now_s - self._since_s >= PATIENCE_S:
            self._wait_on(now_s)

    def _wait_on(self, now_s: float) -> None:
        """Tell once that nothing is understood, and try the next baud rate."""
        self._since_s = now_s
        if not self._is_told:
            self._is_told = True
            hint = "name its values with columns:, such as 'course=heading:compass, v=speed:kn'"
            self._events("not_understood", port=self.link.name, reason=f"no message has a known measurement; {hint}")
        if self.link.connection.has_baud and not self._is_baud_known:
            self.link.connection.next_baud()


def _own_values(settings: SourceSettings, scheme: str) -> str:
    """Address with the option that lets a source of messages send the values of a second source."""
    port = settings.port
    if scheme in ROSBRIDGE and "type=" not in port:
        return f"{port}{'&' if '?' in port else '?'}type=any"
    if scheme == CAN and "dbc=" in port and settings.columns is not None:
        labels = [column.label for column in parsed(settings.columns, is_aid=True) if column.label]
        return f"{port}&signals={','.join(labels)}"
    return port


class AidLink:
    """The link of a second source, as the loop of several gyros sees it."""

    def __init__(self, connection: Connection) -> None:
        self.connection = connection

    @property
    def name(self) -> str:
        """Address without secrets."""
        return without_secrets(self.connection.name)

    def share_turn(self, _sources: int) -> Any:
        """A second source reads little; its turn needs no limit."""
