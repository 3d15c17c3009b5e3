"""A quarter turn at a port, asked for sentence by sentence; bytes are kept as they come, whatever they mean.

The link finds the line rate, and a protocol where a known one is spoken; what it makes of lines is passed over.
"""

import select
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Any

from gyrodrift.doctor.turn.heard import HeardTurn, TurnResult, result_of, series_of
from gyrodrift.doctor.turn.motion import TurnWindow
from gyrodrift.doctor.turn.series import LineTimes, TextTable
from gyrodrift.doctor.turn.verdict import judged
from gyrodrift.errors import DeviceSilentError, PortMissingError, UnitError
from gyrodrift.link.heard import Heard
from gyrodrift.link.link import Link, LinkOptions
from gyrodrift.link.port import Port
from gyrodrift.link.silence import why_silent
from gyrodrift.sample import Sample

TEXTS = frozenset({"csv", "text"})
"""Protocols of lines, whose columns are what is asked for."""

REST_S = 3.0
LEAST_LINES = 6
LONGEST_REST_S = 15.0
"""A slow device is waited for until so many lines have come, but no longer."""

TURN_S = 10.0
"""What a person is told to be done within."""

LIMIT_S = 14.0
QUIET_S = 2.5
"""A rest of this length after a turn ends it early, where a rate has turned: nobody pauses for so long half way."""

QUIET_ANGLE_S = 5.0
"""The same for an angle, where a label calls it one; a plateau of a rate looks like an angle without."""

EARLY_S = 1.5
"""A rest of this length is enough for a turn that came before it was asked for."""

SILENT_S = 5.0
"""Slow boards send two lines a second."""

LOOK_EVERY_S = 0.5
USUAL_TIMEOUT_S = 10.0

STILL = "Hold the device still, lying as it will be used."
TURN = f"Turn it now: a quarter turn (90 deg) to the left within {TURN_S:g} s, then hold it still."
DONE = "Thank you; it may move again."


@dataclass(slots=True)
class _Coming:
    """What has come since the line rate is right."""

    heard: Heard = field(default_factory=Heard)
    splitter: LineTimes = field(default_factory=LineTimes)
    table: TextTable = field(default_factory=TextTable)
    samples: list[Sample] = field(default_factory=list)
    baud: int = 0

    def add(self, chunk: bytes, arrival_s: float) -> None:
        self.heard.add(chunk, arrival_s)
        for line in self.splitter.split(chunk, arrival_s):
            self.table.take(line)

    @property
    def count(self) -> int:
        """Of samples, or of lines with numbers."""
        return len(self.samples) or (self.table.numbered_lines if self.heard.is_text else 0)

    @property
    def last_s(self) -> float:
        """When the last one came, in the time of what is judged."""
        return self.samples[-1].t_device_s if self.samples else self.table.last_s


class TurnListener:
    """One port, from opening it to the end of the turn; `say` tells the person what to do.

    Raises
    ------
    LinkError
        Where the port cannot be opened or goes away, or where nothing comes that has numbers.
    """

    def __init__(
        self,
        options: LinkOptions,
        say: Callable[[str], None],
        monotonic: Callable[[], float] = time.monotonic,
        port: Port | None = None,
    ) -> None:
        self._options = options
        self._say = say
        self._monotonic = monotonic
        self._link = Link(replace(options, timeout_s=0.0), _unheard, monotonic, port)
        self._link.tap = self._take
        self._coming = _Coming(baud=self._link.baud)
        self._arrived_s = monotonic()

    def listen(self) -> TurnResult:
        """Ask for a rest and for the turn, and judge them."""
        try:
            self._wait_for_numbers()
            self._say(STILL)
            begin_s = self._rest()
            turn_s = self._coming.last_s
            self._say(TURN)
            result = self._turn(begin_s, turn_s)
            self._say(DONE)
            return result
        finally:
            self._link.close()

    def _wait_for_numbers(self) -> None:
        begun_s, timeout_s = self._monotonic(), self._options.timeout_s or USUAL_TIMEOUT_S
        while self._coming.count < LEAST_LINES // 2:
            self._read()
            if self._monotonic() - begun_s >= timeout_s:
                raise DeviceSilentError(f"{self._link.name}: {self._why_silent(timeout_s)}")

    def _rest(self) -> float:
        begun_s, first, begin_s = self._monotonic(), self._coming.count, self._coming.last_s
        while (passed_s := self._monotonic() - begun_s) < LONGEST_REST_S:
            if passed_s >= REST_S and self._coming.count - first >= LEAST_LINES:
                break
            self._read()
        return begin_s

    def _turn(self, begin_s: float, turn_s: float) -> TurnResult:
        begun_s = looked_s = self._monotonic()
        while (now_s := self._monotonic()) - begun_s < LIMIT_S:
            self._read()
            if now_s - looked_s < LOOK_EVERY_S:
                continue
            looked_s = now_s
            if self._is_quiet(heard := self._heard(begin_s, turn_s)) and (result := result_of(heard)).is_found:
                return result
        result = result_of(self._heard(begin_s, turn_s))
        early = result if result.is_found else result_of(self._heard(begin_s, begin_s + EARLY_S))
        return early if early.is_found else result

    def _heard(self, begin_s: float, turn_s: float) -> HeardTurn:
        link, coming = self._link, self._coming
        window = TurnWindow(begin_s, turn_s, coming.last_s)
        protocol = link.decoder.name if link.decoder is not None and coming.samples else ""
        return HeardTurn(link.name, window, coming.table, tuple(coming.samples), protocol)

    def _is_quiet(self, heard: HeardTurn) -> bool:
        """Whether a rate, or what is called an angle, has turned and come to rest for good."""
        verdict = judged(series_of(heard), heard.window)
        if verdict.rate is not None:
            return heard.window.end_s - verdict.rate.motion.last_s > QUIET_S
        if verdict.angle is None or not verdict.angle.motion.series.kind:
            return False
        return heard.window.end_s - verdict.angle.reached_s > QUIET_ANGLE_S

    def _read(self) -> None:
        link = self._link
        poller = select.poll()
        if (fd := link.fileno()) is not None:
            poller.register(fd, select.POLLIN)
        poller.poll(min(link.wake_s(), 0.1) * 1e3)
        samples: Sequence[Sample] = ()
        with suppress(UnitError):  # units are what the turn is for
            samples = link.read()
        if link.decoder is not None and link.decoder.name not in TEXTS:
            self._coming.samples += samples
        if not self._coming.count:
            return
        if link.port is None:
            raise PortMissingError(f"{link.name}: the port went away during the turn; look at plug and cable")
        if self._monotonic() - self._arrived_s > SILENT_S:
            raise DeviceSilentError(f"{link.name}: fell silent during the turn; is it still powered?")

    def _take(self, chunk: bytes, arrival_s: float) -> None:
        if self._link.baud != self._coming.baud:  # what came at another line rate was noise
            self._coming = _Coming(baud=self._link.baud)
        self._coming.add(chunk, arrival_s)
        self._arrived_s = self._monotonic()

    def _why_silent(self, timeout_s: float) -> str:
        link, options, coming = self._link, self._options, self._coming
        if coming.heard.is_text:
            said = coming.heard.last_words() if coming.heard.content else ""
            return (
                f"the device prints text, but no numbers within {timeout_s:g} s, such as {said[:60]!r}; is its program"
                " running? Wait longer with --timeout 30"
            )
        return why_silent(
            timeout_s, options.baud, link.counters.bytes, link.decoder, options.protocol, coming.heard, link.name
        )


def _unheard(event: str, **fields: Any) -> None:
    """What happens to the link shows in what comes."""
    _ = event, fields
