"""The frames of a WT901BLE on its USB port: acceleration, rates and angles in one; no clock and no checksum."""

import struct
from collections.abc import Iterable, Iterator
from math import isfinite

from firmware_sim.measure import Block
from firmware_sim.rig import Base
from firmware_sim.wire.encoder import Frame, Measurement, WireEncoder, in_16_bits
from firmware_sim.wire.witmotion import DPS_PER_LSB, GRAVITY_RAW


def ble_frame(rate_dps: float) -> bytes:
    """0x55 0x61 and nine 16-bit values of a level device."""
    return struct.pack("<BB9h", 0x55, 0x61, 0, 0, GRAVITY_RAW, 0, 0, in_16_bits(rate_dps / DPS_PER_LSB), 0, 0, 0)


def frames(blocks: Iterable[Block], base: Base) -> Iterator[Frame]:
    """A frame per measurement."""
    for block in blocks:
        for _, _, t_host_s, rate_raw, *_ in block.rows():
            yield Frame(t_host_s, ble_frame(rate_raw * base.dps_per_lsb), 1)


def recorded(measurements: Iterable[Measurement], _base: Base) -> Iterator[Frame]:
    """Frames of recorded samples; rates that are not finite are skipped."""
    for m in measurements:
        if isfinite(m.rate_dps):
            yield Frame(m.due_s, ble_frame(m.rate_dps), 1)


ENCODER = WireEncoder("witmotion-ble", frames, recorded)
