"""Xsens MTData2: packet counter, sample time, rate of turn and temperature of each measurement; no encoder."""

import struct
from collections.abc import Iterable, Iterator
from math import isfinite, isnan, radians

from firmware_sim.measure import Block
from firmware_sim.rig import Base
from firmware_sim.wire.encoder import Axes, Frame, Measurement, WireEncoder, axes_of, in_float32, level

PREAMBLE, BUS, MTDATA2 = 0xFA, 0xFF, 0x36
US_PER_TICK = 100


def item(kind: int, content: bytes) -> bytes:
    """Id, length, content."""
    return struct.pack(">HB", kind, len(content)) + content


def mtdata2(payload: bytes) -> bytes:
    """A message whose bytes, all but the preamble, add up to 0 modulo 256."""
    message = bytes((BUS, MTDATA2, len(payload))) + payload
    return bytes((PREAMBLE,)) + message + bytes((-sum(message) & 0xFF,))


def xsens_sample(seq: int, t_us: int, rate_dps: float, temp_c: float | None, axes: Axes | None = None) -> bytes:
    """One measurement; without axes it is level, and sends no acceleration."""
    rates_rads = [in_float32(radians(dps)) for dps in (axes or level(rate_dps)).gyro_dps]
    payload = item(0x1020, struct.pack(">H", seq & 0xFFFF))
    payload += item(0x1060, struct.pack(">I", round(t_us / US_PER_TICK) & 0xFFFFFFFF))
    if axes is not None and all(map(isfinite, axes.accel_mps2)):
        payload += item(0x4020, struct.pack(">3f", *map(in_float32, axes.accel_mps2)))
    payload += item(0x8020, struct.pack(">3f", *rates_rads))
    if temp_c is not None and not isnan(temp_c):
        payload += item(0x0810, struct.pack(">f", in_float32(temp_c)))
    return mtdata2(payload)


def frames(blocks: Iterable[Block], base: Base) -> Iterator[Frame]:
    """A message per measurement."""
    for block in blocks:
        for row, axes in zip(block.rows(), axes_of(block, base), strict=True):
            seq, t_us, t_host_s, rate_raw, _, temp_centi_c, *_ = row
            yield Frame(t_host_s, xsens_sample(seq, t_us, rate_raw * base.dps_per_lsb, temp_centi_c / 100.0, axes), 1)


def recorded(measurements: Iterable[Measurement], _base: Base) -> Iterator[Frame]:
    """Frames of recorded samples; rates that are not finite are skipped."""
    for m in measurements:
        if m.is_finite:
            yield Frame(m.due_s, xsens_sample(m.seq, m.t_us, m.rate_dps, m.temp_c, m.axes), 1)


ENCODER = WireEncoder("xsens", frames, recorded)
