"""VectorNav ASCII output: `$VNYMR,…*69`, `$VNIMU,…` and others with rates, in rad/s. No device clock.

Rates of `VNIMU` are as the sensor measures them; of the other messages the device has taken its own estimate of the
bias away (VN-100 user manual UM001, asynchronous messages). The body frame has z downwards: a rate that is positive
about it is clockwise from above. Where no message has a rate, the yaw of `VNYPR`, or that of the quaternion of `VNQTN`,
is taken in place of it.
"""

from math import degrees, nan

from gyrodrift.link.protocols.angles import RateOrAngle, yaw_of
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
ANGLES = frozenset({"VNYPR", "VNQTN"})


class VectornavAsciiDecoder(SentenceDecoder):
    """Whichever message with rates comes first."""

    name = "vectornav-ascii"

    def __init__(self) -> None:
        super().__init__()
        self._message = ""
        self._choice = RateOrAngle()

    def is_known(self, words: list[str]) -> bool:
        """Any message of the maker; without a rate it is passed over."""
        return words[0].startswith("VN")

    def read(self, words: list[str]) -> Reading | None:
        """Rate, and temperature where there is one; else yaw."""
        message = words[0]
        if message not in RATE_PLACES and message not in ANGLES:
            return None
        reading = _rate(words) if message in RATE_PLACES else _angle(words)
        if reading is None or message != (self._message or message):
            return None
        if not (self._choice.takes_rate() if message in RATE_PLACES else self._choice.takes_angle()):
            return None
        self._message = message
        return reading


def _rate(words: list[str]) -> Reading | None:
    rate_rads = number_in(words, RATE_PLACES[words[0]])
    temp_c = number_in(words, TEMPERATURE_PLACES.get(words[0], 99))
    if rate_rads is None or abs(degrees(rate_rads)) > MAX_RATE_DPS:
        return None
    return Reading(None, None, -degrees(rate_rads), temp_c=nan if temp_c is None else temp_c)


def _angle(words: list[str]) -> Reading | None:
    """Yaw in degrees, or a quaternion whose scalar comes last."""
    if words[0] == "VNYPR":
        yaw_deg = number_in(words, 1)
    else:
        numbers = [number for place in (4, 1, 2, 3) if (number := number_in(words, place)) is not None]
        yaw_deg = yaw_of(*numbers) if len(numbers) == 4 and any(numbers) else None
    if yaw_deg is None or abs(yaw_deg) > 360.0:
        return None
    return Reading(None, None, nan, yaw_deg=-yaw_deg)


PROTOCOL = WireProtocol(
    "vectornav-ascii",
    "VectorNav $VNYMR, $VNIMU and others with rates, without a clock",
    VectornavAsciiDecoder,
    has_clock=False,
    rank=4,
    has_unit=True,
    without_rate="choose VNYMR (14) or VNIMU (19) in register 6",
)
