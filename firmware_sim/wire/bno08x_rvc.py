"""A BNO08x in UART-RVC mode: yaw in hundredths of a degree, a frame every 10 ms; neither rate nor clock.

The chip has one rate: whatever the rig's is, its measurements are taken as those of 100 Hz.
"""

import struct
from collections.abc import Iterable, Iterator
from math import isfinite

from firmware_sim.measure import Block
from firmware_sim.rig import Base
from firmware_sim.wire.encoder import Frame, Measurement, WireEncoder

PERIOD_S = 0.01
MOST_DPS = 1e6
"""Largest rate that is played, far beyond the range of the chip, so that no sum is infinite."""
GRAVITY_MG = 1000
Rated = tuple[float, int, float]
"""Arrival, s, counter, and rate, deg/s."""


def rvc_frame(index: int, yaw: int, pitch: int, roll: int, x_mg: int, y_mg: int, z_mg: int) -> bytes:
    """Head, index, angles in hundredths of a degree, accelerations in mg, three reserved bytes, and the sum."""
    body = struct.pack("<B6h3B", index, yaw, pitch, roll, x_mg, y_mg, z_mg, 0, 0, 0)
    return b"\xaa\xaa" + body + bytes((sum(body) & 0xFF,))


def _spoken(rated: Iterable[Rated]) -> Iterator[Frame]:
    """Yaw at power-on, then after every measurement."""
    yaw_deg, last = 0.0, None
    for t_s, seq, rate_dps in rated:
        if last is None:
            last = seq - 1
            yield Frame(t_s, _level(last, yaw_deg), 0)
        yaw_deg += max(-MOST_DPS, min(MOST_DPS, rate_dps)) * PERIOD_S * (seq - last)
        last = seq
        yield Frame(t_s, _level(seq, yaw_deg), 1)


def _level(seq: int, yaw_deg: float) -> bytes:
    yaw = (round(yaw_deg * 100.0) + 18_000) % 36_000 - 18_000
    return rvc_frame(seq & 0xFF, yaw, 0, 0, 0, 0, GRAVITY_MG)


def frames(blocks: Iterable[Block], base: Base) -> Iterator[Frame]:
    """A frame per measurement."""
    rows = (row for block in blocks for row in block.rows())
    return _spoken((t_host_s, seq, rate_raw * base.dps_per_lsb) for seq, _, t_host_s, rate_raw, *_ in rows)


def recorded(measurements: Iterable[Measurement], _base: Base) -> Iterator[Frame]:
    """Frames of recorded samples; rates that are not finite are skipped."""
    return _spoken((m.due_s, m.seq, m.rate_dps) for m in measurements if isfinite(m.rate_dps))


ENCODER = WireEncoder("bno08x-rvc", frames, recorded)
