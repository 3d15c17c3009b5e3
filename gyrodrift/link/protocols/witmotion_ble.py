"""WitMotion's Bluetooth family (WT901BLE, WT9011DCL) on its USB port: `0x55 0x61`, nine numbers, no checksum, no clock.

20 bytes: accelerations, rates and angles about x, y and z, little-endian (protocol description of the WT901BLE). The
distance of 20 bytes between heads replaces a checksum. After damage, IN_A_ROW consecutive frames with a plausible
acceleration are needed. Then a frame counts if its angles follow from the last one, or if the next head follows
directly: a lost byte would shift it.
"""

import re
from math import hypot
from struct import Struct

from gyrodrift.link.protocols.decoder import DecoderCounters, DeviceDescription
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.link.protocols.witmotion import DPS_PER_LSB, HEADER, MPS2_PER_LSB, inertial_of
from gyrodrift.values.sample import Reading

HEAD = re.compile(rb"\x55[\x61\x71]")
"""Heads of a measurement, and of the answer to a register request."""

MEASUREMENT = 0x61
FRAME = Struct("<2s9h")
IN_A_ROW = 4
"""Four heads of two bytes: noise has them once in 2**64 positions."""

G_PER_LSB = 16.0 / 32768.0
PLAUSIBLE_G = (0.2, 8.0)
"""Plausible length of the first acceleration, g."""

GOES_ON = 8192
"""Largest change of an angle between two frames: 45 deg in counts of 180/32768 deg, at 10 Hz or more."""


class WitmotionBleDecoder:
    """Decoder of frames by their distance."""

    name = "witmotion-ble"

    def __init__(self) -> None:
        self.counters = DecoderCounters()
        self.device = DeviceDescription(dps_per_lsb=DPS_PER_LSB)
        self._pending = b""
        self._in_step = False
        self._angles: tuple[int, ...] = ()

    def push(self, chunk: bytes) -> list[Reading]:
        """Decode complete frames, and keep the rest."""
        readings: list[Reading] = []
        buffer, position = self._pending + chunk, 0
        while (is_frame := self._is_frame(buffer, position)) is not None:
            if is_frame:
                self._in_step = True
                self._take(buffer, position, readings)
                position += FRAME.size
            else:
                position = self._lose_step(buffer, position)
        self._pending = buffer[position:]
        return readings

    def _is_frame(self, buffer: bytes, position: int) -> bool | None:
        """Whether there is a frame at a position; None if more bytes are needed."""
        remaining = len(buffer) - position
        if remaining < 2:
            return None if remaining == 0 or buffer[position] == HEADER else False
        if not HEAD.match(buffer, position):
            return False
        if not self._in_step:
            return _is_run(buffer, position)
        if remaining < FRAME.size:
            return None
        if self._goes_on(buffer, position):
            return True
        return None if remaining < FRAME.size + 2 else bool(HEAD.match(buffer, position + FRAME.size))

    def _goes_on(self, buffer: bytes, position: int) -> bool:
        if buffer[position + 1] != MEASUREMENT:
            return True
        *_, roll, pitch, yaw = FRAME.unpack_from(buffer, position)
        steps = (now - before for now, before in zip((roll, pitch, yaw), self._angles, strict=False))
        return all(abs((step + 32768) % 65536 - 32768) <= GOES_ON for step in steps)

    def _lose_step(self, buffer: bytes, position: int) -> int:
        if self._in_step:
            self.counters.damaged += 1
            self._in_step = False
        match = buffer.find(HEADER, position + 1)
        return match if match >= 0 else len(buffer)

    def _take(self, buffer: bytes, position: int, readings: list[Reading]) -> None:
        self.counters.frames += 1
        if buffer[position + 1] != MEASUREMENT:
            self.counters.other_frames += 1
            return
        _, accel_x, accel_y, accel_z, x_raw, y_raw, z_raw, *angles = FRAME.unpack_from(buffer, position)
        self._angles = tuple(angles)
        forces_mps2 = (accel_x * MPS2_PER_LSB, accel_y * MPS2_PER_LSB, accel_z * MPS2_PER_LSB)
        inertial = inertial_of((x_raw, y_raw, z_raw), forces_mps2)
        readings.append(Reading(None, None, inertial.gyro_z_dps, inertial=inertial))


def _is_run(buffer: bytes, position: int) -> bool | None:
    """Whether IN_A_ROW plausible frames follow each other; None if more bytes are needed."""
    for start in range(position, position + IN_A_ROW * FRAME.size, FRAME.size):
        if len(buffer) - start >= 2 and not HEAD.match(buffer, start):
            return False
        if len(buffer) - start < FRAME.size:
            return None
        if buffer[start + 1] == MEASUREMENT and not _is_plausible(buffer, start):
            return False
    return True


def _is_plausible(buffer: bytes, position: int) -> bool:
    _, x, y, z, *_ = FRAME.unpack_from(buffer, position)
    low_g, high_g = PLAUSIBLE_G
    return low_g <= hypot(x, y, z) * G_PER_LSB <= high_g


PROTOCOL = WireProtocol(
    "witmotion-ble",
    "frames of the WT901BLE family, without a clock",
    WitmotionBleDecoder,
    has_clock=False,
    rank=22,
    holds_zero=True,
)
