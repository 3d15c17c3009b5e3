"""Yaw messages of a navX: `!y`, yaw, pitch, roll and compass of seven characters each, a sum, CRLF. No device clock.

The sum of all characters before it, modulo 256, has two hexadecimal digits. Yaw is clockwise, from -180 to 180 deg
(navX-MXP serial protocol, IMUProtocol.h). A filter on the board has processed it.
"""

import re
from math import nan

from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.link.protocols.sentences import SentenceDecoder
from gyrodrift.values.sample import Reading

MESSAGE = re.compile(rb"!y([-+][0-9]{3}\.[0-9]{2})(?:[-+][0-9]{3}\.[0-9]{2}){3}([0-9A-Fa-f]{2})")
OTHER_MESSAGE = re.compile(rb"![a-z][ -~]+([0-9A-Fa-f]{2})")
"""Other messages: quaternion, raw gyro and more."""

HALF_TURN_DEG = 180.0


class NavxDecoder(SentenceDecoder):
    """Decoder of yaw messages."""

    name = "navx"

    def words(self, line: bytes) -> list[str] | None:
        """Kind of a message, and its yaw if it has one; None if it is damaged."""
        match = MESSAGE.fullmatch(line) or OTHER_MESSAGE.fullmatch(line)
        if match is None or sum(line[:-2]) & 0xFF != int(line[-2:], 16):
            return None
        return ["y", match[1].decode("ascii")] if match.re is MESSAGE else [line[1:2].decode("ascii")]

    def is_known(self, words: list[str]) -> bool:
        """Whether the message has yaw."""
        return len(words) > 1

    def read(self, words: list[str]) -> Reading | None:
        """Reading with yaw, counter-clockwise."""
        yaw_deg = float(words[1])
        return Reading(None, None, nan, yaw_deg=-yaw_deg) if abs(yaw_deg) <= HALF_TURN_DEG else None


PROTOCOL = WireProtocol(
    "navx",
    "yaw messages !y of a navX, without a clock",
    NavxDecoder,
    has_clock=False,
    rank=7,
    has_unit=True,
    sends_angle=True,
    holds_zero=True,
)
