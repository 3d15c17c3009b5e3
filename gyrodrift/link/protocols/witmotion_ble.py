"""WitMotion's Bluetooth family (WT901BLE, WT9011DCL) on its USB port: `0x55 0x61`, nine numbers, no checksum, no clock.

20 bytes: accelerations, rates and angles about x, y and z, little-endian (protocol description of the WT901BLE). The
distance of 20 bytes between heads stands in for a checksum: out of step, IN_A_ROW frames right behind each other with a
believable acceleration are needed. In step a frame whose angles go on from the last one is taken at once, and any other
when the next head stands right behind it: a byte that was lost has shifted all behind it.
"""

import re
from math import hypot
from struct import Struct

from gyrodrift.link.protocols.decoder import DecoderCounters, DeviceDescription
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.link.protocols.witmotion import DPS_PER_LSB, HEADER
from gyrodrift.sample import Reading

HEAD = re.compile(rb"\x55[\x61\x71]")
"""Measurement, and the answer to a question for a register."""

MEASUREMENT = 0x61
FRAME = Struct("<2s9h")
IN_A_ROW = 4
"""Four heads of two bytes each: noise has them once in 2**64 places."""

G_PER_LSB = 16.0 / 32768.0
BELIEVABLE_G = (0.2, 8.0)
"""Length of the acceleration of a device that is looked at for the first time."""

GOES_ON = 8192
"""45 deg in counts of 180/32768 deg: by more no angle moves between two frames of 10 Hz or more, but near a pole."""


class WitmotionBleDecoder:
    """Frames by their distance."""

    name = "witmotion-ble"

    def __init__(self) -> None:
        self.counters = DecoderCounters()
        self.device = DeviceDescription(dps_per_lsb=DPS_PER_LSB)
        self._pending = b""
        self._in_step = False
        self._angles: tuple[int, ...] = ()

    def push(self, chunk: bytes) -> list[Reading]:
        """Walk from head to head."""
        readings: list[Reading] = []
        buffer, at = self._pending + chunk, 0
        while (is_frame := self._is_frame(buffer, at)) is not None:
            if is_frame:
                self._in_step = True
                self._take(buffer, at, readings)
                at += FRAME.size
            else:
                at = self._lose_step(buffer, at)
        self._pending = buffer[at:]
        return readings

    def _is_frame(self, buffer: bytes, at: int) -> bool | None:
        """Whether a frame stands there; None where more bytes have to tell."""
        left = len(buffer) - at
        if left < 2:
            return None if left == 0 or buffer[at] == HEADER else False
        if not HEAD.match(buffer, at):
            return False
        if not self._in_step:
            return _is_run(buffer, at)
        if left < FRAME.size:
            return None
        if self._goes_on(buffer, at):
            return True
        return None if left < FRAME.size + 2 else bool(HEAD.match(buffer, at + FRAME.size))

    def _goes_on(self, buffer: bytes, at: int) -> bool:
        if buffer[at + 1] != MEASUREMENT:
            return True
        *_, roll, pitch, yaw = FRAME.unpack_from(buffer, at)
        steps = (now - before for now, before in zip((roll, pitch, yaw), self._angles, strict=False))
        return all(abs((step + 32768) % 65536 - 32768) <= GOES_ON for step in steps)

    def _lose_step(self, buffer: bytes, at: int) -> int:
        if self._in_step:
            self.counters.damaged += 1
            self._in_step = False
        found = buffer.find(HEADER, at + 1)
        return found if found >= 0 else len(buffer)

    def _take(self, buffer: bytes, at: int, readings: list[Reading]) -> None:
        self.counters.frames += 1
        if buffer[at + 1] != MEASUREMENT:
            self.counters.other += 1
            return
        _, _, _, _, _, _, yaw_raw, *angles = FRAME.unpack_from(buffer, at)
        self._angles = tuple(angles)
        readings.append(Reading(None, None, yaw_raw * DPS_PER_LSB))


def _is_run(buffer: bytes, at: int) -> bool | None:
    """Whether enough believable frames stand right behind each other; None before enough of them came."""
    for start in range(at, at + IN_A_ROW * FRAME.size, FRAME.size):
        if len(buffer) - start >= 2 and not HEAD.match(buffer, start):
            return False
        if len(buffer) - start < FRAME.size:
            return None
        if buffer[start + 1] == MEASUREMENT and not _is_believable(buffer, start):
            return False
    return True


def _is_believable(buffer: bytes, at: int) -> bool:
    _, x, y, z, *_ = FRAME.unpack_from(buffer, at)
    least_g, most_g = BELIEVABLE_G
    return least_g <= hypot(x, y, z) * G_PER_LSB <= most_g


PROTOCOL = WireProtocol(
    "witmotion-ble",
    "frames of the WT901BLE family, without a clock",
    WitmotionBleDecoder,
    has_clock=False,
    rank=22,
    holds_zero=True,
)
