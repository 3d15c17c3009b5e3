"""VectorNav ASCII output: `$VNYMR,…*69`, `$VNIMU,…` and others with rates, in rad/s. No device clock.

Rates of `VNIMU` are raw; from the rates of other messages the device has subtracted its bias estimate (VN-100 user
manual UM001, asynchronous messages). The z axis of the body frame points down: a positive rate is clockwise from above.
Without a rate, the yaw of `VNYPR`, or of the quaternion of `VNQTN`, is used.
"""

from math import degrees, nan

from gyrodrift.link.protocols.decoder import RateOrAngle
from gyrodrift.link.protocols.plausible import MAX_RATE_DPS, inertial_of
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.link.protocols.sentences import SentenceDecoder, number_in
from gyrodrift.values.quaternion import yaw_of
from gyrodrift.values.sample import Inertial, Reading, upside_down

RATE_INDEX = {
    "VNIMU": 9,
    "VNYMR": 12,
    "VNQMR": 13,
    "VNMAR": 9,
    "VNGYR": 3,
    "VNYBA": 9,
    "VNYIA": 9,
}
"""Index of the rate about z in a message; of two alternating messages the first one is used."""

TEMPERATURE_INDEX = {"VNIMU": 10}
ANGLES = frozenset({"VNYPR", "VNQTN"})

WITH_GRAVITY = frozenset({"VNIMU", "VNYMR", "VNQMR", "VNMAR"})
"""Messages with accelerations before the rates; others have none, or accelerations without gravity."""


class VectornavAsciiDecoder(SentenceDecoder):
    """Decoder of the first message with rates."""

    name = "vectornav-ascii"

    def __init__(self) -> None:
        super().__init__()
        self._message = ""
        self._choice = RateOrAngle()

    def is_known(self, words: list[str]) -> bool:
        """Whether it is a message of this maker."""
        return words[0].startswith("VN")

    def read(self, words: list[str]) -> Reading | None:
        """Reading with rate and temperature, else with yaw."""
        message = words[0]
        if message not in RATE_INDEX and message not in ANGLES:
            return None
        reading = _rate(words) if message in RATE_INDEX else _angle(words)
        if reading is None or message != (self._message or message):
            return None
        if not (self._choice.offer_rate() if message in RATE_INDEX else self._choice.offer_angle()):
            return None
        self._message = message
        return reading


def _rate(words: list[str]) -> Reading | None:
    rate_rads = number_in(words, RATE_INDEX[words[0]])
    temp_c = number_in(words, TEMPERATURE_INDEX.get(words[0], 99))
    if rate_rads is None or abs(degrees(rate_rads)) > MAX_RATE_DPS:
        return None
    return Reading(None, None, -degrees(rate_rads), temp_c=nan if temp_c is None else temp_c, inertial=_inertial(words))


def _inertial(words: list[str]) -> Inertial | None:
    """All axes in a frame with z up; None without three plausible rates."""
    last = RATE_INDEX[words[0]]
    rates_rads = [number_in(words, index) for index in range(last - 2, last + 1)]
    first = last - 5 if words[0] in WITH_GRAVITY else len(words)
    forces_mps2 = [number_in(words, index) for index in range(first, first + 3)]
    inertial = inertial_of(
        [nan if rate_rads is None else degrees(rate_rads) for rate_rads in rates_rads],
        [nan if force_mps2 is None else force_mps2 for force_mps2 in forces_mps2],
    )
    return None if inertial is None else upside_down(inertial)


def _angle(words: list[str]) -> Reading | None:
    """Reading with yaw, from degrees or from a quaternion with the scalar last."""
    if words[0] == "VNYPR":
        yaw_deg = number_in(words, 1)
    else:
        numbers = [number for index in (4, 1, 2, 3) if (number := number_in(words, index)) is not None]
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
