"""The loop of `serve`: wait, read, filter, emit, in one thread and with no hop between threads.

Config changes are applied between two samples, and a signal to stop is one of the things waited for.
"""

import gc
import select
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from structlog.typing import FilteringBoundLogger

from gyrodrift.errors import ConfigError
from gyrodrift.filter import HdrCoefficients, HdrParams, HdrState, coefficients, step
from gyrodrift.link.link import Link
from gyrodrift.sample import Corrected, Sample
from gyrodrift.service.news import News
from gyrodrift.service.signals import StopSignal
from gyrodrift.service.sinks.json_lines import JsonLines, ReaderGoneError

if TYPE_CHECKING:  # the config brings its checker along, which a service without a config does without
    from gyrodrift.config import Config
    from gyrodrift.service.sinks.sink import Sink
    from gyrodrift.watch import ConfigWatch

CHORES_S = 0.25
STATS_S = 10.0
REJECTED_S = 1.0
SILENCE_S = 5.0

RATE_TOLERANCE = 0.05
"""Parameters belong to the sample rate they were tuned at; a stream that differs by more is warned of."""

BUSY_LINE = 0.85
BITS_PER_BYTE = 10
"""A byte on a serial line has a start and a stop bit; above BUSY_LINE of its capacity samples start to be lost."""


@dataclass(slots=True)
class _Marks:
    """When which chore was done last, and what the counters said then."""

    chores_s: float = 0.0
    stats_s: float = 0.0
    stats_bytes: int = 0
    stats_samples: int = 0
    rejected: int = 0
    rejected_s: float = 0.0
    is_silent: bool = False
    rate_checked: bool = False


@dataclass(slots=True)
class Service:
    """A link, the filter and the sinks, run until a signal or until nobody reads any more."""

    link: Link
    output: JsonLines
    log: FilteringBoundLogger
    news: News
    stop: StopSignal
    params: HdrParams = field(default_factory=HdrParams)
    watch: "ConfigWatch | None" = None
    more_sinks: "Sequence[Sink]" = ()
    state: HdrState = field(default_factory=HdrState)
    _marks: _Marks = field(default_factory=_Marks)
    _coefficients: HdrCoefficients = field(init=False)
    _poller: select.poll = field(init=False)
    _waited_for: dict[int | None, int] = field(default_factory=dict)

    def run(self) -> None:
        """Run until the signal to stop.

        Raises
        ------
        LinkError
            Where the device never says anything that can be decoded.
        """
        sinks: list[Sink] = [self.output, *self.more_sinks]
        self._coefficients = coefficients(self.params)
        self._marks.stats_s = self._marks.chores_s = time.monotonic()
        gc.collect()
        gc.freeze()  # what start-up left behind need not be walked again while samples come in
        try:
            self._loop(sinks)
            for sink in sinks:
                sink.close()
        except ReaderGoneError:
            self.log.info("reader_gone")
        finally:
            self.link.close()
            self._log_stats("service_end", time.monotonic())

    def _loop(self, sinks: "Sequence[Sink]") -> None:
        while not self.stop.is_set:
            self._wait()
            samples = self.link.read()
            if samples:
                self._filter(samples, sinks)
            if samples or self.output.is_waiting:
                for sink in sinks:
                    sink.flush()
            now_s = time.monotonic()
            if now_s - self._marks.chores_s >= CHORES_S:
                self._marks.chores_s = now_s
                self._do_chores(now_s)

    def _wait(self) -> None:
        wanted = {self.stop.fd: select.POLLIN, self.link.fileno(): select.POLLIN}
        if self.output.is_waiting:
            wanted[self.output.fd] = select.POLLOUT
        if wanted != self._waited_for:
            self._poller = select.poll()
            for fd, events in wanted.items():
                if fd is not None:
                    self._poller.register(fd, events)
            self._waited_for = wanted
        self._poller.poll(min(self.link.wake_s(), CHORES_S) * 1e3)

    def _filter(self, samples: list[Sample], sinks: "Sequence[Sink]") -> None:
        coefficients_now, state = self._coefficients, self.state
        for sample in samples:
            if step(coefficients_now, state, sample.t_device_s, sample.rate_dps):
                bias_dps = 0.0 - state.i_dps
                corrected = Corrected(sample, sample.rate_dps + state.i_dps, state.yaw_deg, bias_dps)
                for sink in sinks:
                    sink.on_sample(corrected)

    def _do_chores(self, now_s: float) -> None:
        marks = self._marks
        self.news.report_gaps()
        if self.watch is not None:
            self._follow_config(self.watch)
        if self.state.rejected > marks.rejected and now_s - marks.rejected_s >= REJECTED_S:
            self.log.warning("samples_rejected", count=self.state.rejected - marks.rejected, total=self.state.rejected)
            marks.rejected, marks.rejected_s = self.state.rejected, now_s
        self._notice_silence()
        if not marks.rate_checked and self.watch is not None:
            self._compare_rate(self.watch.config)
        if now_s - marks.stats_s >= STATS_S:
            self._log_stats("link_stats", now_s)

    def _follow_config(self, watch: "ConfigWatch") -> None:
        old = watch.config
        try:
            new = watch.poll()
        except ConfigError as error:
            for problem in error.problems:
                self.log.error("config_rejected", reason=problem)  # noqa: TRY400 - the reason is the message
            return
        if new is None:
            return
        self.params = new.hdr
        self._coefficients = coefficients(new.hdr)
        self._marks.rate_checked = False
        self.log.info("config_applied", file=str(watch.path), changes=new.changes_from(old))

    def _compare_rate(self, config: "Config") -> None:
        period_s = self.link.clock.period_s if self.link.clock else 0.0
        if not period_s:
            return
        self._marks.rate_checked = True
        tuned_hz = config.sample_rate_hz
        if tuned_hz is not None and abs(period_s * tuned_hz - 1.0) > RATE_TOLERANCE:
            self.log.warning(
                "sample_rate_differs",
                tuned_at_hz=tuned_hz,
                stream_hz=round(1.0 / period_s, 3),
                hint="i_c_dps and the attenuator count samples: tune at the rate of this stream",
            )

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
            rejected=self.state.rejected,
            device_resets=counters.restarts,
            reconnects=counters.reconnects,
            gone_s=round(counters.gone_s, 3),
            clock_ppm=None if drift_ppm is None else round(drift_ppm, 1),
            lines=self.output.lines,
            lines_dropped=self.output.dropped,
            yaw_deg=round(self.state.yaw_deg, 3),
            bias_dps=round(0.0 - self.state.i_dps, 5),
        )
        marks.stats_s, marks.stats_bytes, marks.stats_samples = now_s, counters.bytes, counters.samples
        port = self.link.port
        if port is not None and not port.is_pty and byte_rate * BITS_PER_BYTE > BUSY_LINE * self.link.baud:
            share = byte_rate * BITS_PER_BYTE / self.link.baud
            self.log.warning("line_busy", share=round(share, 2), baud=self.link.baud)
