"""VectorNav binary output of the common group: TimeStartup, AngularRate and MagPres, in a frame with a CRC-16."""

import struct
from collections.abc import Iterable, Iterator
from math import isfinite, isnan, radians

from firmware_sim.measure import Block
from firmware_sim.rig import Base
from firmware_sim.wire.encoder import Axes, Frame, Measurement, WireEncoder, axes_of, in_float32, level
from firmware_sim.wire.native import CRC_TABLE

SYNC, COMMON = 0xFA, 0x01
TIME_STARTUP, ANGULAR_RATE, ACCEL, MAG_PRES = 1 << 0, 1 << 5, 1 << 8, 1 << 10
PRESSURE_KPA = 101.325
MOST_64_BITS = 2**64 - 1


def crc16_ccitt(content: bytes) -> int:
    """Polynomial 0x1021, initial value 0."""
    crc = 0
    for byte in content:
        crc = (crc << 8 & 0xFFFF) ^ CRC_TABLE[crc >> 8 ^ byte]
    return crc


def vectornav_frame(fields: int, payload: bytes) -> bytes:
    """Sync, the common group with these fields, payload, and the CRC of all but sync, its high byte first."""
    content = struct.pack("<BH", COMMON, fields) + payload
    return bytes((SYNC,)) + content + struct.pack(">H", crc16_ccitt(content))


def vectornav_sample(t_us: int, rate_dps: float, temp_c: float, axes: Axes | None = None) -> bytes:
    """One measurement; its z axis points down. Without axes it is level, and sends no acceleration."""
    x_rads, y_rads, z_rads = (in_float32(radians(dps)) for dps in (axes or level(rate_dps)).gyro_dps)
    fields, payload = TIME_STARTUP | ANGULAR_RATE | MAG_PRES, struct.pack("<Q", t_us * 1000 & MOST_64_BITS)
    payload += struct.pack("<3f", x_rads, 0.0 - y_rads, -z_rads)
    if axes is not None and all(map(isfinite, axes.accel_mps2)):
        fields |= ACCEL
        x_mps2, y_mps2, z_mps2 = map(in_float32, axes.accel_mps2)
        payload += struct.pack("<3f", x_mps2, -y_mps2, -z_mps2)
    payload += struct.pack("<5f", 0.0, 0.0, 0.0, in_float32(temp_c), PRESSURE_KPA)
    return vectornav_frame(fields, payload)


def frames(blocks: Iterable[Block], base: Base) -> Iterator[Frame]:
    """A frame per measurement."""
    for block in blocks:
        for row, axes in zip(block.rows(), axes_of(block, base), strict=True):
            _, t_us, t_host_s, rate_raw, _, temp_centi_c, *_ = row
            sample = vectornav_sample(t_us, rate_raw * base.dps_per_lsb, temp_centi_c / 100.0, axes)
            yield Frame(t_host_s, sample, 1)


def recorded(measurements: Iterable[Measurement], _base: Base) -> Iterator[Frame]:
    """Frames of recorded samples; rates that are not finite are skipped."""
    for m in measurements:
        if m.is_finite:
            temp_c = m.temp_c if m.temp_c is not None and not isnan(m.temp_c) else 0.0
            yield Frame(m.due_s, vectornav_sample(m.t_us, m.rate_dps, temp_c, m.axes), 1)


ENCODER = WireEncoder("vectornav", frames, recorded)
