"""Listen to several ports at once, for protocol and sample rate.

A port that another program holds is not opened. Others are opened once, like in `serve`, and closed as soon as the
result is clear.
"""

import time
from collections.abc import Callable, Iterable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from typing import Any

from gyrodrift.io.waiting import POLLIN, new_poller
from gyrodrift.link.holder import PortHolder, holder_of
from gyrodrift.link.link import Link
from gyrodrift.link.options import LinkOptions
from gyrodrift.link.serial_port import SerialPort
from gyrodrift.link.sources.source import SourcePort
from gyrodrift.values.errors import LinkError
from gyrodrift.values.sample import Sample

USUAL_S = 10.0
"""Listening time without a timeout, s: enough for all usual baud rates."""

QUIET_S = 3.0
"""Listening time at a port without a byte, if another port sends, s; boards boot within 2 s after a reset."""

RATE_S = 0.6
RATE_LONGEST_S = 2.0
"""Time over which samples are counted, on the clock of the device, and longest wait for a slow device, s."""

TURN_S = 0.1


@dataclass(frozen=True, slots=True)
class Speech:
    """Result of listening to a port; `rate_hz` is None with too few samples, `baud` 0 for a source without."""

    protocol: str
    baud: int
    rate_hz: float | None
    device_id: str | None


@dataclass(frozen=True, slots=True)
class HeardPort:
    """Port with its holder and its speech; `reason` says why nothing was understood, or is empty.

    The caller must close `open_port`; it is None unless requested and something was understood.
    """

    port: SerialPort
    holder: PortHolder | None = None
    speech: Speech | None = None
    reason: str = ""
    open_port: SourcePort | None = None


def look_at(ports: Sequence[SerialPort]) -> list[HeardPort]:
    """Ports with their holders; no port is opened."""
    return [HeardPort(port, holder_of(port.device)) for port in ports]


def listen_at(
    ports: Sequence[SerialPort],
    options: LinkOptions,
    *,
    keeps_speakers: bool = False,
    monotonic: Callable[[], float] = time.monotonic,
) -> list[HeardPort]:
    """Listen to all ports; results in the same order.

    Parameters
    ----------
    options
        Baud rate, protocol and timeout of every link; its port is ignored.
    keeps_speakers
        Keep ports open at which something was understood: opening them again would reset many boards.
    """
    wait_s = options.timeout_s if options.timeout_s > 0.0 else USUAL_S
    with ExitStack() as closing:
        trials = [_Trial(looked, replace(options, timeout_s=wait_s), monotonic) for looked in look_at(ports)]
        for trial in trials:
            closing.callback(trial.close)
        while listening := [trial for trial in trials if not trial.is_over]:
            _wait(listening)
            for trial in trials if keeps_speakers else listening:  # unread bytes would fill the buffer of the port
                trial.read()
            is_any_heard = any(trial.samples for trial in trials)
            for trial in listening:
                trial.judge(is_any_heard=is_any_heard)
            if not keeps_speakers:
                _close(trial for trial in trials if trial.is_over)
        return [trial.result(keeps_port=keeps_speakers) for trial in trials]


class _Trial:
    """Port on trial."""

    def __init__(self, looked: HeardPort, options: LinkOptions, monotonic: Callable[[], float]) -> None:
        self.samples: list[Sample] = []
        self.link: Link | None = None
        self._looked = looked
        self._monotonic = monotonic
        self._opened_s = monotonic()
        self._spoke_s = 0.0
        self._reason = f"in use by {looked.holder}" if looked.holder else ""
        self.is_over = bool(self._reason)
        if not self.is_over:
            self._try(lambda: self._open(replace(options, port=looked.port.name)))

    def read(self) -> None:
        """Read available samples."""
        self._try(self._read)

    def judge(self, *, is_any_heard: bool) -> None:
        """End the trial if there are enough samples, or waiting is useless."""
        link, now_s = self.link, self._monotonic()
        if link is None or self.is_over:
            return
        if self.samples:
            span_s = self.samples[-1].t_device_s - self.samples[0].t_device_s
            self.is_over = span_s >= RATE_S or now_s - self._spoke_s >= RATE_LONGEST_S
        elif is_any_heard and not link.counters.bytes and now_s - self._opened_s >= QUIET_S:
            self._fail(f"sent nothing within {QUIET_S:g} s, while another port did")

    def result(self, *, keeps_port: bool) -> HeardPort:
        """Result of the trial."""
        link = self.link
        if link is None or link.decoder is None or self._reason:
            return replace(self._looked, reason=self._reason)
        device_id = link.device.device_id
        speech = Speech(link.decoder.name, link.baud, self._rate_hz(), None if device_id is None else str(device_id))
        return replace(self._looked, speech=speech, open_port=link.hand_over() if keeps_port else None)

    def close(self) -> None:
        """Close the port, unless it was handed over."""
        if self.link is not None:
            self.link.close()

    def _open(self, options: LinkOptions) -> None:
        self.link = Link(options, _ignore_event, self._monotonic)

    def _read(self) -> None:
        if self.link is None:
            return
        samples = self.link.read()
        if samples and not self.samples:
            self._spoke_s = self._monotonic()
        self.samples += samples
        if self.link.is_over:
            self.is_over = True
        elif self.link.port is None:
            self._fail("it was unplugged during the search")

    def _try(self, act: Callable[[], Any]) -> None:
        try:
            act()
        except LinkError as error:
            self._fail(str(error).removeprefix(f"{self._looked.port.name}: "))

    def _fail(self, reason: str) -> None:
        self._reason, self.is_over = reason, True
        self.close()
        self.link = None

    def _rate_hz(self) -> float | None:
        first, last = (self.samples[0], self.samples[-1]) if self.samples else (None, None)
        if first is None or last is None or last.t_device_s <= first.t_device_s:
            return None
        return (last.seq - first.seq) / (last.t_device_s - first.t_device_s)


def _close(trials: Iterable[_Trial]) -> None:
    for trial in trials:
        trial.close()


def _wait(trials: Iterable[_Trial]) -> None:
    poller = new_poller()
    for trial in trials:
        fd = trial.link.fileno() if trial.link is not None else None
        if fd is not None:
            poller.register(fd, POLLIN)
    poller.poll(TURN_S * 1e3)


def _ignore_event(event: str, **fields: Any) -> None:
    """Ignore the events of a link on trial."""
    _ = event, fields
