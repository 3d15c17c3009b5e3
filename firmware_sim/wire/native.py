"""Native protocol: COBS frames with a CRC, HELLO once a second and SAMPLE or SAMPLE3 per measurement."""

import struct
from collections.abc import Iterable, Iterator, Sequence
from itertools import repeat
from math import isfinite

from firmware_sim.constants import STANDARD_GRAVITY_MPS2
from firmware_sim.measure import COUNTS_MAX, Block, TriaxialBlock
from firmware_sim.own_filter import OwnFilter, own_filter_of
from firmware_sim.rig import Base
from firmware_sim.wire.encoder import Frame, Measurement, Vector, WireEncoder, in_16_bits, in_32_bits

HELLO_TYPE, SAMPLE_TYPE, VERSION = 0x01, 0x02, 0x01
ENCODER_VALID, TEMPERATURE_VALID, RATE_CLIPPED = 0x01, 0x02, 0x04
STILL_VALID, STILL = 0x08, 0x10
SAMPLE3_TYPE, AXES_VERSION, AXES = 0x03, 0x02, 3
ACCEL_VALID, STILL3, ACCEL_CLIPPED = 0x10, 0x20, 0x40
"""Flags of SAMPLE3; the other flags are those of SAMPLE."""

YAW_TYPE, FILTER_VERSION = 0x04, 0x03
FILTERS = {"hdr": 1, "restlevel": 2, "attitude": 3}
"""Numbers of the filters in HELLO version 3."""

RECORDED_MPS2_PER_LSB = 16.0 * STANDARD_GRAVITY_MPS2 / 32768.0
"""Scale of accelerations in a replayed recording, m/s² per count: a range of ±16 g."""

DEVICE_ID = b"firmware_sim"
DELIMITER = b"\0"


def crc16_ccitt_false(payload: bytes) -> int:
    """CRC-16/CCITT-FALSE: polynomial 0x1021, initial value 0xFFFF, bit by bit through a byte table."""
    crc = 0xFFFF
    for byte in payload:
        crc = (crc << 8 & 0xFFFF) ^ CRC_TABLE[crc >> 8 ^ byte]
    return crc


def _crc_of_byte(byte: int) -> int:
    crc = byte << 8
    for _ in range(8):
        crc = crc << 1 ^ (0x1021 if crc & 0x8000 else 0)
    return crc & 0xFFFF


CRC_TABLE = tuple(_crc_of_byte(byte) for byte in range(256))


def cobs_encode(packet: bytes) -> bytes:
    """Consistent overhead byte stuffing (Cheshire and Baker 1999) for packets under 255 bytes, without delimiter.

    Each zero is replaced by the distance to the next one; the first byte tells where the first zero stands.
    """
    return b"".join(bytes((len(run) + 1,)) + run for run in packet.split(b"\0"))


def native_frame(payload: bytes) -> bytes:
    """COBS(payload and CRC), then the delimiter."""
    return cobs_encode(payload + struct.pack("<H", crc16_ccitt_false(payload))) + DELIMITER


def hello_frame(base: Base) -> bytes:
    """HELLO with the scales."""
    return native_frame(
        struct.pack(
            "<BBHfI16s",
            HELLO_TYPE,
            VERSION,
            round(base.sample_rate_hz),
            base.dps_per_lsb,
            base.encoder_cpr,
            DEVICE_ID,
        )
    )


def axes_hello_frame(base: Base, mps2_per_lsb: float, axes: int = AXES) -> bytes:
    """HELLO version 2; `mps2_per_lsb` is 0 without an accelerometer."""
    return native_frame(
        struct.pack(
            "<BBHfI16sfB",
            HELLO_TYPE,
            AXES_VERSION,
            round(base.sample_rate_hz),
            base.dps_per_lsb,
            base.encoder_cpr,
            DEVICE_ID,
            mps2_per_lsb,
            axes,
        )
    )


def filter_hello_frame(base: Base, mps2_per_lsb: float, axes: int, filter_number: int) -> bytes:
    """HELLO version 3, of a device that runs a filter."""
    scales = (round(base.sample_rate_hz), base.dps_per_lsb, base.encoder_cpr)
    fields = (HELLO_TYPE, FILTER_VERSION, *scales, DEVICE_ID, mps2_per_lsb, axes, filter_number)
    return native_frame(struct.pack("<BBHfI16sfBB", *fields))


def yaw_frame(seq: int, t_us: int, yaw_deg: float, yaw_sigma_deg: float, bias_dps: float) -> bytes:
    """YAW of the sample with the same counter and clock; the sigma is NaN if the filter has none."""
    fields = (YAW_TYPE, 0, seq & 0xFFFF, t_us & 0xFFFFFFFF, yaw_deg, yaw_sigma_deg, bias_dps)
    return native_frame(struct.pack("<BBHIfff", *fields))


def axes_sample_frame(
    flags: int,
    seq: int,
    t_us: int,
    gyro_raw: Sequence[int],
    accel_raw: Sequence[int],
    temp_centi_c: int,
    encoder_counts: int,
) -> bytes:
    """SAMPLE3 with counts about x, y and z; counter, clock and encoder wrap."""
    counts = (encoder_counts + 0x80000000) % 0x100000000 - 0x80000000
    fields = (SAMPLE3_TYPE, flags, seq & 0xFFFF, t_us & 0xFFFFFFFF, *gyro_raw, *accel_raw, temp_centi_c, counts)
    return native_frame(struct.pack("<BBHI7hi", *fields))


def axes_flags(flags: int) -> int:
    """Flags of SAMPLE as flags of SAMPLE3, without its own."""
    return flags & ~STILL | (STILL3 if flags & STILL else 0)


def sample_frame(flags: int, seq: int, t_us: int, rate_raw: int, temp_centi_c: int, encoder_counts: int) -> bytes:
    """SAMPLE; counter, clock and encoder wrap like registers of the device."""
    counts = (encoder_counts + 0x80000000) % 0x100000000 - 0x80000000
    fields = (SAMPLE_TYPE, flags, seq & 0xFFFF, t_us & 0xFFFFFFFF, rate_raw, temp_centi_c, counts)
    return native_frame(struct.pack("<BBHIhhi", *fields))


def still_flags(still: float) -> int:
    """Flags of the reported rest: 1 at rest, 0 in motion, anything else is not reported."""
    if still == 1:
        return STILL_VALID | STILL
    return STILL_VALID if still == 0 else 0


def greeting(base: Base) -> bytes:
    """HELLO of a device, with the version for its axes and its filter."""
    axes = base.three_axes
    if base.own_yaw is not None:
        mps2_per_lsb = 0.0 if axes is None else axes.mps2_per_lsb
        return filter_hello_frame(base, mps2_per_lsb, 1 if axes is None else AXES, FILTERS[base.own_yaw])
    return hello_frame(base) if axes is None else axes_hello_frame(base, axes.mps2_per_lsb)


def frames(blocks: Iterable[Block], base: Base) -> Iterator[Frame]:
    """HELLO at power-on, once a second, and after a clock restart; SAMPLE or SAMPLE3, and YAW, per measurement."""
    hello, own_filter = greeting(base), own_filter_of(base)
    next_hello_s = last_us = 0.0
    for block in blocks:
        samples = _axes_samples(block, base) if isinstance(block, TriaxialBlock) else _samples(block, base)
        own_yaws = _own_yaws(block, own_filter)
        for (t_us, t_host_s), sample, own_yaw in zip(_times(block), samples, own_yaws, strict=True):
            if t_us / 1e6 >= next_hello_s or t_us < last_us:
                yield Frame(t_host_s, hello, 0, DELIMITER)
                next_hello_s = t_us // 1_000_000 + 1.0
            last_us = t_us
            yield Frame(t_host_s, sample, 1, DELIMITER)
            if own_yaw:
                yield Frame(t_host_s, own_yaw, 0, DELIMITER)


def _own_yaws(block: Block, own_filter: OwnFilter | None) -> Iterator[bytes]:
    """YAW of each row; empty without a filter."""
    if own_filter is None:
        yield from repeat(b"", len(block.seq))
        return
    counters = zip(block.seq.tolist(), block.t_device_us.tolist(), strict=True)
    for (seq, t_us), values in zip(counters, own_filter.results(block), strict=True):
        yield yaw_frame(seq, t_us, *values)


def _times(block: Block) -> Iterator[tuple[int, float]]:
    return zip(block.t_device_us.tolist(), block.t_host_s.tolist(), strict=True)


def _samples(block: Block, base: Base) -> Iterator[bytes]:
    """SAMPLE of each row."""
    always = TEMPERATURE_VALID | (ENCODER_VALID if base.encoder_cpr else 0)
    for seq, t_us, _, rate_raw, is_clipped, temp_centi_c, counts, still in block.rows():
        flags = always | (RATE_CLIPPED if is_clipped else 0) | still_flags(still)
        yield sample_frame(flags, seq, t_us, rate_raw, temp_centi_c, counts)


def _axes_samples(block: TriaxialBlock, base: Base) -> Iterator[bytes]:
    """SAMPLE3 of each row; a missing acceleration is 0 and not valid."""
    always = TEMPERATURE_VALID | (ENCODER_VALID if base.encoder_cpr else 0)
    for row, (gyro_raw, accel_raw, accel_clipped) in zip(block.rows(), block.axes_rows(), strict=True):
        seq, t_us, _, _, is_clipped, temp_centi_c, counts, still = row
        flags = axes_flags(always | (RATE_CLIPPED if is_clipped else 0) | still_flags(still))
        if accel_raw is not None:
            flags |= ACCEL_VALID | (ACCEL_CLIPPED if accel_clipped else 0)
        yield axes_sample_frame(flags, seq, t_us, gyro_raw, accel_raw or (0, 0, 0), temp_centi_c, counts)


def recorded(measurements: Iterable[Measurement], base: Base) -> Iterator[Frame]:
    """HELLO once a second, and SAMPLE or SAMPLE3 per sample with finite rates."""
    next_hello_s = 0.0
    for m in measurements:
        if m.due_s >= next_hello_s:
            hello = hello_frame(base) if m.gyro_dps is None else axes_hello_frame(base, RECORDED_MPS2_PER_LSB)
            yield Frame(m.due_s, hello, 0, DELIMITER)
            next_hello_s = m.due_s + 1.0
        if m.is_finite:
            yield Frame(m.due_s, _recorded_sample(m, base), 1, DELIMITER)


def _recorded_sample(m: Measurement, base: Base) -> bytes:
    raw = [rate_dps / base.dps_per_lsb for rate_dps in m.gyro_dps or (m.rate_dps,)]
    flags = RATE_CLIPPED if any(abs(count) >= COUNTS_MAX + 0.5 for count in raw) else 0
    flags |= still_flags(-1.0 if m.still is None else m.still)
    counts = temp_centi_c = 0
    if m.encoder_deg is not None and isfinite(m.encoder_deg):
        flags |= ENCODER_VALID
        counts = in_32_bits(m.encoder_deg / 360.0 * base.encoder_cpr)
    if m.temp_c is not None and isfinite(m.temp_c):
        flags |= TEMPERATURE_VALID
        temp_centi_c = in_16_bits(m.temp_c * 100.0)
    gyro_raw = list(map(in_16_bits, raw))
    if m.gyro_dps is None:
        return sample_frame(flags, m.seq, m.t_us, gyro_raw[0], temp_centi_c, counts)
    accel_flags, accel_raw = _recorded_accelerations(m.accel_mps2)
    return axes_sample_frame(axes_flags(flags) | accel_flags, m.seq, m.t_us, gyro_raw, accel_raw, temp_centi_c, counts)


def _recorded_accelerations(accel_mps2: Vector | None) -> tuple[int, list[int]]:
    """Flags and counts of accelerations."""
    if accel_mps2 is None or not all(map(isfinite, accel_mps2)):
        return 0, [0, 0, 0]
    raw = [value / RECORDED_MPS2_PER_LSB for value in accel_mps2]
    is_clipped = any(abs(count) >= COUNTS_MAX + 0.5 for count in raw)
    return ACCEL_VALID | (ACCEL_CLIPPED if is_clipped else 0), list(map(in_16_bits, raw))


ENCODER = WireEncoder("native", frames, recorded, greeting)
