"""Xsens MTData2: `FA FF 36 length items sum`, with rate of turn, acceleration, time, counter and temperature.

An item has an id of two bytes, a length, and a content, all big-endian. The low digit of the id gives the number format
and the coordinate frame. Without a rate, the yaw of Euler angles or of a quaternion is used. The sum
of all bytes but the first is 0 modulo 256 (MT Low Level Communication Protocol, MT0101P).
"""

import re
from math import degrees, isfinite, isnan, nan
from struct import Struct

from gyrodrift.link.protocols.decoder import RateOrAngle
from gyrodrift.link.protocols.frames import FrameDecoder
from gyrodrift.link.protocols.plausible import MAX_RATE_DPS, inertial_of
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.values.constants import CLOCK_MASK
from gyrodrift.values.quaternion import yaw_of
from gyrodrift.values.sample import Reading

EXTENDED = 0xFF
LONGEST_BYTES = 700
"""A length of 255 means that two bytes with the length follow; no device sends more than LONGEST_BYTES."""

Items = dict[int, tuple[int, bytes]]
"""Form and content by kind."""

PACKET_COUNTER = 0x1020
SAMPLE_TIME_FINE = 0x1060
TEMPERATURE = 0x0810
RATES = (0x8020, 0x8040)
"""Calibrated rate, and rate of the high-rate output."""

ACCELERATIONS = (0x4020, 0x4040)
"""Calibrated acceleration with gravity, and that of the high-rate output; the frame of the sensor has z up."""

QUATERNION = 0x2010
EULER_ANGLES = 0x2030
NORTH_EAST_DOWN = 0x4
"""Frame with clockwise yaw; in frames whose z axis points up (0x0, 0x8) yaw is counter-clockwise."""

SAMPLE_TIME_US = 100
"""A tick of SampleTimeFine: 10 kHz."""

PRECISION = 0x3
"""Bits of an id with the number format."""

COUNTER = Struct(">H")
TICKS = Struct(">I")
FLOAT, FP1220, DOUBLE = Struct(">f"), Struct(">i"), Struct(">d")
VECTOR = Struct(">3f")
FP1632 = Struct(">Ih")
"""Fraction first, then the whole part."""


def number(content: bytes, precision: int, index: int) -> float:
    """Number at an index; NaN without one.

    precision
        0 for single precision, 1 for 12.20 and 2 for 16.32 fixed point, 3 for double precision.
    """
    form = (FLOAT, FP1220, FP1632, DOUBLE)[precision]
    if len(content) < (index + 1) * form.size:
        return nan
    value: tuple[float, ...] = form.unpack_from(content, index * form.size)
    if form is FP1632:
        return value[1] + value[0] / 2.0**32
    return value[0] / 2.0**20 if form is FP1220 else value[0]


def _yaw_of_euler(content: bytes, precision: int) -> float:
    """Yaw of roll, pitch and yaw."""
    return number(content, precision, 2)


def _yaw_of_quaternion(content: bytes, precision: int) -> float:
    """Yaw of a quaternion with the scalar first."""
    numbers = [number(content, precision, index) for index in range(4)]
    return yaw_of(*numbers) if all(map(isfinite, numbers)) and any(numbers) else nan


YAW_OF = {EULER_ANGLES: _yaw_of_euler, QUATERNION: _yaw_of_quaternion}


class XsensDecoder(FrameDecoder):
    """Decoder of MTData2 with any items; messages without a rate are counted."""

    name = "xsens"
    head = b"\xfa\xff\x36"
    header = re.compile(head)
    header_bytes = len(head)

    def __init__(self) -> None:
        super().__init__()
        self._is_timed: bool | None = None
        self._temp_c = nan
        self._choice = RateOrAngle()

    def length(self, buffer: bytes, position: int) -> int | None:
        """Length of head, length field, items and sum."""
        if len(buffer) - position < 4:
            return None
        stated = buffer[position + 3]
        if stated != EXTENDED:
            return stated + 5
        if len(buffer) - position < 6:
            return None
        stated = buffer[position + 4] << 8 | buffer[position + 5]
        return stated + 7 if EXTENDED <= stated <= LONGEST_BYTES else 0

    def is_whole(self, frame: bytes) -> bool:
        """The sum is right, and the items fill the frame."""
        return not sum(frame[1:]) & 0xFF and _items(frame) is not None

    def read(self, frame: bytes) -> Reading | None:
        """Rate about the third axis, else yaw; a temperature holds until the next one, for it comes less often."""
        items = _items(frame) or {}
        t_us = seq = None
        for kind, (form, content) in items.items():
            if kind == TEMPERATURE:
                self._temp_c = number(content, form & PRECISION, 0)
            elif kind == SAMPLE_TIME_FINE and len(content) == TICKS.size:
                t_us = TICKS.unpack(content)[0] * SAMPLE_TIME_US & CLOCK_MASK
            elif kind == PACKET_COUNTER and len(content) == COUNTER.size:
                seq = COUNTER.unpack(content)[0]
        rate_dps, yaw_deg = self._turn(items)
        if isnan(rate_dps) and isnan(yaw_deg):
            return None
        if self._is_timed is None:
            self._is_timed = t_us is not None
        if self._is_timed and t_us is None:
            return None
        rates_dps = tuple(map(degrees, _vector(items, RATES)))
        inertial = None if isnan(rate_dps) else inertial_of(rates_dps, _vector(items, ACCELERATIONS))
        return Reading(t_us if self._is_timed else None, seq, rate_dps, nan, self._temp_c, nan, yaw_deg, inertial)

    def _turn(self, items: Items) -> tuple[float, float]:
        """Rate and yaw, of which one or both are NaN."""
        rates = [
            degrees(number(content, form & PRECISION, 2)) for kind, (form, content) in items.items() if kind in RATES
        ]
        if rates and self._choice.offer_rate():
            return (rates[-1] if abs(rates[-1]) <= MAX_RATE_DPS else nan), nan
        yaws = [_yaw_deg(kind, form, content) for kind, (form, content) in items.items() if kind in YAW_OF]
        is_taken = bool(yaws) and isfinite(yaws[-1]) and self._choice.offer_angle()
        return nan, yaws[-1] if is_taken else nan


def _vector(items: Items, kinds: tuple[int, int]) -> tuple[float, ...]:
    """Last vector of these kinds; NaN without one."""
    last: tuple[int, bytes] | None = None
    for kind, item in items.items():
        if kind in kinds:
            last = item
    if last is None:
        return nan, nan, nan
    form, content = last
    if not form & PRECISION and len(content) >= VECTOR.size:
        return VECTOR.unpack_from(content)
    return tuple(number(content, form & PRECISION, index) for index in range(3))


def _yaw_deg(kind: int, form: int, content: bytes) -> float:
    yaw_deg = YAW_OF[kind](content, form & PRECISION)
    return -yaw_deg if form & NORTH_EAST_DOWN else yaw_deg


def _items(frame: bytes) -> Items | None:
    """Form and content by kind; None where they do not fill the frame."""
    position, end = (6 if frame[3] == EXTENDED else 4), len(frame) - 1
    items = {}
    while position + 3 <= end:
        kind, size = frame[position] << 8 | frame[position + 1], frame[position + 2]
        items[kind & 0xFFF0] = kind & 0xF, frame[position + 3 : position + 3 + size]
        position += 3 + size
    return items if position == end else None


PROTOCOL = WireProtocol(
    "xsens",
    "Xsens MTData2 with rate of turn",
    XsensDecoder,
    has_clock=True,
    rank=8,
    has_unit=True,
    without_rate="add RateOfTurn (0x8020) to the output configuration, and SampleTimeFine (0x1060) for a clock",
)
