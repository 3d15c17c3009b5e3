"""NMEA 0183: `$--ROT,rate,A*hh`, the rate of turn in deg/min, negative to port. No device clock.

A sentence whose status is `V` is not valid, and is passed over like those of other kinds. Where no valid rate comes,
the heading of `HDT`, `HDM`, `HDG` or `THS` is taken in place of it, clockwise from north.

The standard lets a device leave the checksum out. Such a line is only read where a person asks for this protocol by
name, and no sentence with a checksum has come.
"""

from math import nan

from gyrodrift.link.protocols.angles import RateOrAngle
from gyrodrift.link.protocols.lines import MAX_RATE_DPS
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.link.protocols.sentences import SentenceDecoder, number_in, words_of
from gyrodrift.sample import Reading

SECONDS_PER_MINUTE = 60.0
FULL_TURN_DEG = 360.0
VALID = "A"
RATE = "ROT"
HEADINGS = frozenset({"HDT", "HDM", "HDG", "THS"})
"""True, magnetic, of the sensor itself, and true with a status (NMEA 0183, approved sentences)."""

STATUS_PLACES = {"ROT": 2, "THS": 2}
COMPLETE = {"ROT": (3, "AV"), "HDT": (3, "T"), "HDM": (3, "M"), "THS": (3, "AEMSV"), "HDG": (6, "EW")}
"""How many words a sentence has, and what stands last: without a checksum nothing else tells that it is whole."""

MOST_NAMES = 8
"""Senders that are told as passed over."""


class NmeaDecoder(SentenceDecoder):
    """Rate of turn, else heading, of one talker: of several that take turns, the first with a valid one."""

    name = "nmea"

    def __init__(self) -> None:
        super().__init__()
        self._sender = ""
        self._choice = RateOrAngle()

    def is_known(self, words: list[str]) -> bool:
        """Two letters say who talks."""
        return len(words[0]) == 5 and (words[0].endswith(RATE) or words[0][2:] in HEADINGS)

    def read(self, words: list[str]) -> Reading | None:
        """To port is counter-clockwise."""
        kind, number = words[0][2:], number_in(words, 1)
        place = STATUS_PLACES.get(kind)
        if number is None or (place is not None and words[place : place + 1] != [VALID]):
            return None
        if not (self._choice.takes_rate() if kind == RATE else self._choice.takes_angle()):
            return None
        self._sender = self._sender or words[0]
        if words[0] != self._sender:
            self._pass_over(words[0])
            return None
        return _rate(number) if kind == RATE else _heading(number)

    def _pass_over(self, sender: str) -> None:
        if len(self.counters.passed_over) < MOST_NAMES:
            self.counters.passed_over |= {sender}


class AskedNmeaDecoder(NmeaDecoder):
    """The same, of sentences without a checksum too where none has one."""

    def __init__(self) -> None:
        super().__init__()
        self._has_checksums = False

    def words(self, line: bytes) -> list[str] | None:
        """A whole sentence of a known kind, or one with its checksum."""
        if b"*" in line:
            words = words_of(line)
            self._has_checksums |= words is not None
            return words
        if self._has_checksums or line[:1] != b"$" or not line.isascii():
            return None
        words = line[1:].decode("ascii").split(",")
        count, last = COMPLETE.get(words[0][2:], (len(words), words[-1]))
        return words if len(words) == count and words[-1] in last else None


def _rate(per_minute: float) -> Reading | None:
    rate_dps = -per_minute / SECONDS_PER_MINUTE
    return Reading(None, None, rate_dps + 0.0) if abs(rate_dps) <= MAX_RATE_DPS else None


def _heading(clockwise_deg: float) -> Reading | None:
    return Reading(None, None, nan, yaw_deg=-clockwise_deg) if 0.0 <= clockwise_deg <= FULL_TURN_DEG else None


PROTOCOL = WireProtocol(
    "nmea",
    "rate of turn, $--ROT, or heading, without a clock",
    NmeaDecoder,
    has_clock=False,
    rank=6,
    has_unit=True,
    asked_decoder=AskedNmeaDecoder,
    without_rate="its $--ROT sentences say V, not valid: the device has not found its rate yet",
)
