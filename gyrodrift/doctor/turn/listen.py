"""Quarter turn at a port, with instructions for the user; all bytes are kept.

The link finds the line rate, and the protocol if it is a known one. Its interpretation of text is ignored.
"""

import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Any

from gyrodrift.columns.turn.motion import TurnWindow
from gyrodrift.columns.turn.series import LineTimes, TextTable
from gyrodrift.columns.turn.verdict import judge
from gyrodrift.doctor.listen import LONGEST_WAIT_S
from gyrodrift.doctor.turn.heard import HeardTurn, TurnResult, result_of, series_of
from gyrodrift.io.waiting import wait_readable
from gyrodrift.link.heard import Heard
from gyrodrift.link.link import Link
from gyrodrift.link.options import LinkOptions
from gyrodrift.link.silence import why_silent
from gyrodrift.link.sources.source import SourcePort
from gyrodrift.values.errors import DeviceSilentError, PortMissingError, UnitError
from gyrodrift.values.sample import Sample

TEXTS = frozenset({"csv", "text"})
"""Protocols of text, which have columns."""

REST_S = 3.0
LINES_MIN = 6
LONGEST_REST_S = 15.0
"""The rest lasts until a slow device has sent LINES_MIN lines, but not longer than this, s."""

TURN_S = 10.0
"""Time for the turn that the user is told, s."""

LIMIT_S = 14.0
QUIET_S = 2.5
"""Rest after the turn of a rate that ends the recording early, s; longer than a pause half-way."""

QUIET_ANGLE_S = 5.0
"""Rest after the turn of a labeled angle, s; without a label, the plateau of a rate looks like an angle."""

EARLY_S = 1.5
"""Shortest rest before a turn that came before its prompt, s."""

SILENT_S = 5.0
"""Longest gap between two reads, s; slow boards send two lines per second."""

LOOK_EVERY_S = 0.5
USUAL_TIMEOUT_S = 10.0

STILL = "Hold the device still, mounted as it will be used."
TURN = f"Turn it now: a quarter turn (90 deg) to the left within {TURN_S:g} s, then hold it still."
DONE = "Done; you may move it again."


@dataclass(slots=True)
class _Received:
    """Data received at the present line rate."""

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
        """Number of samples, or of lines with numbers."""
        return len(self.samples) or (self.table.numbered_lines if self.heard.is_text else 0)

    @property
    def last_s(self) -> float:
        """Time of the last sample or line with a number, s."""
        return self.samples[-1].t_device_s if self.samples else self.table.last_s


class TurnListener:
    """A port, from opening it to the end of the turn; `say` gets the instructions for the user.

    Raises
    ------
    LinkError
        The port cannot be opened or goes away, or no numbers arrive.
    """

    def __init__(
        self,
        options: LinkOptions,
        say: Callable[[str], None],
        monotonic: Callable[[], float] = time.monotonic,
        port: SourcePort | None = None,
    ) -> None:
        self._options = options
        self._say = say
        self._monotonic = monotonic
        self._link = Link(replace(options, timeout_s=0.0, keeps_on=True), _unheard, monotonic, port)
        self._link.tap = self._take
        self._received = _Received(baud=self._link.baud)
        self._arrived_s = monotonic()

    def listen(self) -> TurnResult:
        """Ask for a rest and for the turn, and judge the turn."""
        try:
            self._wait_for_numbers()
            self._say(STILL)
            begin_s = self._rest()
            turn_s = self._received.last_s
            self._say(TURN)
            result = self._turn(begin_s, turn_s)
            self._say(DONE)
            return result
        finally:
            self._link.close()

    def _wait_for_numbers(self) -> None:
        begun_s, timeout_s = self._monotonic(), self._options.timeout_s or USUAL_TIMEOUT_S
        while self._received.count < LINES_MIN // 2:
            self._read()
            if self._monotonic() - begun_s >= timeout_s:
                raise DeviceSilentError(f"{self._link.name}: {self._why_silent(timeout_s)}")

    def _rest(self) -> float:
        begun_s, first, begin_s = self._monotonic(), self._received.count, self._received.last_s
        while (passed_s := self._monotonic() - begun_s) < LONGEST_REST_S:
            if passed_s >= REST_S and self._received.count - first >= LINES_MIN:
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
            if self._is_quiet(heard := self._heard_turn(begin_s, turn_s)) and (result := result_of(heard)).is_found:
                return result
        result = result_of(self._heard_turn(begin_s, turn_s))
        early = result if result.is_found else result_of(self._heard_turn(begin_s, begin_s + EARLY_S))
        return early if early.is_found else result

    def _heard_turn(self, begin_s: float, turn_s: float) -> HeardTurn:
        link, received = self._link, self._received
        window = TurnWindow(begin_s, turn_s, received.last_s)
        protocol = link.decoder.name if link.decoder is not None and received.samples else ""
        return HeardTurn(link.name, window, received.table, tuple(received.samples), protocol)

    def _is_quiet(self, heard: HeardTurn) -> bool:
        """Whether a rate, or a labeled angle, has turned and rested long enough."""
        verdict = judge(series_of(heard), heard.window)
        if verdict.rate is not None:
            return heard.window.end_s - verdict.rate.motion.last_s > QUIET_S
        if verdict.angle is None or not verdict.angle.motion.series.kind:
            return False
        return heard.window.end_s - verdict.angle.reached_s > QUIET_ANGLE_S

    def _read(self) -> None:
        link = self._link
        wait_readable(link.fileno(), min(link.wake_s(), LONGEST_WAIT_S))
        samples: Sequence[Sample] = ()
        with suppress(UnitError):  # the turn finds the units
            samples = link.read()
        if link.decoder is not None and link.decoder.name not in TEXTS:
            self._received.samples += samples
        if not self._received.count:
            return
        if link.is_over:
            raise PortMissingError(f"{link.name}: the source ended during the turn")
        if link.port is None:
            raise PortMissingError(f"{link.name}: the port went away during the turn; check plug and cable")
        if self._monotonic() - self._arrived_s > SILENT_S:
            raise DeviceSilentError(f"{link.name}: the device stopped sending during the turn; is it still powered?")

    def _take(self, chunk: bytes, arrival_s: float) -> None:
        if self._link.baud != self._received.baud:  # bytes at another line rate are noise
            self._received = _Received(baud=self._link.baud)
        self._received.add(chunk, arrival_s)
        self._arrived_s = self._monotonic()

    def _why_silent(self, timeout_s: float) -> str:
        link, options, received = self._link, self._options, self._received
        if received.heard.is_text:
            text = received.heard.last_words() if received.heard.content else ""
            return (
                f"the device prints text, but no numbers within {timeout_s:g} s, such as {text[:60]!r}; is its program"
                " running? Wait longer with --timeout 30"
            )
        return why_silent(
            timeout_s,
            options.baud,
            link.counters.bytes,
            link.decoder,
            options.protocol,
            received.heard,
            link.name,
            link.source,
        )


def _unheard(event: str, **fields: Any) -> None:
    """Ignore an event of the link."""
    _ = event, fields
