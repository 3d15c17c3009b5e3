"""The WT901 family: 11-byte frames `0x55 kind d0..d7 sum`; kind 0x52 carries the rates. No device clock.

Kind 0x51 carries the accelerations of the same measurement, before the rates; z points up. Without rates, the yaw of
the angles, kind 0x53, is used.

The checksum has one byte, so noise passes it once in 256 tries. After damage, a frame counts only if the next one
follows directly.
"""

import re
from math import nan
from struct import Struct

from gyrodrift.link.protocols.decoder import DeviceDescription, RateOrAngle
from gyrodrift.link.protocols.frames import FrameDecoder
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.values.constants import INT16_COUNTS, STANDARD_GRAVITY_MPS2
from gyrodrift.values.sample import Inertial, Reading

HEAD = b"\x55"
FRAME = Struct("<cB4hB")
ACCELERATIONS_KIND = 0x51
RATES_KIND = 0x52
ANGLES_KIND = 0x53
KINDS = range(0x50, 0x60)
"""Time, acceleration, rate, angle, magnetic field, ports, pressure, position, velocity, quaternion, accuracy."""

DPS_PER_LSB = 2000.0 / INT16_COUNTS
DEG_PER_LSB = 180.0 / INT16_COUNTS
MPS2_PER_LSB = 16.0 * STANDARD_GRAVITY_MPS2 / INT16_COUNTS
"""Full scale of ±2000 deg/s, of ±180 deg and of ±16 g, over 16 bits (WT901 protocol description)."""

NO_FORCES = (nan, nan, nan)


class WitmotionDecoder(FrameDecoder):
    """Decoder of frames with header and checksum."""

    name = "witmotion"
    head = HEAD
    header = re.compile(rb"\x55[\x50-\x5f]")
    header_bytes = 2
    needs_two = True

    def __init__(self) -> None:
        super().__init__()
        self.device = DeviceDescription(dps_per_lsb=DPS_PER_LSB)
        self._choice = RateOrAngle()
        self._forces_mps2 = NO_FORCES

    def length(self, buffer: bytes, position: int) -> int | None:  # noqa: ARG002 - constant here
        """Length of all frames."""
        return FRAME.size

    def is_whole(self, frame: bytes) -> bool:
        """Whether the kind is known, and the sum of all bytes before it is right."""
        return frame[1] in KINDS and sum(frame[:-1]) & 0xFF == frame[-1]

    def read(self, frame: bytes) -> Reading | None:
        """Reading with rates, else with yaw."""
        _, kind, x_raw, y_raw, z_raw, extra, _ = FRAME.unpack(frame)
        if kind == RATES_KIND and self._choice.offer_rate():
            inertial = inertial_from((x_raw, y_raw, z_raw), self._forces_mps2)
            self._forces_mps2 = NO_FORCES
            return Reading(None, None, inertial.gyro_z_dps, temp_c=extra / 100.0, inertial=inertial)
        if kind == ANGLES_KIND and self._choice.offer_angle():
            return Reading(None, None, nan, yaw_deg=z_raw * DEG_PER_LSB)
        if kind == ACCELERATIONS_KIND:
            self._forces_mps2 = (x_raw * MPS2_PER_LSB, y_raw * MPS2_PER_LSB, z_raw * MPS2_PER_LSB)
        return None


def inertial_from(rates_raw: tuple[int, int, int], forces_mps2: tuple[float, float, float]) -> Inertial:
    """All axes, from counts of the rates and from accelerations."""
    x_raw, y_raw, z_raw = rates_raw
    return Inertial(x_raw * DPS_PER_LSB, y_raw * DPS_PER_LSB, z_raw * DPS_PER_LSB, *forces_mps2)


PROTOCOL = WireProtocol(
    "witmotion",
    "frames of the WT901 family, without a clock",
    WitmotionDecoder,
    has_clock=False,
    rank=20,
    holds_zero=True,
    without_rate="turn on its output of angular velocity (0x52), with the maker's program",
)
