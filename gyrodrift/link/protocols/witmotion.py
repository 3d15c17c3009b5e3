"""The WT901 family: 11-byte frames `0x55 kind d0..d7 sum`; kind 0x52 carries the rates. No device clock.

Kind 0x51 carries the accelerations of the same measurement, before the rates; z points up. Without rates, the yaw of
the angles, kind 0x53, is used.

The checksum has one byte, so noise passes it once in 256 tries. After damage, a frame counts only if the next one
follows directly.
"""

from math import nan
from struct import Struct

from gyrodrift.link.protocols.angles import RateOrAngle
from gyrodrift.link.protocols.decoder import DecoderCounters, DeviceDescription
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.values.constants import STANDARD_GRAVITY_MPS2
from gyrodrift.values.sample import Inertial, Reading

HEADER = 0x55
FRAME_BYTES = 11
ACCELERATIONS_KIND = 0x51
RATES_KIND = 0x52
ANGLES_KIND = 0x53
KINDS = range(0x50, 0x60)
"""Time, acceleration, rate, angle, magnetic field, ports, pressure, position, velocity, quaternion, accuracy."""

RATES = Struct("<hhhh")
DPS_PER_LSB = 2000.0 / 32768.0
DEG_PER_LSB = 180.0 / 32768.0
MPS2_PER_LSB = 16.0 * STANDARD_GRAVITY_MPS2 / 32768.0
"""Full scale of ±2000 deg/s, of ±180 deg and of ±16 g, over 16 bits (WT901 protocol description)."""

NO_FORCES = (nan, nan, nan)


class WitmotionDecoder:
    """Decoder of frames with header and checksum."""

    name = "witmotion"

    def __init__(self) -> None:
        self.counters = DecoderCounters()
        self.device = DeviceDescription(dps_per_lsb=DPS_PER_LSB)
        self._pending = b""
        self._in_step = False
        self._choice = RateOrAngle()
        self._forces_mps2 = NO_FORCES

    def push(self, chunk: bytes) -> list[Reading]:
        """Decode complete frames, and keep the rest."""
        readings: list[Reading] = []
        buffer = self._pending + chunk
        position = 0
        while len(buffer) - position >= FRAME_BYTES:
            if not _is_frame(buffer, position):
                position = self._lose_step(buffer, position)
            elif self._in_step:
                self._take(buffer, position, readings)
                position += FRAME_BYTES
            elif len(buffer) - position < 2 * FRAME_BYTES:
                break
            elif _is_frame(buffer, position + FRAME_BYTES):
                self._in_step = True
            else:
                position = self._lose_step(buffer, position)
        self._pending = buffer[position:]
        return readings

    def _lose_step(self, buffer: bytes, position: int) -> int:
        if self._in_step:
            self.counters.damaged += 1
            self._in_step = False
        match = buffer.find(HEADER, position + 1)
        return match if match >= 0 else len(buffer)

    def _take(self, buffer: bytes, position: int, readings: list[Reading]) -> None:
        self.counters.frames += 1
        kind = buffer[position + 1]
        x_raw, y_raw, z_raw, extra = RATES.unpack_from(buffer, position + 2)
        if kind == RATES_KIND and self._choice.takes_rate():
            inertial = inertial_of((x_raw, y_raw, z_raw), self._forces_mps2)
            self._forces_mps2 = NO_FORCES
            readings.append(Reading(None, None, inertial.gyro_z_dps, temp_c=extra / 100.0, inertial=inertial))
        elif kind == ANGLES_KIND and self._choice.takes_angle():
            readings.append(Reading(None, None, nan, yaw_deg=z_raw * DEG_PER_LSB))
        else:
            self.counters.other_frames += 1
            if kind == ACCELERATIONS_KIND:
                self._forces_mps2 = (x_raw * MPS2_PER_LSB, y_raw * MPS2_PER_LSB, z_raw * MPS2_PER_LSB)


def inertial_of(rates_raw: tuple[int, int, int], forces_mps2: tuple[float, float, float]) -> Inertial:
    """All axes, from counts of the rates and from accelerations."""
    x_raw, y_raw, z_raw = rates_raw
    return Inertial(x_raw * DPS_PER_LSB, y_raw * DPS_PER_LSB, z_raw * DPS_PER_LSB, *forces_mps2)


def _is_frame(buffer: bytes, position: int) -> bool:
    return (
        buffer[position] == HEADER
        and buffer[position + 1] in KINDS
        and sum(buffer[position : position + FRAME_BYTES - 1]) & 0xFF == buffer[position + FRAME_BYTES - 1]
    )


PROTOCOL = WireProtocol(
    "witmotion",
    "frames of the WT901 family, without a clock",
    WitmotionDecoder,
    has_clock=False,
    rank=20,
    holds_zero=True,
    without_rate="turn on its output of angular velocity (0x52), with the maker's program",
)
