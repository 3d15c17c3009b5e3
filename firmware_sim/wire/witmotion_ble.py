"""The frames of a WT901BLE on its USB port: acceleration, rates and angles in one; no clock and no checksum."""

import struct
from collections.abc import Iterable, Iterator
from math import isfinite

from firmware_sim.measure import Block
from firmware_sim.rig import Base
from firmware_sim.wire.encoder import Axes, Frame, Measurement, WireEncoder, axes_of, in_16_bits, level
from firmware_sim.wire.witmotion import DPS_PER_LSB, MPS2_PER_LSB


def ble_frame(rate_dps: float, axes: Axes | None = None) -> bytes:
    """0x55 0x61 and nine 16-bit values; level without axes, and with a missing acceleration."""
    rates_dps, forces_mps2 = axes or level(rate_dps)
    if not all(map(isfinite, forces_mps2)):
        forces_mps2 = level(rate_dps).accel_mps2
    forces_raw = [in_16_bits(force / MPS2_PER_LSB) for force in forces_mps2]
    rates_raw = [in_16_bits(dps / DPS_PER_LSB) for dps in rates_dps]
    return struct.pack("<BB9h", 0x55, 0x61, *forces_raw, *rates_raw, 0, 0, 0)


def frames(blocks: Iterable[Block], base: Base) -> Iterator[Frame]:
    """A frame per measurement."""
    for block in blocks:
        for (_, _, t_host_s, rate_raw, *_), axes in zip(block.rows(), axes_of(block, base), strict=True):
            yield Frame(t_host_s, ble_frame(rate_raw * base.dps_per_lsb, axes), 1)


def recorded(measurements: Iterable[Measurement], _base: Base) -> Iterator[Frame]:
    """Frames of recorded samples; rates that are not finite are skipped."""
    for m in measurements:
        if m.is_finite:
            yield Frame(m.due_s, ble_frame(m.rate_dps, m.axes), 1)


ENCODER = WireEncoder("witmotion-ble", frames, recorded)
