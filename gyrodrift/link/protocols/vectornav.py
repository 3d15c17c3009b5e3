"""VectorNav binary output: `0xFA groups fields… payload crc`, with time, rates, acceleration and temperature.

Every frame lists its fields, so any selection is decoded (VN-100 user manual UM001, binary output messages). A byte has
one bit per group. Two bytes per group follow, with one bit per field, then the fields in that order. The end is a
CRC-16/CCITT of all bytes but the first, with the initial value 0. Fields without a fixed length, and groups beyond the
seventh, are not read.

The z axis of the body frame points down: a positive rate is clockwise from above.
"""

import re
from binascii import crc_hqx
from functools import lru_cache
from math import degrees, isfinite, nan
from struct import Struct
from typing import NamedTuple

from gyrodrift.link.protocols.frames import FrameDecoder
from gyrodrift.link.protocols.plausible import MAX_RATE_DPS, inertial_of
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.values.constants import CLOCK_MASK
from gyrodrift.values.sample import Inertial, Reading, upside_down

GPS = (8, 8, 2, 1, 1, 24, 24, 12, 12, 12, 4, 4, 2, 28)
FIELD_BYTES = (
    (8, 8, 8, 12, 16, 12, 24, 12, 12, 24, 20, 28, 2, 4, 8),
    (8, 8, 8, 2, 8, 8, 8, 4, 4, 1),
    (2, 12, 12, 12, 4, 4, 16, 12, 12, 12, 12, 2),
    GPS,
    (2, 12, 16, 36, 12, 12, 12, 12, 12, 12, 28, 24),
    (2, 24, 24, 12, 12, 12, 12, 12, 12, 4, 4, 68, 64),
    GPS,
)
"""Sizes of the fields of the groups common, time, IMU, GNSS, attitude, INS and second GNSS."""

TIMES = ((0, 0, 0), (1, 0, 0))
"""TimeStartup, as group, field and offset in the field."""

RATES = ((2, 3, 8), (0, 9, 20), (0, 5, 8), (2, 10, 8))
"""Third axis of UncompGyro, Imu and AngularRate; rates with their bias come first."""

FORCES = ((2, 2, 0), (0, 9, 0), (0, 8, 0), (2, 9, 0))
"""UncompAccel, Imu and Accel, with gravity."""

TEMPERATURES = ((2, 4, 0), (0, 10, 12))
"""Temp, and the temperature in MagPres."""

LONGEST_BYTES = 500
NANOSECONDS = Struct("<Q")
FLOAT = Struct("<f")
VECTOR = Struct("<3f")


def _sums(sizes: tuple[int, ...]) -> tuple[int, ...]:
    """Size of the fields for every byte of bits; above LONGEST_BYTES for a bit without a field."""
    return tuple(
        sum(size for bit, size in enumerate(sizes) if byte >> bit & 1) + LONGEST_BYTES * (byte >> len(sizes))
        for byte in range(256)
    )


GROUPS = tuple(tuple(group for group in range(len(FIELD_BYTES)) if byte >> group & 1) for byte in range(128))
LOW_SUMS = tuple(_sums(sizes[:8]) for sizes in FIELD_BYTES)
HIGH_SUMS = tuple(_sums(sizes[8:]) for sizes in FIELD_BYTES)
"""Sizes of the fields for the low and the high byte of a group."""

HEADER = b"\xfa(?:%b)" % b"|".join(
    re.escape(bytes((byte,)))
    + b"".join(rb".[\x00-\x%02x]" % ((1 << len(FIELD_BYTES[group]) - 8) - 1) for group in GROUPS[byte])
    for byte in range(1, len(GROUPS))
)
"""Sync byte and groups with known fields only."""


class Layout(NamedTuple):
    """Positions of time, rate about z, temperature and acceleration along x in a frame; 0 if missing."""

    time: int
    rate: int
    temp: int
    force: int


@lru_cache(maxsize=64)
def layout_of(header: bytes) -> Layout:
    """Layout of a frame from its header without the first byte."""
    positions: dict[tuple[int, int], int] = {}
    position = 1 + len(header)
    for group, low, high in zip(GROUPS[header[0]], header[1::2], header[2::2], strict=True):
        for field, size in enumerate(FIELD_BYTES[group]):
            if (low | high << 8) >> field & 1:
                positions[group, field] = position
                position += size
    layout_positions = (
        next((positions[group, field] + offset for group, field, offset in choices if (group, field) in positions), 0)
        for choices in (TIMES, RATES, TEMPERATURES, FORCES)
    )
    return Layout(*layout_positions)


class VectornavDecoder(FrameDecoder):
    """Decoder of frames with any fields; frames without a rate are counted."""

    name = "vectornav"
    head = b"\xfa"
    header = re.compile(HEADER, re.DOTALL)
    header_bytes = 2 + 2 * len(FIELD_BYTES)
    filler = b"$"  # ASCII messages on the same port, which are on by default

    def __init__(self) -> None:
        super().__init__()
        self._is_timed: bool | None = None

    def length(self, buffer: bytes, position: int) -> int | None:
        """Length from the fields of the header."""
        if len(buffer) - position < 2:
            return None
        if not 0 < buffer[position + 1] < len(GROUPS):
            return 0
        groups, field = GROUPS[buffer[position + 1]], position + 2
        length = 4 + 2 * len(groups)
        if len(buffer) < field + 2 * len(groups):
            return None
        for group in groups:
            length += LOW_SUMS[group][buffer[field]] + HIGH_SUMS[group][buffer[field + 1]]
            field += 2
        return length if length <= LONGEST_BYTES else 0

    def is_whole(self, frame: bytes) -> bool:
        """Whether the CRC of the frame, including its CRC, is 0."""
        return not crc_hqx(frame[1:], 0)

    def read(self, frame: bytes) -> Reading | None:
        """Time since start, rate and temperature."""
        layout = layout_of(frame[1 : 2 + 2 * len(GROUPS[frame[1]])])
        if not layout.rate:
            return None
        if self._is_timed is None:
            self._is_timed = bool(layout.time)
        rate_dps = -degrees(FLOAT.unpack_from(frame, layout.rate)[0])
        if self._is_timed > bool(layout.time) or not (isfinite(rate_dps) and abs(rate_dps) <= MAX_RATE_DPS):
            return None
        inertial = _inertial(frame, layout)
        t_us = NANOSECONDS.unpack_from(frame, layout.time)[0] // 1000 & CLOCK_MASK if self._is_timed else None
        temp_c = FLOAT.unpack_from(frame, layout.temp)[0] if layout.temp else nan
        return Reading(t_us, None, rate_dps, nan, temp_c, inertial=inertial)


def _inertial(frame: bytes, layout: Layout) -> Inertial | None:
    """All axes in a frame with z up; None without three plausible rates."""
    rates_rads = VECTOR.unpack_from(frame, layout.rate - 2 * FLOAT.size)
    forces_mps2 = VECTOR.unpack_from(frame, layout.force) if layout.force else None
    inertial = inertial_of(tuple(map(degrees, rates_rads)), forces_mps2)
    return None if inertial is None else upside_down(inertial)


PROTOCOL = WireProtocol(
    "vectornav",
    "VectorNav binary output with any fields",
    VectornavDecoder,
    has_clock=True,
    rank=2,
    has_unit=True,
    without_rate="turn on AngularRate of the common group (register 75), and TimeStartup for a clock",
)
