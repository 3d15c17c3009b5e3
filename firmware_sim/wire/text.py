"""Lines as a sketch prints them for a serial plotter: labels, milliseconds, and the counts of an MPU-6050."""

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

LINE_END = b"\r\n"
COUNTS_PER_DPS = 131.0
"""Counts per deg/s of an MPU-6050 at ±250 deg/s (register map RM-MPU-6000A, 4.19)."""


COUNTS_PER_G = 16384.0
"""Counts per g of an MPU-6050 at ±2 g (register map RM-MPU-6000A, 4.17)."""


def text_line(t_us: int, rate_dps: float, axes: Axes | None = None) -> bytes:
    """Time in ms, with decimals if needed, and rates about three axes, then accelerations if there are axes."""
    gx, gy, gz = (in_16_bits(dps * COUNTS_PER_DPS) for dps in (axes or level(rate_dps)).gyro_dps)
    whole_ms, rest_us = divmod(t_us, 1000)
    t_ms = f"{whole_ms}.{rest_us:03d}" if rest_us else f"{whole_ms}"
    return f"t_ms:{t_ms},gx:{gx},gy:{gy},gz:{gz}{_forces(axes)}".encode() + LINE_END


def _forces(axes: Axes | None) -> str:
    if axes is None or not all(map(isfinite, axes.accel_mps2)):
        return ""
    ax, ay, az = (in_16_bits(force / STANDARD_GRAVITY_MPS2 * COUNTS_PER_G) for force in axes.accel_mps2)
    return f",ax:{ax},ay:{ay},az:{az}"


def frames(blocks: Iterable[Block], base: Base) -> Iterator[Frame]:
    """A line per measurement."""
    for block in blocks:
        for (_, t_us, t_host_s, rate_raw, *_), axes in zip(block.rows(), axes_of(block, base), strict=True):
            yield Frame(t_host_s, text_line(t_us, rate_raw * base.dps_per_lsb, axes), 1, LINE_END)


def recorded(measurements: Iterable[Measurement], _base: Base) -> Iterator[Frame]:
    """Frames of recorded samples; rates that are not finite are skipped."""
    for m in measurements:
        if m.is_finite:
            yield Frame(m.due_s, text_line(m.t_us, m.rate_dps, m.axes), 1, LINE_END)


ENCODER = WireEncoder("text", frames, recorded)
