"""NMEA 0183: `$--ROT,rate,A*hh`, the rate of turn in deg/min, negative to port. No device clock.

A sentence with the status `V` is not valid, and ignored like other kinds. Without a valid rate, the heading of `HDT`,
`HDM`, `HDG` or `THS` is used, clockwise from north.

The standard allows sentences without a checksum. They are read only if the user names this protocol, and no sentence
with a checksum has arrived.
"""

from math import nan

from gyrodrift.link.protocols.decoder import RateOrAngle
from gyrodrift.link.protocols.plausible import MAX_RATE_DPS
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.link.protocols.sentences import SentenceDecoder, number_in, words_of
from gyrodrift.values.constants import FULL_TURN_DEG, SECONDS_PER_MINUTE
from gyrodrift.values.sample import Reading

VALID = "A"
RATE = "ROT"
HEADINGS = frozenset({"HDT", "HDM", "HDG", "THS"})
"""Headings: true, magnetic, sensor, and true with a status (NMEA 0183, approved sentences)."""

STATUS_INDEX = {"ROT": 2, "THS": 2}
COMPLETE = {"ROT": (3, "AV"), "HDT": (3, "T"), "HDM": (3, "M"), "THS": (3, "AEMSV"), "HDG": (6, "EW")}
"""Number of words and last word of a complete sentence, for sentences without a checksum."""

NAMES_MAX = 8
"""Largest number of ignored talkers that are reported."""


class NmeaDecoder(SentenceDecoder):
    """Decoder of rate of turn, else heading, of the first talker with a valid value."""

    name = "nmea"

    def __init__(self) -> None:
        super().__init__()
        self._sender = ""
        self._choice = RateOrAngle()

    def is_known(self, words: list[str]) -> bool:
        """Whether it is a rate or a heading of any talker, which has two letters."""
        return len(words[0]) == 5 and (words[0].endswith(RATE) or words[0][2:] in HEADINGS)

    def read(self, words: list[str]) -> Reading | None:
        """Reading with rate or angle, counter-clockwise."""
        kind, number = words[0][2:], number_in(words, 1)
        index = STATUS_INDEX.get(kind)
        if number is None or (index is not None and words[index : index + 1] != [VALID]):
            return None
        if not (self._choice.offer_rate() if kind == RATE else self._choice.offer_angle()):
            return None
        self._sender = self._sender or words[0]
        if words[0] != self._sender:
            self._pass_over(words[0])
            return None
        return _rate(number) if kind == RATE else _heading(number)

    def _pass_over(self, sender: str) -> None:
        if len(self.counters.passed_over) < NAMES_MAX:
            self.counters.passed_over |= {sender}


class AskedNmeaDecoder(NmeaDecoder):
    """Decoder that also reads sentences without a checksum, if none has one."""

    def __init__(self) -> None:
        super().__init__()
        self._has_checksums = False

    def words(self, line: bytes) -> list[str] | None:
        """Words of a sentence with its checksum, or of a complete one of a known kind."""
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
    without_rate="its $--ROT sentences say V, not valid: the device has no valid rate yet",
)
