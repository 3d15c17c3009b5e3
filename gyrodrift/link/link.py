"""Link to a device: port or source, protocol and clock. `serve` and `record` read samples from it.

One thread drives it: wait until `fileno()` is readable or `wake_s()` has passed, then call `read()`. The link finds the
baud rate and the protocol, and reopens the port under its stable name after it was unplugged. It reports through link
events and `LinkCounters`, separately from the samples.
"""

import time
from collections.abc import Callable
from dataclasses import replace
from itertools import cycle
from math import isnan
from typing import Any

from gyrodrift.errors import DeviceSilentError, LinkError, PortMissingError, UnitError, UsageError
from gyrodrift.link.backoff import Backoff
from gyrodrift.link.calendar import CLOCK_SET, Calendar
from gyrodrift.link.clocks.arrival import ArrivalClock
from gyrodrift.link.clocks.clock import Clock, ClockRestart, SampleGap
from gyrodrift.link.clocks.device import DeviceClock
from gyrodrift.link.heard import Heard
from gyrodrift.link.late import Arrived, LateArrivals
from gyrodrift.link.opening import Opening
from gyrodrift.link.options import EventHandler, LinkCounters, LinkOptions
from gyrodrift.link.port import HAS_TERMIOS, USUAL_BAUDS, Port, PortGoneError, stable_name
from gyrodrift.link.protocols import text
from gyrodrift.link.protocols.decoder import Decoder, DeviceDescription
from gyrodrift.link.protocols.detect import Detector
from gyrodrift.link.protocols.guard import Guard, renewed
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.link.protocols.registry import candidates
from gyrodrift.link.silence import unread_protocol, why_silent
from gyrodrift.link.sources.opening import BackgroundOpening, checked_source, open_source
from gyrodrift.link.sources.source import OpenPort, SourceEndedError, SourcePort
from gyrodrift.link.units.check import UnitCheck
from gyrodrift.sample import Reading, Sample

BAUD_TRIAL_S = 0.8
BAUD_TRIAL_WARM_S = 4.0
"""Time for which `--baud auto` listens at a baud rate with bytes, s; the longer one after the first good frame."""

TELL_S = 10.0
"""Time after which a link without timeout reports why it understands nothing, s."""

SOON_S = 0.5
"""Longest wait at the start for a source that may come later, s: an answer or a refusal of a near host is faster."""

OPENING_S = 0.05
"""Time between two looks at a source that is being opened in the background, s."""


def open_port(path: str, baud: int) -> OpenPort:
    """Open a source, or a serial port in the way that this system has.

    Raises
    ------
    UsageError
        The address of a source has a mistake, or a package is missing.
    LinkError
        If the port cannot be opened.
    """
    source = open_source(path, baud)
    if source is not None:
        return source
    if HAS_TERMIOS:
        return Port(path, baud)
    from gyrodrift.link.thread_port import ThreadPort  # noqa: PLC0415 - Linux and macOS do without

    return ThreadPort(path, baud)


class Link:
    """Samples of a device on a serial port or a source; the function `tap` gets all bytes with their Unix time.

    `port` is an open port with the name and baud rate of the options; None to open it. A source that cannot be opened
    is tried again if `timeout_s` is 0. After the end of a source `is_over` is True.

    Raises
    ------
    UsageError
        From the constructor: the protocol does not exist, its columns or the address have a mistake.
    LinkError
        From the constructor: the port cannot be opened. From `read`: no sample within `timeout_s`, or the first seconds
        show that the clock or the rate has another unit. The link survives later silence and unplugging.
    """

    def __init__(
        self,
        options: LinkOptions,
        on_event: EventHandler,
        monotonic: Callable[[], float] = time.monotonic,
        port: OpenPort | None = None,
    ) -> None:
        self.options = options
        self.source = checked_source(options)
        self.name = stable_name(options.port) if self.source is None else options.port
        self.is_over = False
        self.counters = LinkCounters()
        self.decoder: Decoder | None = None
        self.clock: Clock | None = None
        self.tap: Callable[[bytes, float], Any] | None = None
        self._on_event = on_event
        self._monotonic = monotonic
        self._calendar = Calendar(monotonic)
        self._protocols = {protocol.name: protocol for protocol in self._candidates()}
        self._columns = options.columns
        self._guard = Guard(on_event)
        self._passed_over: frozenset[str] = frozenset()
        self._late = LateArrivals()
        self._detector = Detector(list(self._protocols.values()), self._guard)
        self._has_baud = self.source is None or self.source.has_baud
        if len(self._protocols) == 1 and (options.baud is not None or not self._has_baud):
            self.decoder = next(iter(self._protocols.values())).decoder()
        self._bauds = cycle(USUAL_BAUDS)
        self.baud = options.baud or (next(self._bauds) if self._has_baud else 0)
        self.device = DeviceDescription()
        self._spoke = False
        self._heard = Heard()
        self._check: UnitCheck | None = None
        self._is_told = False
        self._is_angle_told = False
        self._opened_s = self._heard_s = self._back_s = monotonic()
        self._trial_s: float | None = None
        self._backoff = Backoff()
        self._reopening: BackgroundOpening | None = None
        self._opening = Opening(options.send, on_event)
        self._was_open = self._is_refused = False
        self._refusal = ""
        self.port: OpenPort | None = port or self._first_open()
        self._was_open = self.port is not None
        if self.port is not None:
            self._on_event("link_open", port=self.name, **self._line(), protocol=options.protocol)
        if port is None and self.port is not None:
            self._opening.begin(self.port, self._opened_s)

    def fileno(self) -> int | None:
        """File descriptor to wait on; None while the port is gone."""
        return self.port.fd if self.port else None

    def wake_s(self) -> float:
        """Longest time to wait before the next `read`, s."""
        now_s = self._monotonic()
        if self.is_over:
            return 1.0
        if self.port is None:
            return self._backoff.remaining_s(now_s) if self._reopening is None else OPENING_S
        usual_s = 0.1 if not self._spoke else 1.0
        return min(usual_s, self.port.wake_s) if isinstance(self.port, SourcePort) else usual_s

    def read(self) -> list[Sample]:
        """Samples that have arrived; empty without any."""
        chunk = self._received()
        if not chunk:
            return []
        arrival_s = self._monotonic()
        self._opening.hear(arrival_s)
        self.counters.bytes += len(chunk)
        if self.tap is not None:
            self.tap(chunk, self._calendar.epoch_s + arrival_s)
        self._trial_s = self._trial_s or arrival_s
        if not self._spoke or (self._check is not None and self._check.is_hearing):
            self._heard.add(chunk, arrival_s)
        readings = self._decode(chunk)
        samples: list[Sample] = []
        arrived = self._late.by_arrival(self.decoder.counters, readings, arrival_s) if self.decoder is not None else []
        if arrived and self.decoder is not None:
            samples = self._stamp(self.decoder, arrived)
            self._heard_s = arrival_s
            self._spoke = True
            self._opening.end()
            if self._check is not None:
                self._check_units(self._check, len(readings), samples, arrival_s)
        elif not self._spoke:
            self._give_up_waiting()
        self.counters.samples += len(samples)
        return samples

    def _received(self) -> bytes:
        """Bytes that have arrived; reopens a lost port."""
        if self.port is None and not self.is_over:
            self._reopen()
        if self.port is None:
            if self.source is not None:
                self._give_up_waiting()
            return b""
        try:
            chunk = self.port.read()
        except PortGoneError:
            self._lose()
            return b""
        except SourceEndedError:
            self._end()
            return b""
        if isinstance(self.port, SourcePort):
            self._report_notes(self.port)
        if not chunk:
            self._opening.wait(self.port, self._monotonic())
            self._give_up_waiting()
        return chunk

    def counted(self) -> dict[str, Any]:
        """All counters since the link was opened, by their names in the log, and the clock drift."""
        decoder, ppm = self.decoder, self.clock.drift_ppm if self.clock else None
        return {
            "samples": self.counters.samples,
            "bytes": self.counters.bytes,
            "damaged": decoder.counters.damaged if decoder else 0,
            "before_hello": decoder.counters.before_hello if decoder else 0,
            "clipped": decoder.counters.clipped if decoder else 0,
            **({"lone_yaws": decoder.counters.lone_yaws} if decoder and decoder.counters.lone_yaws else {}),
            "gaps": self.counters.gaps,
            "missing": self.counters.missing,
            "device_resets": self.counters.device_resets,
            "reconnects": self.counters.reconnects,
            "gone_s": round(self.counters.gone_s, 3),
            "clock_ppm": None if ppm is None else round(ppm, 1),
        }

    def follow_columns(self, columns: str | None) -> None:
        """Read text with other columns from now on, without losing a line; an event reports if that is impossible."""
        if columns == self._columns:
            return
        self._columns = columns
        if columns is None or self.decoder is None or self.decoder.name != text.NAME:
            self._on_event("columns_kept", reason="the device does not send text; restart to apply them")
            return
        protocol = text.text_protocol(columns)
        if protocol.has_clock != self._protocols[text.NAME].has_clock:
            self._on_event("columns_kept", reason="they add or remove the clock; restart to apply them")
            return
        text.read_by(self.decoder, columns)
        self._protocols = {text.NAME: protocol}

    def send_at_opening(self, content: bytes) -> None:
        """Send these bytes after the next opening of the port."""
        self._opening.content = content

    def unix_s(self) -> float:
        """Present Unix time, on the clock of sample arrivals, s."""
        return self._calendar.unix_s()

    def follow_host_clock(self) -> None:
        """Report a step of the host clock, and use its new time for arrivals."""
        step_s = self._calendar.step_s()
        if step_s:
            self._on_event(CLOCK_SET, seconds=round(step_s, 3))
            self._calendar.follow()
            if self.clock is not None:
                self.clock.epoch_s = self._calendar.epoch_s

    @property
    def holds_back(self) -> bool:
        """Whether bytes that are not read wait, and are not lost."""
        return self.source is not None and self.source.holds_back

    def silent_s(self) -> float:
        """Time since the last sample, s."""
        return self._monotonic() - self._heard_s

    def close(self) -> None:
        """Close the port."""
        if self._reopening is not None:
            self._reopening.abandon()
            self._reopening = None
        if self.port is not None:
            self.port.close()
            self.port = None

    def hand_over(self) -> OpenPort | None:
        """The open port, for another link; this link is over."""
        port, self.port = self.port, None
        return port

    def _decode(self, chunk: bytes) -> list[Reading]:
        if self.decoder is not None:
            self.decoder, readings = self._guard.push(self._protocols[self.decoder.name], self.decoder, chunk)
        else:
            detected = self._detector.push(chunk)
            if detected is None:
                return []
            self.decoder, readings = detected
            self._on_event("protocol_found", protocol=self.decoder.name, **self._line())
        if self.decoder.device is not self.device:
            self._meet(self.decoder.device)
        if self.decoder.counters.passed_over != self._passed_over:
            self._passed_over = self.decoder.counters.passed_over
            hint = self._protocols[self.decoder.name].choice_hint
            self._on_event("talkers_passed_over", names=", ".join(sorted(self._passed_over)), hint=hint)
        return readings

    def _meet(self, device: DeviceDescription) -> None:
        if device != self.device and device.device_id is not None:
            self._on_event(
                "device",
                device_id=device.device_id,
                sample_rate_hz=device.sample_rate_hz,
                dps_per_lsb=device.dps_per_lsb,
                encoder_cpr=device.encoder_cpr,
                **({"device_filter": device.device_filter} if device.device_filter else {}),
            )
        self.device = device

    def _stamp(self, decoder: Decoder, arrived: list[Arrived]) -> list[Sample]:
        first = arrived[0][1][0]
        is_angle = not isnan(first.yaw_deg)
        if self.clock is None:
            protocol = self._protocols[decoder.name]
            has_clock = protocol.has_clock and first.t_us is not None
            if not protocol.has_unit:
                self._check = UnitCheck(replace(protocol, sends_angle=is_angle), has_clock, self._heard, self._on_event)
            if has_clock:
                self.clock = DeviceClock(self._calendar.epoch_s)
            else:
                self.clock = ArrivalClock(self._calendar.epoch_s)
                self._on_event("no_device_clock", timing="regression of arrival times")
        if is_angle and not self._is_angle_told:
            self._is_angle_told = True
            self._on_event("rate_from_angle", note="the device sends an angle, which its own filter has processed")
        samples: list[Sample] = []
        for arrival_s, readings in arrived:
            samples += self.clock.stamp(readings, arrival_s)
        if self.clock.events:
            self._report_clock_events(self.clock)
        if is_angle:  # the first angle gives no rate
            samples = [sample for sample in samples if not isnan(sample.rate_dps)]
        return samples

    def _check_units(self, check: UnitCheck, readings: int, samples: list[Sample], arrival_s: float) -> None:
        if self.clock is None:
            return
        try:
            check.take(readings, samples, arrival_s, self.clock)
        except UnitError as error:
            raise UnitError(f"{self.name}: {error}") from error
        if check.is_over:
            self._check = None

    def _report_clock_events(self, clock: Clock) -> None:
        for event in clock.events:
            match event:
                case SampleGap(missing, seconds):
                    self.counters.gaps += 1
                    self.counters.missing += missing
                    self._on_event("gap", missing=missing, seconds=round(seconds, 6))
                case ClockRestart(step_s, silent_s):
                    self.counters.device_resets += 1
                    self._on_event("device_reset", clock_step_s=round(step_s, 6), gone_s=round(silent_s, 3))
        clock.events.clear()

    def _candidates(self) -> list[WireProtocol]:
        """Protocols to detect; a source may have its own."""
        if self.source is not None and self.source.protocol is not None:
            return [self.source.protocol]
        return candidates(self.options.protocol, self.options.columns)

    def _line(self) -> dict[str, int]:
        """Field `baud` of events, for a line that has one."""
        return {"baud": self.baud} if self._has_baud else {}

    def _first_open(self) -> OpenPort | None:
        """Open the port; None for a source that is tried again, because a link without timeout waits for it."""
        is_waited_for = self.options.waits or (self.source is not None and not self.options.timeout_s)
        try:
            if is_waited_for and self.source is not None:
                return self._open_soon()
            return open_port(self.name, self.baud)
        except LinkError as error:
            if not is_waited_for:
                raise
            self._refuse(error)
            self._backoff.begin(self._monotonic())
            return None

    def _open_soon(self) -> OpenPort | None:
        """Open a source; None if it takes longer than SOON_S, so that other gyros do not wait for it."""
        self._reopening = opening = self._background_opening()
        opening.wait(SOON_S)
        try:
            port = opening.result()
        except LinkError:
            self._reopening = None
            raise
        self._reopening = opening if port is None else None
        return port

    def _refuse(self, error: Exception) -> None:
        """Report why the port cannot be opened, and once that it is missing; a reason is not repeated."""
        reason = str(error)
        is_known = isinstance(error, PortMissingError) and (self._was_open or self._is_refused)
        if not is_known and reason != self._refusal:
            self._on_event("link_refused", port=self.name, reason=reason)
        self._is_refused, self._refusal = True, reason

    def _report_notes(self, port: SourcePort) -> None:
        for event, fields in port.notes:
            self._on_event(event, port=self.name, **fields)
        port.notes.clear()

    def _end(self) -> None:
        """Handle the end of a source that does not come back."""
        self.close()
        self.is_over = True
        self._on_event("source_end", port=self.name)
        if not self._spoke:
            waited_s = max(round(self._monotonic() - self._opened_s, 1), 0.1)
            raise DeviceSilentError(f"{self.name}: it ended, and {self._why_silent(waited_s)}")

    def _lose(self) -> None:
        if isinstance(self.port, SourcePort):
            self._report_notes(self.port)
        self.close()
        if self._heard_s < self._back_s:  # a peer that accepts and closes would be called 20 times a second
            self._backoff.fail(self._monotonic())
        else:
            self._backoff.begin(self._monotonic())
        self._on_event("link_lost", port=self.name)

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
        self._refusal = ""
        if self._was_open:
            self._come_back(now_s)
        else:
            self._was_open = True
            self._on_event("link_open", port=self.name, **self._line(), protocol=self.options.protocol)
        self._opening.begin(self.port, now_s)

    def _reopened(self) -> OpenPort | None:
        """The port again; None while a source is being opened in the background."""
        if self.source is None:
            return open_port(self.name, self.baud)
        if self._reopening is None:
            self._reopening = self._background_opening()
        return self._reopening.result()

    def _background_opening(self) -> BackgroundOpening:
        name, baud = self.name, self.baud
        return BackgroundOpening(lambda: open_port(name, baud))

    def _come_back(self, now_s: float) -> None:
        gone_s = now_s - self._heard_s
        self.counters.reconnects += 1
        self.counters.gone_s += now_s - max(self._heard_s, self._back_s)
        self._back_s = now_s
        if self.decoder is not None:
            self.decoder = renewed(self._protocols[self.decoder.name], self.decoder)
        if self.clock is not None:
            self.clock.reconnected()
        self._on_event("link_restored", port=self.name, gone_s=round(gone_s, 3))

    def _give_up_waiting(self) -> None:
        if self._spoke or self.is_over:
            return
        now_s = self._monotonic()
        waited_s, timeout_s = now_s - self._opened_s, self.options.timeout_s
        if 0.0 < timeout_s <= waited_s:
            if not self._was_open and self._refusal:
                raise PortMissingError(f"{self._refusal}; it was not there for {timeout_s:g} s")
            raise DeviceSilentError(f"{self.name}: {self._why_silent(timeout_s)}")
        if not timeout_s and not self._is_told and waited_s >= TELL_S and self.counters.bytes:
            self._is_told = True
            self._on_event("not_understood", port=self.name, reason=self._why_silent(TELL_S))
        if self._has_baud and self.options.baud is None and self.decoder is None and self._trial_s is not None:
            is_slow = self._detector.is_warm or self._heard.may_be_text
            trial_s = BAUD_TRIAL_WARM_S if is_slow else BAUD_TRIAL_S
            if now_s - self._trial_s < trial_s:
                return
            if self._heard.is_text or unread_protocol(self._heard, self._chosen_protocol):
                self._trial_s = now_s  # the baud rate is right
            else:
                self._next_baud()

    def _why_silent(self, waited_s: float) -> str:
        baud, heard_bytes = self.options.baud, self.counters.bytes
        chosen = self._chosen_protocol
        return why_silent(waited_s, baud, heard_bytes, self.decoder, chosen, self._heard, self.name, self.source)

    @property
    def _chosen_protocol(self) -> str:
        """Protocol of the options; columns mean text."""
        return self.options.protocol if self.options.columns is None else text.NAME

    def _next_baud(self) -> None:
        """Start again at the next of the usual baud rates."""
        self.baud = next(self._bauds)
        self._trial_s = None
        self._detector = Detector(list(self._protocols.values()), self._guard)
        self._heard = Heard()
        try:
            if self.port is not None:
                self.port.set_baud(self.baud)
                self._opening.begin(self.port, self._monotonic())
        except PortGoneError:
            self._lose()
