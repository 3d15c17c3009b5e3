"""The connection of a link: a port or a source that is opened, lost, and opened again under its stable name."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from itertools import cycle

from gyrodrift.link.opening import Opening
from gyrodrift.link.options import EventHandler, LinkCounters, LinkOptions
from gyrodrift.link.port import USUAL_BAUDS, PortGoneError, stable_name
from gyrodrift.link.protocols.batch import ReadingBatch
from gyrodrift.link.sources.opening import BackgroundOpening, checked_source, open_port
from gyrodrift.link.sources.source import SourceEndedError, SourcePort
from gyrodrift.values.errors import LinkError, PortMissingError, UsageError

SOON_S = 0.5
"""Longest wait at the start for a source that may come later, s: an answer or a refusal of a near host is faster."""

OPENING_S = 0.05
"""Time between two looks at a source that is being opened in the background, s."""

FIRST_S = 0.05
LONGEST_S = 2.0
"""First and longest wait between two attempts, s; the wait doubles after a failure."""


@dataclass(slots=True)
class Backoff:
    """Wait before the next attempt to open a lost port, on the monotonic clock, s: short at first, then longer."""

    _wait_s: float = FIRST_S
    _due_s: float = 0.0

    def begin(self, now_s: float) -> None:
        """Start with the shortest wait, after the port was lost."""
        self._wait_s = FIRST_S
        self._due_s = now_s + self._wait_s

    def fail(self, now_s: float) -> None:
        """Wait longer, after an attempt has failed."""
        self._wait_s = min(2.0 * self._wait_s, LONGEST_S)
        self._due_s = now_s + self._wait_s

    def remaining_s(self, now_s: float) -> float:
        """Time until the next attempt, s; 0 if it is due."""
        return max(0.0, self._due_s - now_s)


class Connection:
    """Bytes of a port or a source, and the events about it; `begin` opens it.

    A source that cannot be opened is tried again if `timeout_s` is 0. After the end of a source `is_over` is True.
    `baud` is the rate of the options, or the one that is tried; 0 for a source without one.

    Parameters
    ----------
    options
        Of the link.
    counters
        Where reconnections are counted.
    on_event
        Takes the events.
    on_return
        Called when a lost port is open again, before its event.
    monotonic
        Clock, s.

    Raises
    ------
    UsageError
        The address of a source has a mistake.
    """

    def __init__(
        self,
        options: LinkOptions,
        counters: LinkCounters,
        on_event: EventHandler,
        on_return: Callable[[], None],
        monotonic: Callable[[], float] = time.monotonic,
    ) -> None:
        self.source = checked_source(options)
        self.name = stable_name(options.port) if self.source is None else options.port
        self.has_baud = self.source is None or self.source.has_baud
        self._bauds = cycle(USUAL_BAUDS)
        self.baud = options.baud or (next(self._bauds) if self.has_baud else 0)
        self.port: SourcePort | None = None
        self.is_over = False
        self.refusal = ""
        self.was_open = False
        self.opening = Opening(options.send, on_event)
        self._options, self._counters = options, counters
        self._on_event, self._on_return, self._monotonic = on_event, on_return, monotonic
        self._is_refused = False
        self._backoff = Backoff()
        self._reopening: BackgroundOpening | None = None
        self.opened_s = self._heard_s = self._back_s = monotonic()

    def begin(self, port: SourcePort | None = None) -> None:
        """Open the port, or take one that is open with the name and baud rate of the options.

        Raises
        ------
        LinkError
            If the port cannot be opened.
        """
        self.port = port or self._first_open()
        if self.port is not None:
            self._report_open()
        if port is None and self.port is not None:
            self.opening.begin(self.port, self.opened_s)

    def wake_s(self, usual_s: float) -> float:
        """Longest time to wait before the next `read`, s; `usual_s` for a port that needs no care."""
        if self.is_over:
            return 1.0
        if self.port is None:
            return self._backoff.remaining_s(self._monotonic()) if self._reopening is None else OPENING_S
        return min(usual_s, self.port.wake_s)

    def read(self) -> bytes | ReadingBatch:
        """Bytes or readings that have arrived; opens a lost port again.

        Raises
        ------
        LinkError
            The port has an error that is no end of a connection.
        """
        if self.port is None and not self.is_over:
            self._reopen()
        if self.port is None:
            return b""
        try:
            chunk = self.port.read()
        except PortGoneError:
            self._lose()
            return b""
        except SourceEndedError:
            self.close()
            self.is_over = True
            self._on_event("source_end", port=self.name)
            return b""
        except OSError as error:
            raise LinkError(f"{self.name}: cannot be read: {error.strerror or error}") from error
        self._report_notes(self.port)
        if chunk:
            self.opening.hear(self._monotonic())
        else:
            self.opening.wait(self.port, self._monotonic())
        return chunk

    def understood(self, now_s: float) -> None:
        """The device has sent samples."""
        self._heard_s = now_s
        self.opening.end()
        if self.port is not None:
            self.port.understood()

    def silent_s(self) -> float:
        """Time since the last sample, s."""
        return self._monotonic() - self._heard_s

    def next_baud(self) -> None:
        """Set the next of the usual baud rates."""
        self.baud = next(self._bauds)
        try:
            if self.port is not None:
                self.port.set_baud(self.baud)
                self.opening.begin(self.port, self._monotonic())
        except PortGoneError:
            self._lose()

    def line(self) -> dict[str, int]:
        """Field `baud` of events, for a line that has one."""
        return {"baud": self.baud} if self.has_baud else {}

    def close(self) -> None:
        """Close the port."""
        if self._reopening is not None:
            self._reopening.abandon()
            self._reopening = None
        if self.port is not None:
            self.port.close()
            self.port = None

    def _first_open(self) -> SourcePort | None:
        """Open the port; None for a source that is tried again, because a link without timeout waits for it."""
        is_waited_for = self._options.waits or (self.source is not None and not self._options.timeout_s)
        try:
            if self.source is not None:
                return self._open_soon(SOON_S if is_waited_for else None)
            return open_port(self.name, self.baud)
        except LinkError as error:
            if not is_waited_for:
                raise
            self._refuse(error)
            self._backoff.begin(self._monotonic())
            return None

    def _open_soon(self, most_s: float | None) -> SourcePort | None:
        """Open a source; None if it takes longer, so that other gyros do not wait for it.

        A thread of its own looks up names, so that a signal to stop ends the wait.
        """
        self._reopening = opening = self._background_opening()
        opening.wait(most_s)
        try:
            port = opening.result()
        except LinkError:
            self._reopening = None
            raise
        self._reopening = opening if port is None else None
        return port

    def _reopen(self) -> None:
        now_s = self._monotonic()
        if self._reopening is None and self._backoff.remaining_s(now_s):
            return
        try:
            self.port = self._reopened()
        except (LinkError, UsageError) as error:  # an adapter refuses its line rate while it is being plugged in
            self._reopening = None
            self._backoff.fail(now_s)
            self._refuse(error)
            return
        if self.port is None:
            return
        self._reopening = None
        self.refusal = ""
        if self.was_open:
            self._come_back(now_s)
        else:
            self._report_open()
        self.opening.begin(self.port, now_s)

    def _reopened(self) -> SourcePort | None:
        """The port again; None while a source is being opened in the background."""
        if self.source is None:
            return open_port(self.name, self.baud)
        if self._reopening is None:
            self._reopening = self._background_opening()
        return self._reopening.result()

    def _background_opening(self) -> BackgroundOpening:
        name, baud = self.name, self.baud
        return BackgroundOpening(lambda: open_port(name, baud))

    def _report_open(self) -> None:
        self.was_open = True
        self._on_event("link_open", port=self.name, **self.line(), protocol=self._options.protocol)

    def _refuse(self, error: Exception) -> None:
        """Report why the port cannot be opened, and once that it is missing; a reason is not repeated."""
        reason = str(error)
        is_known = isinstance(error, PortMissingError) and (self.was_open or self._is_refused)
        if not is_known and reason != self.refusal:
            self._on_event("link_refused", port=self.name, reason=reason)
        self._is_refused, self.refusal = True, reason

    def _report_notes(self, port: SourcePort) -> None:
        for event, fields in port.notes:
            self._on_event(event, port=self.name, **fields)
        port.notes.clear()

    def _lose(self) -> None:
        if self.port is not None:
            self._report_notes(self.port)
        self.close()
        if self._heard_s < self._back_s:  # a peer that accepts and closes would be called 20 times a second
            self._backoff.fail(self._monotonic())
        else:
            self._backoff.begin(self._monotonic())
        self._on_event("link_lost", port=self.name)

    def _come_back(self, now_s: float) -> None:
        gone_s = now_s - self._heard_s
        self._counters.reconnects += 1
        self._counters.gone_s += now_s - max(self._heard_s, self._back_s)
        self._back_s = now_s
        self._on_return()
        self._on_event("link_restored", port=self.name, gone_s=round(gone_s, 3))
