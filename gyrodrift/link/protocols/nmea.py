"""NMEA 0183: `$--ROT,rate,A*hh`, the rate of turn in deg/min, negative to port. No device clock.

A sentence whose status is `V` is not valid, and is passed over like those of other kinds.
"""

from gyrodrift.link.protocols.lines import MAX_RATE_DPS
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.link.protocols.sentences import SentenceDecoder, number_in
from gyrodrift.sample import Reading

SECONDS_PER_MINUTE = 60.0
VALID = "A"


class NmeaDecoder(SentenceDecoder):
    """Rate of turn of one talker: of several that take turns, the first with a valid rate."""

    name = "nmea"

    def __init__(self) -> None:
        super().__init__()
        self._talker = ""

    def is_known(self, words: list[str]) -> bool:
        """Two letters say who talks."""
        return len(words[0]) == 5 and words[0].endswith("ROT")

    def read(self, words: list[str]) -> Reading | None:
        """To port is counter-clockwise."""
        per_minute, talker = number_in(words, 1), words[0][:2]
        if per_minute is None or words[2:3] != [VALID]:
            return None
        self._talker = self._talker or talker
        if talker != self._talker:
            self.counters.passed_over |= {f"{talker}ROT"}
            return None
        rate_dps = -per_minute / SECONDS_PER_MINUTE
        return Reading(None, None, rate_dps + 0.0) if abs(rate_dps) <= MAX_RATE_DPS else None


PROTOCOL = WireProtocol(
    "nmea",
    "rate of turn, $--ROT, without a clock",
    NmeaDecoder,
    has_clock=False,
    rank=6,
    has_unit=True,
    without_rate="its $--ROT sentences say V, not valid: the device has not found its rate yet",
)
