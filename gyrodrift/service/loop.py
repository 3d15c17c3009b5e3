"""The loop of `serve` and `record`: wait, read, hand samples to the listeners, all in one thread.

The loop also wakes for a signal to stop.
"""

import gc
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from math import inf, isnan, nan
from typing import TYPE_CHECKING, Any

from gyrodrift.io.logger import FilteringBoundLogger
from gyrodrift.io.waiting import POLLIN, Poller, new_poller
from gyrodrift.link.events import LinkEvents
from gyrodrift.link.link import Link
from gyrodrift.service.listener import JudgedListener, ReaderGoneError, SampleListener, Sink
from gyrodrift.service.signals import StopSignal
from gyrodrift.service.stream_watch import StreamWatch
from gyrodrift.values.aid import Aid
from gyrodrift.values.constants import LINE_BITS_PER_BYTE
from gyrodrift.values.sample import Sample
from gyrodrift.values.secret import without_secrets

if TYPE_CHECKING:  # a service without control socket does not need them
    from gyrodrift.service.control import Control
    from gyrodrift.service.notify import SystemdNotify

TICK_S = 0.25
STATS_S = 10.0
SILENCE_S = 5.0

FAST_PERIOD_S = 0.0005

AIDS_MAX = 1000
"""Most measurements of second sources that wait for a sample. Chosen: those of some seconds, while a gyro is gone."""

AID_WAIT_S = 0.25
"""Longest wait of a measurement for a sample of its own time, s. Chosen: above the pauses of a link, and a device turns
little in it."""

BUSY_LINE = 0.85
"""Share of the capacity of a serial line above which samples start to be lost."""


@dataclass(slots=True)
class Statements:
    """Statements of `ctl` and other sources about the device; they join the samples before a recording and the filter.

    still
        Rest by `ctl rest`, which replaces the statement of the device: 1 rest, 0 motion, NaN no statement.
    waiting
        Measurements of second sources for the next sample, with their arrival on the monotonic clock, s.
    """

    still: float = nan
    waiting: list[tuple[float, Aid]] = field(default_factory=list)

    def take(self, aid: Aid) -> None:
        """Let a measurement wait for the next sample, unless too many wait; its time, if any, counts from now."""
        if len(self.waiting) < AIDS_MAX:
            self.waiting.append((time.monotonic(), aid))

    def joined(self, samples: list[Sample]) -> list[Sample]:
        """Samples with the stated rest, the first one with the measurements that waited."""
        still = self.still
        if not isnan(still):
            samples = [sample._replace(still=still) for sample in samples]
        if self.waiting and samples:
            first, *rest = samples
            now_s = time.monotonic()
            aids = tuple(_placed(aid, now_s - arrival_s, first.t_device_s) for arrival_s, aid in self.waiting)
            self.waiting.clear()
            samples = [first._replace(aids=first.aids + aids), *rest]
        return samples


def _placed(aid: Aid, waited_s: float, t_s: float) -> Aid:
    """A measurement on the clock of the sample that it waited for, which was measured at `t_s`."""
    earlier_s = waited_s if waited_s > AID_WAIT_S else 0.0
    if isnan(aid.t_s) and not earlier_s:
        return aid
    return aid._replace(t_s=t_s - earlier_s + (0.0 if isnan(aid.t_s) else aid.t_s))


@dataclass(slots=True)
class _Marks:
    """Times of the last periodic work, and the counters at those times."""

    tick_s: float = 0.0
    stats_s: float = 0.0
    stats_bytes: int = 0
    stats_samples: int = 0
    is_silent: bool = False


def freeze_collector() -> None:
    """Let the collector skip the objects of the start."""
    gc.collect()
    gc.freeze()


class Waiting:
    """Waits for descriptors; a poller is made again only when they change."""

    def __init__(self) -> None:
        self._poller: Poller = new_poller()
        self._events_by_fd: dict[int, int] = {}

    def ready(self, events_by_fd: dict[int, int], most_s: float) -> set[int]:
        """Descriptors with events, at the latest after `most_s`."""
        if events_by_fd != self._events_by_fd:
            self._poller = new_poller()
            for fd, events in events_by_fd.items():
                self._poller.register(fd, events)
            self._events_by_fd = events_by_fd
        return {fd for fd, _ in self._poller.poll(most_s * 1e3)}


@dataclass(slots=True)
class Service:
    """A link and the listeners of its samples, run until a signal or until the last reader is closed.

    listeners
        They get samples, and are closed, in this order: a recording comes before listeners that wait for readers.
    sinks
        Sinks of the listeners that may wait for readers: the loop wakes when one can continue.
    control
        Control socket.
    statements
        What `ctl` and other sources say, for all listeners.
    notify
        Notified when the service is ready, and with each turn of the loop.
    read_interval_s
        Time between two reads of a stream above 2 kHz, s, when nobody waits for the samples: fewer reads cost less.
        Arrival times are later by up to this time.
    end_event
        Event name of the last log line.
    is_watched
        A person sees the counters on a live line; `link_stats` is then logged at level debug.
    """

    link: Link
    listeners: Sequence[SampleListener]
    log: FilteringBoundLogger
    events: LinkEvents
    stop: StopSignal
    sinks: Sequence[Sink] = ()
    control: "Control | None" = None
    notify: "SystemdNotify | None" = None
    statements: Statements | None = None
    read_interval_s: float = 0.0
    end_event: str = "service_end"
    is_watched: bool = False
    _marks: _Marks = field(default_factory=_Marks)
    _is_waited_for: bool = False
    _watch: StreamWatch = field(init=False)
    _begun_s: float = 0.0

    def __post_init__(self) -> None:
        self._watch = StreamWatch(self.events, self.link.counters)

    def run(self) -> None:
        """Run until the signal to stop, or the end of the source.

        Raises
        ------
        LinkError
            If no frame of the device can be decoded.
        RecordingError
            If a recording fails.
        """
        self.begin()
        freeze_collector()
        try:
            if self.notify is not None:
                self.notify.ready(f"reading {without_secrets(self.link.name)}")
            with self.open_listeners():
                self._loop()
        except ReaderGoneError:
            self.log.info("reader_gone")
        finally:
            self.end()

    def begin(self) -> None:
        """Set the times of the start."""
        self._begun_s = self._marks.stats_s = self._marks.tick_s = time.monotonic()

    @contextmanager
    def open_listeners(self) -> Iterator[None]:
        """Close the listeners and report the last events at the end of the block."""
        with ExitStack() as closing:  # a failing listener does not keep the others open
            for listener in reversed(self.listeners):  # the last callback is called first
                closing.callback(listener.close)
            closing.callback(self.events.report_pending, is_end=True)
            yield

    def end(self) -> None:
        """Close the link, and log the run in one line."""
        self.link.close()
        self._log_stats(self.end_event, time.monotonic(), is_end=True)

    @property
    def is_over(self) -> bool:
        """Whether the source has ended, and its samples are written."""
        return self.link.is_over and not self._is_waited_for

    def descriptors(self) -> dict[int, int]:
        """Descriptors to wait for, with their events."""
        events_by_fd: dict[int, int] = {}
        for sink in self.sinks:
            events_by_fd |= sink.wakes()
        self._is_waited_for = bool(events_by_fd)
        link_fd = self.link.fileno()
        if link_fd is not None and not self._is_held:
            events_by_fd[link_fd] = POLLIN
        if self.control is not None:
            events_by_fd |= self.control.wakes()
        return events_by_fd

    def wake_s(self) -> float:
        """Longest time to wait for a descriptor, s."""
        return min(self.link.wake_s(), TICK_S, inf if self.control is None else self.control.wake_s())

    def turn(self, ready: set[int]) -> None:
        """Work after a wait: `ready` descriptors, samples, and periodic work that is due."""
        if self.control is not None:
            self.control.serve(ready)
        samples = [] if self._is_held else self.link.read()
        if self.statements is not None:
            samples = self.statements.joined(samples)
        judged = self._watch.take(samples)
        if samples or judged or self._is_waited_for:
            for listener in self.listeners:
                listener.take(judged if isinstance(listener, JudgedListener) else samples)
        now_s = time.monotonic()
        if now_s - self._marks.tick_s >= TICK_S:
            self._marks.tick_s = now_s
            self._tick(now_s)

    @property
    def _is_held(self) -> bool:
        """Whether a source that holds back its bytes waits for readers."""
        return self._is_waited_for and self.link.holds_back

    def _loop(self) -> None:
        waiting = Waiting()
        while not self.stop.is_set and not self.is_over:
            events_by_fd = {self.stop.fd: POLLIN} | self.descriptors()
            self.turn(waiting.ready(events_by_fd, self.wake_s()))
            if self.read_interval_s and self.link.clock is not None and 0.0 < self.link.clock.period_s < FAST_PERIOD_S:
                time.sleep(self.read_interval_s)

    def _tick(self, now_s: float) -> None:
        if self.notify is not None:
            self.notify.alive(now_s)
        self.events.report_pending()
        self.link.follow_host_clock()
        for listener in self.listeners:
            listener.tick(now_s)
        self._notice_silence()
        if now_s - self._marks.stats_s >= STATS_S:
            self._log_stats("link_stats", now_s)

    def _notice_silence(self) -> None:
        silent_s = self.link.silent_s()
        is_silent = silent_s > SILENCE_S and self.link.counters.samples > 0
        if is_silent and not self._marks.is_silent:
            self.events("link_silent", seconds=round(silent_s, 1))
        elif self._marks.is_silent and not is_silent:
            self.events("link_speaks")
        self._marks.is_silent = is_silent

    def _summary(self, of_listeners: Mapping[str, Any], now_s: float) -> str:
        """The run in one sentence, for the last line of the log."""
        counted = self.link.counted()
        lost = f"{counted['missing']} lost" + (f", {counted['damaged']} frames damaged" if counted["damaged"] else "")
        yaw = f", yaw {of_listeners['yaw_deg']:+z.2f} deg at the end" if "yaw_deg" in of_listeners else ""
        return f"{counted['samples']} samples in {now_s - self._begun_s:.1f} s, {lost}{yaw}."

    def _log_stats(self, event: str, now_s: float, *, is_end: bool = False) -> None:
        marks, counters, decoder = self._marks, self.link.counters, self.link.decoder
        elapsed_s = max(now_s - marks.stats_s, 1e-9)
        byte_rate = (counters.bytes - marks.stats_bytes) / elapsed_s
        of_listeners: dict[str, Any] = self._watch.stats()
        for listener in self.listeners:
            of_listeners |= listener.stats()
        summary = {"summary": self._summary(of_listeners, now_s)} if is_end else {}
        log = self.log.debug if self.is_watched and not is_end else self.log.info
        log(
            event,
            **summary,
            protocol=decoder.name if decoder else "unknown",
            rate_hz=round((counters.samples - marks.stats_samples) / elapsed_s, 2),
            **self.link.counted(),
            **of_listeners,
        )
        marks.stats_s, marks.stats_bytes, marks.stats_samples = now_s, counters.bytes, counters.samples
        port = self.link.port
        if port is not None and port.has_line_rate and byte_rate * LINE_BITS_PER_BYTE > BUSY_LINE * self.link.baud:
            share = byte_rate * LINE_BITS_PER_BYTE / self.link.baud
            self.log.warning("line_busy", share=round(share, 2), baud=self.link.baud)
