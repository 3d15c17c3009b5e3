"""WitMotion's Bluetooth family (WT901BLE, WT9011DCL) on its USB port: `0x55 0x61`, nine numbers, no checksum, no clock.

20 bytes: accelerations, rates and angles about x, y and z, little-endian (protocol description of the WT901BLE). The
distance of 20 bytes between heads replaces a checksum. After damage, IN_A_ROW consecutive frames with a plausible
acceleration are needed. Then a frame counts if its angles follow from the last one, or if the next head follows
directly: a lost byte would shift it.
"""

import re
from math import hypot
from struct import Struct

from gyrodrift.link.protocols.decoder import DeviceDescription
from gyrodrift.link.protocols.frames import FrameDecoder
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.link.protocols.witmotion import DPS_PER_LSB, HEAD, MPS2_PER_LSB, inertial_from
from gyrodrift.values.constants import INT16_COUNTS
from gyrodrift.values.sample import Reading

HEADS = re.compile(rb"\x55[\x61\x71]")
"""Heads of a measurement, and of the answer to a register request."""

MEASUREMENT = 0x61
FRAME = Struct("<2s9h")
IN_A_ROW = 4
"""Four heads of two bytes: noise has them once in 2**64 positions."""

G_PER_LSB = 16.0 / INT16_COUNTS
PLAUSIBLE_G = (0.2, 8.0)
"""Plausible length of the first acceleration, g."""

GOES_ON = 8192
"""Largest change of an angle between two frames: 45 deg in counts of 180/32768 deg, at 10 Hz or more."""


class WitmotionBleDecoder(FrameDecoder):
    """Decoder of frames by their distance."""

    name = "witmotion-ble"
    head = HEAD
    header = HEADS
    header_bytes = 2

    def __init__(self) -> None:
        super().__init__()
        self.device = DeviceDescription(dps_per_lsb=DPS_PER_LSB)
        self._angles: tuple[int, ...] = ()

    def length(self, buffer: bytes, position: int) -> int | None:
        """Length of all frames."""
        if len(buffer) - position < self.header_bytes:
            return None
        return FRAME.size if HEADS.match(buffer, position) else 0

    def is_whole(self, frame: bytes) -> bool:
        """Whether the acceleration is plausible, as it must be after damage."""
        _, x, y, z, *_ = FRAME.unpack(frame)
        low_g, high_g = PLAUSIBLE_G
        return self._in_step or frame[1] != MEASUREMENT or low_g <= hypot(x, y, z) * G_PER_LSB <= high_g

    def read(self, frame: bytes) -> Reading | None:
        """Reading of a measurement."""
        if frame[1] != MEASUREMENT:
            return None
        _, accel_x, accel_y, accel_z, x_raw, y_raw, z_raw, *angles = FRAME.unpack(frame)
        self._angles = tuple(angles)
        forces_mps2 = (accel_x * MPS2_PER_LSB, accel_y * MPS2_PER_LSB, accel_z * MPS2_PER_LSB)
        inertial = inertial_from((x_raw, y_raw, z_raw), forces_mps2)
        return Reading(None, None, inertial.gyro_z_dps, inertial=inertial)

    def _believed_end(self, buffer: bytes, position: int) -> int | None:
        """End of a frame as `_end`; 0 also if nothing else confirms it."""
        end = self._end(buffer, position)
        if not end or (self._in_step and self._goes_on(buffer[position:end])):
            return end
        if self._in_step:
            return None if len(buffer) - end < self.header_bytes else end if HEADS.match(buffer, end) else 0
        last: int | None = end
        for _ in range(IN_A_ROW - 1):
            last = last and self._end(buffer, last)
        return last and end

    def _goes_on(self, frame: bytes) -> bool:
        """Whether the angles follow from the last ones."""
        if frame[1] != MEASUREMENT:
            return True
        *_, roll, pitch, yaw = FRAME.unpack(frame)
        steps = (now - before for now, before in zip((roll, pitch, yaw), self._angles, strict=False))
        return all(abs((step + 32768) % 65536 - 32768) <= GOES_ON for step in steps)


PROTOCOL = WireProtocol(
    "witmotion-ble",
    "frames of the WT901BLE family, without a clock",
    WitmotionBleDecoder,
    has_clock=False,
    rank=22,
    holds_zero=True,
)
