"""Several gyros in one loop: each has its own link, filter and outputs, and none waits for another."""

import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from typing import TYPE_CHECKING, TypeVar

from gyrodrift.io.logger import FilteringBoundLogger
from gyrodrift.io.waiting import POLLIN
from gyrodrift.service.aid_service import AidService
from gyrodrift.service.listener import ReaderGoneError
from gyrodrift.service.loop import TICK_S, Service, Waiting, freeze_collector
from gyrodrift.service.signals import StopSignal
from gyrodrift.values.errors import GyrodriftError, LinkError
from gyrodrift.values.secret import without_secrets

if TYPE_CHECKING:  # as in the loop of one gyro
    from gyrodrift.service.notify import SystemdNotify

T = TypeVar("T")

MANY, PAUSE_S = 4, 0.001
"""Pause between two turns, s, from that number of sources on: ten sources of 1 kHz would wake the loop 10,000 times a
second. Arrival times are later by up to this time."""


class SeveralServices:
    """Services of one process, run until a signal or until all of them are over.

    A source that fails ends alone, whatever its error is.
    """

    def __init__(
        self,
        services: Sequence[Service | AidService],
        log: FilteringBoundLogger,
        stop: StopSignal,
        notify: "SystemdNotify | None" = None,
    ) -> None:
        self._running = [_Running(service) for service in services]
        self._log = log
        self._stop = stop
        self._notify = notify
        self._failed = 0

    def run(self) -> int:
        """Run, and return the exit status: that of a link if a source has failed."""
        freeze_collector()
        if self._notify is not None:
            names = ", ".join(without_secrets(running.service.link.name) for running in self._running)
            self._notify.ready(f"reading {names}")
        with ExitStack() as closing:
            for running in self._running:
                running.service.link.share_turn(len(self._running))
                closing.callback(self._alone, running, running.end)
                self._alone(running, running.begin)
            self._loop()
        return LinkError.exit_status if self._failed else 0

    def _loop(self) -> None:
        waiting = Waiting()
        while not self._stop.is_set and (running := [entry for entry in self._running if not entry.is_over]):
            events_by_fd, wake_s = {self._stop.fd: POLLIN}, TICK_S
            for entry in running:
                events_by_fd |= self._alone(entry, entry.descriptors) or {}
                wake_s = min(wake_s, entry.wake_s(time.monotonic()))
            ready = waiting.ready(events_by_fd, wake_s)
            for entry in running:
                self._alone(entry, lambda: entry.turn(ready))  # noqa: B023 - called before the next entry
            if self._notify is not None:
                self._notify.alive(time.monotonic())
            if len(running) >= MANY:
                time.sleep(PAUSE_S)

    def _alone(self, entry: "_Running", work: Callable[[], T]) -> T | None:
        """Result of the work of one source; None if it fails, which ends this source and no other."""
        try:
            return work()
        except ReaderGoneError:
            entry.service.log.info("reader_gone")
        except Exception as error:  # noqa: BLE001 - of a device, a file, a disk or a plug-in
            self._failed += 1
            reason = str(error) if isinstance(error, GyrodriftError) else f"{type(error).__name__}: {error}"
            entry.service.log.error("source_failed", reason=reason)  # noqa: TRY400 - a message for people
        if not entry.is_over:
            self._alone(entry, entry.end)
        return None


class _Running:
    """A service with its open listeners."""

    def __init__(self, service: Service | AidService) -> None:
        self.service = service
        self.is_over = False
        self._closing = ExitStack()
        self._due_s = 0.0
        self._events_by_fd: dict[int, int] = {}

    def descriptors(self) -> dict[int, int]:
        """Descriptors to wait for, with their events."""
        self._events_by_fd = self.service.descriptors()
        return self._events_by_fd

    def begin(self) -> None:
        """Begin the service; `end` then closes it."""
        self.service.begin()
        self._closing.callback(self.service.end)
        self._closing.enter_context(self.service.open_listeners())

    def turn(self, ready: set[int]) -> None:
        """One turn of the service, if it is due; the end, if its source is over."""
        if self.is_over:
            return
        if self._take_turn(ready, time.monotonic()):
            self.service.turn(ready)
        if self.service.is_over:
            self.end()

    def wake_s(self, now_s: float) -> float:
        """Time until it must have its turn, s."""
        return max(0.0, self._due_s - now_s)

    def _take_turn(self, ready: set[int], now_s: float) -> bool:
        """Set its next time if one of its descriptors is ready, or its time has come; False if it is not its turn."""
        if now_s < self._due_s and ready.isdisjoint(self._events_by_fd):
            return False
        self._due_s = now_s + self.service.wake_s()
        return True

    def end(self) -> None:
        """Close its listeners and its link."""
        if not self.is_over:
            self.is_over = True
            self._closing.close()
