"""The frames of a WT901: acceleration, rates and angles of each measurement; it has no clock, and no encoder."""

import struct
from collections.abc import Iterable, Iterator
from math import isfinite

from firmware_sim.constants import STANDARD_GRAVITY_MPS2
from firmware_sim.measure import Block
from firmware_sim.rig import Base
from firmware_sim.wire.encoder import (
    Axes,
    Frame,
    Measurement,
    WireEncoder,
    axes_of,
    in_16_bits,
    level,
)

DPS_PER_LSB = 2000.0 / 32768.0
MPS2_PER_LSB = 16.0 * STANDARD_GRAVITY_MPS2 / 32768.0


def wt901_frame(kind: int, *values: int) -> bytes:
    """0x55, kind, four 16-bit values, and the low byte of the sum of all before."""
    frame = struct.pack("<BBhhhh", 0x55, kind, *values)
    return frame + bytes((sum(frame) & 0xFF,))


def wt901_sample(rate_dps: float, temp_centi_c: int, axes: Axes | None = None) -> bytes:
    """Acceleration, rates and angles of one measurement, as a WT901 sends them; level without axes."""
    rates_dps, forces_mps2 = axes or level(rate_dps)
    forces = b""
    if all(map(isfinite, forces_mps2)):
        forces = wt901_frame(0x51, *(in_16_bits(force / MPS2_PER_LSB) for force in forces_mps2), temp_centi_c)
    rates = wt901_frame(0x52, *(in_16_bits(dps / DPS_PER_LSB) for dps in rates_dps), temp_centi_c)
    return forces + rates + wt901_frame(0x53, 0, 0, 0, temp_centi_c)


def frames(blocks: Iterable[Block], base: Base) -> Iterator[Frame]:
    """Three frames per measurement."""
    for block in blocks:
        for row, axes in zip(block.rows(), axes_of(block, base), strict=True):
            _, _, t_host_s, rate_raw, _, temp_centi_c, *_ = row
            yield Frame(t_host_s, wt901_sample(rate_raw * base.dps_per_lsb, temp_centi_c, axes), 1)


def recorded(measurements: Iterable[Measurement], _base: Base) -> Iterator[Frame]:
    """Frames of recorded samples; rates that are not finite are skipped."""
    for m in measurements:
        if m.is_finite:
            temp_c = m.temp_c if m.temp_c is not None and isfinite(m.temp_c) else 0.0
            yield Frame(m.due_s, wt901_sample(m.rate_dps, in_16_bits(temp_c * 100.0), m.axes), 1)


ENCODER = WireEncoder("witmotion", frames, recorded)
