"""VectorNav ASCII output: `$VNYMR,…*69`, `$VNIMU,…` and others with rates, in rad/s. No device clock.

Rates of `VNIMU` are as the sensor measures them; of the other messages the device has taken its own estimate of the
bias away (VN-100 user manual UM001, asynchronous messages). The body frame has z downwards: a rate that is positive
about it is clockwise from above.
"""

from math import degrees, nan

from gyrodrift.link.protocols.lines import MAX_RATE_DPS
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.link.protocols.sentences import SentenceDecoder, number_in
from gyrodrift.sample import Reading

RATE_PLACES = {
    "VNIMU": 9,
    "VNYMR": 12,
    "VNQMR": 13,
    "VNMAR": 9,
    "VNGYR": 3,
    "VNYBA": 9,
    "VNYIA": 9,
}
"""Which word is the rate about z; of two messages that come in turns the first one is listened to."""

TEMPERATURE_PLACES = {"VNIMU": 10}


class VectornavAsciiDecoder(SentenceDecoder):
    """Whichever message with rates comes first."""

    name = "vectornav-ascii"

    def __init__(self) -> None:
        super().__init__()
        self._message = ""

    def is_known(self, words: list[str]) -> bool:
        """Any message of the maker; without a rate it is passed over."""
        return words[0].startswith("VN")

    def read(self, words: list[str]) -> Reading | None:
        """Rate, and temperature where there is one."""
        message = words[0]
        if message not in RATE_PLACES or message != (self._message or message):
            return None
        self._message = message
        rate_rads, temp_c = (
            number_in(words, RATE_PLACES[message]),
            number_in(words, TEMPERATURE_PLACES.get(message, 99)),
        )
        if rate_rads is None or abs(degrees(rate_rads)) > MAX_RATE_DPS:
            return None
        return Reading(None, None, -degrees(rate_rads), temp_c=nan if temp_c is None else temp_c)


PROTOCOL = WireProtocol(
    "vectornav-ascii",
    "VectorNav $VNYMR, $VNIMU and others with rates, without a clock",
    VectornavAsciiDecoder,
    has_clock=False,
    rank=4,
    has_unit=True,
    without_rate="choose VNYMR (14) or VNIMU (19) in register 6",
)
