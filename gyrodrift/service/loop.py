"""The loop of `serve` and `record`: wait, read, hand on, in one thread and with no hop between threads.

A signal to stop is one of the things waited for.
"""

import gc
import select
import time
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from typing import Any, Protocol

from structlog.typing import FilteringBoundLogger

from gyrodrift.link.events import News
from gyrodrift.link.link import Link
from gyrodrift.sample import Sample
from gyrodrift.service.outputs.output import ReaderGoneError
from gyrodrift.service.signals import StopSignal

CHORES_S = 0.25
STATS_S = 10.0
SILENCE_S = 5.0

FAST_PERIOD_S = 0.0005

BUSY_LINE = 0.85
BITS_PER_BYTE = 10
"""A byte on a serial line has a start and a stop bit; above BUSY_LINE of its capacity samples start to be lost."""


class Taker(Protocol):
    """What the loop hands samples on to: the filter with its sinks, a recorder, a live line; must never wait."""

    def take(self, samples: list[Sample]) -> None:
        """Take the samples that arrived together; none where something waits to be written."""
        ...

    def do_chores(self, now_s: float) -> None:
        """Do what is due a few times a second."""
        ...

    def stats(self) -> dict[str, Any]:
        """Fields for the log."""
        ...

    def close(self) -> None:
        """No more will come."""
        ...


class Output(Protocol):
    """A descriptor that somebody reads at his own pace."""

    fd: int

    @property
    def is_waiting(self) -> bool:
        """Whether something is left that the reader has not taken."""
        ...


@dataclass(slots=True)
class _Marks:
    """When which chore was done last, and what the counters said then."""

    chores_s: float = 0.0
    stats_s: float = 0.0
    stats_bytes: int = 0
    stats_samples: int = 0
    is_silent: bool = False


@dataclass(slots=True)
class Service:
    """A link and who takes its samples, run until a signal or until nobody reads any more.

    rest_s
        A stream of more than 2 kHz is read this far apart, s: where nobody waits for the samples, it costs less in
        handfuls. Arrival times are later by up to as much.
    """

    link: Link
    takers: Sequence[Taker]
    log: FilteringBoundLogger
    news: News
    stop: StopSignal
    output: Output | None = None
    rest_s: float = 0.0
    _marks: _Marks = field(default_factory=_Marks)
    _poller: select.poll = field(init=False)
    _waited_for: dict[int | None, int] = field(default_factory=dict)

    def run(self) -> None:
        """Run until the signal to stop.

        Raises
        ------
        LinkError
            Where the device never says anything that can be decoded.
        RecordingError
            Where a recording that was asked for cannot go on.
        """
        self._marks.stats_s = self._marks.chores_s = time.monotonic()
        gc.collect()
        gc.freeze()  # what start-up left behind need not be walked again while samples come in
        try:
            with ExitStack() as closing:  # each is closed, whatever the others make of it
                for taker in self.takers:
                    closing.callback(taker.close)
                self._loop()
        except ReaderGoneError:
            self.log.info("reader_gone")
        finally:
            self.link.close()
            self._log_stats("service_end", time.monotonic())

    def _loop(self) -> None:
        output = self.output
        while not self.stop.is_set:
            self._wait()
            samples = self.link.read()
            if samples or (output is not None and output.is_waiting):
                for taker in self.takers:
                    taker.take(samples)
            now_s = time.monotonic()
            if now_s - self._marks.chores_s >= CHORES_S:
                self._marks.chores_s = now_s
                self._do_chores(now_s)
            if self.rest_s and self.link.clock is not None and 0.0 < self.link.clock.period_s < FAST_PERIOD_S:
                time.sleep(self.rest_s)

    def _wait(self) -> None:
        wanted = {self.stop.fd: select.POLLIN, self.link.fileno(): select.POLLIN}
        if self.output is not None and self.output.is_waiting:
            wanted[self.output.fd] = select.POLLOUT
        if wanted != self._waited_for:
            self._poller = select.poll()
            for fd, events in wanted.items():
                if fd is not None:
                    self._poller.register(fd, events)
            self._waited_for = wanted
        self._poller.poll(min(self.link.wake_s(), CHORES_S) * 1e3)

    def _do_chores(self, now_s: float) -> None:
        self.news.report_gaps()
        for taker in self.takers:
            taker.do_chores(now_s)
        self._notice_silence()
        if now_s - self._marks.stats_s >= STATS_S:
            self._log_stats("link_stats", now_s)

    def _notice_silence(self) -> None:
        silent_s = self.link.silent_s()
        is_silent = silent_s > SILENCE_S and self.link.counters.samples > 0
        if is_silent and not self._marks.is_silent:
            self.news("link_silent", seconds=round(silent_s, 1))
        elif self._marks.is_silent and not is_silent:
            self.news("link_speaks")
        self._marks.is_silent = is_silent

    def _log_stats(self, event: str, now_s: float) -> None:
        marks, counters, decoder = self._marks, self.link.counters, self.link.decoder
        elapsed_s = max(now_s - marks.stats_s, 1e-9)
        byte_rate = (counters.bytes - marks.stats_bytes) / elapsed_s
        drift_ppm = self.link.clock.drift_ppm if self.link.clock else None
        of_takers: dict[str, Any] = {}
        for taker in self.takers:
            of_takers |= taker.stats()
        self.log.info(
            event,
            protocol=decoder.name if decoder else "unknown",
            rate_hz=round((counters.samples - marks.stats_samples) / elapsed_s, 2),
            samples=counters.samples,
            bytes=counters.bytes,
            damaged=decoder.counters.damaged if decoder else 0,
            before_hello=decoder.counters.before_hello if decoder else 0,
            clipped=decoder.counters.clipped if decoder else 0,
            gaps=counters.gaps,
            missing=counters.missing,
            device_resets=counters.restarts,
            reconnects=counters.reconnects,
            gone_s=round(counters.gone_s, 3),
            clock_ppm=None if drift_ppm is None else round(drift_ppm, 1),
            **of_takers,
        )
        marks.stats_s, marks.stats_bytes, marks.stats_samples = now_s, counters.bytes, counters.samples
        port = self.link.port
        if port is not None and not port.is_pty and byte_rate * BITS_PER_BYTE > BUSY_LINE * self.link.baud:
            share = byte_rate * BITS_PER_BYTE / self.link.baud
            self.log.warning("line_busy", share=round(share, 2), baud=self.link.baud)
