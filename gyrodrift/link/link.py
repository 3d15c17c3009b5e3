"""Link to a device: port or source, protocol and clock. `serve` and `record` read samples from it.

One thread drives it: wait until `fileno()` is readable or `wake_s()` has passed, then call `read()`. The link finds the
baud rate and the protocol, and reopens the port under its stable name after it was unplugged. It reports through link
events and `LinkCounters`, separately from the samples.
"""

import time
from collections.abc import Callable
from dataclasses import replace
from math import isnan
from typing import Any

from gyrodrift.link.binary_frames import binary_frames
from gyrodrift.link.clocks.arrival import ArrivalClock
from gyrodrift.link.clocks.clock import CLOCK_SET, Calendar, Clock, ClockRestart, SampleGap
from gyrodrift.link.clocks.device import DeviceClock
from gyrodrift.link.connection import Connection
from gyrodrift.link.decoding import Decoding
from gyrodrift.link.heard import Heard
from gyrodrift.link.options import EventHandler, LinkCounters, LinkOptions
from gyrodrift.link.protocols.batch import ReadingBatch
from gyrodrift.link.protocols.decoder import Decoder, DeviceDescription
from gyrodrift.link.silence import unread_protocol, why_silent
from gyrodrift.link.sources.source import SourcePort
from gyrodrift.link.turn_queue import Arrived, TurnQueue
from gyrodrift.link.unit_check import UnitCheck
from gyrodrift.values.errors import DeviceSilentError, PortMissingError, UnitError
from gyrodrift.values.sample import Reading, Sample

BAUD_TRIAL_S = 0.8
BAUD_TRIAL_WARM_S = 4.0
"""Time for which `--baud auto` listens at a baud rate with bytes, s; the longer one after the first good frame."""

TELL_S = 10.0
"""Time after which a link without timeout reports why it understands nothing, s."""


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
        port: SourcePort | None = None,
    ) -> None:
        self.options = options
        self.counters = LinkCounters()
        self.connection = Connection(options, self.counters, on_event, self._renew, monotonic)
        self.source, self.name = self.connection.source, self.connection.name
        has_known_baud = options.baud is not None or not self.connection.has_baud
        protocol = self.source.protocol if self.source is not None else None
        self._decoding = Decoding(options, protocol, on_event, has_known_baud=has_known_baud)
        self.clock: Clock | None = None
        self.tap: Callable[[bytes, float], Any] | None = None
        self._on_event = on_event
        self._monotonic = monotonic
        self._calendar = Calendar(monotonic)
        self._queue = TurnQueue()
        self._spoke = False
        self._heard = Heard()
        self._check: UnitCheck | None = None
        self._is_told = False
        self._is_angle_told = False
        self._trial_s: float | None = None
        self.connection.begin(port)

    @property
    def decoder(self) -> Decoder | None:
        """Decoder of the bytes; None until it is found."""
        return self._decoding.decoder

    @property
    def device(self) -> DeviceDescription:
        """Description of the device by itself; empty without one."""
        return self._decoding.device

    @property
    def port(self) -> SourcePort | None:
        """The open port; None while it is gone."""
        return self.connection.port

    @property
    def baud(self) -> int:
        """Baud rate in use; 0 for a source without one."""
        return self.connection.baud

    @property
    def is_over(self) -> bool:
        """Whether the source has ended."""
        return self.connection.is_over

    def fileno(self) -> int | None:
        """File descriptor to wait on; None while the port is gone."""
        return self.port.fd if self.port else None

    def wake_s(self) -> float:
        """Longest time to wait before the next `read`, s."""
        return self.connection.wake_s(1.0 if self._spoke else 0.1) if self._is_idle else 0.0

    def share_turn(self, sources: int) -> None:
        """Share the budget of a turn with the other sources of a loop."""
        self._queue.share(sources)

    def read(self) -> list[Sample]:
        """Samples that have arrived, within the budget of a turn; empty without any.

        Raises
        ------
        LinkError
            As in the class, or the source has an error that no other attempt repairs.
        """
        until_s = self._monotonic() + self._queue.turn_s
        samples: list[Sample] = []
        if not self._queue.has_samples:
            if self._is_idle and not self._receive():
                self._give_up_waiting()
                return samples
            if self._decode_until(until_s):
                samples = self._stamped(self._queue.take_readings(), self._queue.arrival_s)
        samples = self._queue.within_budget(samples)
        self.counters.samples += len(samples)
        return samples

    def counted(self) -> dict[str, Any]:
        """All counters since the link was opened, by their names in the log, and the clock drift."""
        decoder, ppm = self.decoder, self.clock.drift_ppm if self.clock else None
        return {
            "samples": self.counters.samples,
            "bytes": self.counters.bytes,
            "damaged": decoder.counters.damaged if decoder else 0,
            "before_hello": decoder.counters.before_hello if decoder else 0,
            "clipped": max(decoder.counters.clipped if decoder else 0, self.counters.clipped),
            "impossible": self.counters.impossible,
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
        self._decoding.follow_columns(columns)

    def send_at_opening(self, content: bytes) -> None:
        """Send these bytes after the next opening of the port."""
        self.connection.opening.content = content

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
        return self.connection.silent_s()

    def close(self) -> None:
        """Close the port."""
        self.connection.close()

    def hand_over(self) -> SourcePort | None:
        """The open port, for another link; this link is over."""
        port, self.connection.port = self.port, None
        return port

    @property
    def _is_idle(self) -> bool:
        """Whether all that was read is decoded and handed over."""
        return self._queue.is_empty and not self._decoding.is_behind

    def _receive(self) -> bool:
        """Read the connection; False if nothing has arrived."""
        received = self.connection.read()
        if not received:
            return False
        chunk = received.content if isinstance(received, ReadingBatch) else received
        arrival_s = self._monotonic()
        self.counters.bytes += len(chunk)
        if not self._spoke and self.port is not None:
            self._decoding.turn_to(self.port.stream)
        if self.tap is not None:
            self.tap(chunk, self._calendar.epoch_s + arrival_s)
        self._trial_s = self._trial_s or arrival_s
        if not self._spoke or (self._check is not None and self._check.is_hearing):
            self._heard.add(chunk, arrival_s)
        self._queue.add(received, arrival_s)
        return True

    def _decode_until(self, until_s: float) -> bool:
        """Decode what was read, until a time; whether all of it, or as much as a turn may have, is decoded.

        The readings of a read stay together, because a clock by arrival counts them.
        """
        queue = self._queue
        while True:
            queue.readings += self._decoding.push(queue.next_piece(), self.counters.bytes, self.connection.line())
            if not queue.has_pieces and (not self._decoding.is_behind or len(queue.readings) >= queue.turn_samples):
                return True
            if self._monotonic() >= until_s:
                return not queue.has_pieces

    def _stamped(self, readings: list[Reading], arrival_s: float) -> list[Sample]:
        """Samples of the readings of a read."""
        arrived = self._decoding.by_arrival(readings, arrival_s)
        if not arrived or self.decoder is None:
            if not self._spoke:
                self._give_up_waiting()
            return []
        samples = self._stamp(self.decoder, arrived)
        self._spoke = True
        self._decoding.keep_sender()
        self.connection.understood(arrival_s)
        if self._check is not None:
            self._check_units(self._check, len(readings), samples, arrival_s)
        return samples

    def _stamp(self, decoder: Decoder, arrived: list[Arrived]) -> list[Sample]:
        first = arrived[0][1][0]
        is_angle, is_delta = not isnan(first.yaw_deg), not isnan(first.delta_deg)
        if self.clock is None:
            protocol = self._decoding.protocol_of(decoder)
            has_clock = protocol.has_clock and first.t_us is not None
            if not protocol.has_unit:
                self._check = UnitCheck(
                    replace(protocol, sends_angle=is_angle),
                    self._heard,
                    self._on_event,
                    self.options.port,
                    has_clock=has_clock,
                    keeps_on=self.options.keeps_on,
                )
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
        if is_angle or is_delta:  # the first angle gives no rate
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

    def _renew(self) -> None:
        """Prepare for bytes after a break."""
        self._decoding.renew()
        if self.clock is not None:
            self.clock.reconnected()

    def _give_up_waiting(self) -> None:
        """Before the first sample: raise after the timeout, say what is not understood, try another baud rate."""
        if self._spoke or (self.port is None and self.source is None):
            return
        now_s, timeout_s = self._monotonic(), self.options.timeout_s
        waited_s = now_s - self.connection.opened_s
        if self.is_over:
            raise DeviceSilentError(f"{self.name}: it ended, and {self._why_silent(max(round(waited_s, 1), 0.1))}")
        if 0.0 < timeout_s <= waited_s:
            if not self.connection.was_open and self.connection.refusal:
                raise PortMissingError(f"{self.connection.refusal}; it was not there for {timeout_s:g} s")
            raise DeviceSilentError(f"{self.name}: {self._why_silent(timeout_s)}")
        if not timeout_s and not self._is_told and waited_s >= TELL_S and self.counters.bytes:
            self._is_told = True
            self._on_event("not_understood", port=self.name, reason=self._why_silent(TELL_S))
        if self.connection.has_baud and self.options.baud is None and self.decoder is None:
            self._try_next_baud(now_s)

    def _try_next_baud(self, now_s: float) -> None:
        """Go on to the next of the usual baud rates, if this one had its time and gave nothing that can be read."""
        is_slow = self._decoding.is_warm or self._heard.may_be_text
        trial_s = BAUD_TRIAL_WARM_S if is_slow else BAUD_TRIAL_S
        if self._trial_s is None or now_s - self._trial_s < trial_s:
            return
        if self._heard.is_text or self._is_another_protocol():
            self._trial_s = now_s  # the baud rate is right
            return
        self._trial_s = None
        self._decoding.restart_detection()
        self._heard = Heard()
        self.connection.next_baud()

    def _is_another_protocol(self) -> bool:
        """Whether the bytes are a known protocol, or frames with checksums, that is not read here."""
        if unread_protocol(self._heard, self._decoding.chosen_protocol):
            return True
        frames = binary_frames(self._heard.content)
        return frames is not None and frames.is_checked

    def _why_silent(self, waited_s: float) -> str:
        baud, heard_bytes = self.options.baud, self.counters.bytes
        stream = self._decoding.chosen_protocol, self._heard, self.name, self.source, self.baud
        return why_silent(waited_s, baud, heard_bytes, self.decoder, *stream)
