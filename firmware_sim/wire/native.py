"""Native protocol: COBS frames with a CRC, HELLO once a second and SAMPLE per measurement."""

import struct
from collections.abc import Iterable, Iterator
from math import isfinite

from firmware_sim.measure import COUNTS_MAX, Block
from firmware_sim.rig import Base
from firmware_sim.wire.encoder import Frame, Measurement, WireEncoder, in_16_bits, in_32_bits

HELLO_TYPE, SAMPLE_TYPE, VERSION = 0x01, 0x02, 0x01
ENCODER_VALID, TEMPERATURE_VALID, RATE_CLIPPED = 0x01, 0x02, 0x04
STILL_VALID, STILL = 0x08, 0x10
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


def frames(blocks: Iterable[Block], base: Base) -> Iterator[Frame]:
    """HELLO at power-on, once a second, and after a clock restart; SAMPLE per measurement."""
    hello = hello_frame(base)
    next_hello_s = last_us = 0.0
    for block in blocks:
        always = TEMPERATURE_VALID | (ENCODER_VALID if base.encoder_cpr else 0)
        for seq, t_us, t_host_s, rate_raw, is_clipped, temp_centi_c, counts, still in block.rows():
            if t_us / 1e6 >= next_hello_s or t_us < last_us:
                yield Frame(t_host_s, hello, 0, DELIMITER)
                next_hello_s = t_us // 1_000_000 + 1.0
            last_us = t_us
            flags = always | (RATE_CLIPPED if is_clipped else 0) | still_flags(still)
            yield Frame(t_host_s, sample_frame(flags, seq, t_us, rate_raw, temp_centi_c, counts), 1, DELIMITER)


def recorded(measurements: Iterable[Measurement], base: Base) -> Iterator[Frame]:
    """HELLO once a second, and SAMPLE per sample with a finite rate."""
    hello = hello_frame(base)
    next_hello_s = 0.0
    for m in measurements:
        if m.due_s >= next_hello_s:
            yield Frame(m.due_s, hello, 0, DELIMITER)
            next_hello_s = m.due_s + 1.0
        if isfinite(m.rate_dps):
            yield Frame(m.due_s, _recorded_sample(m, base), 1, DELIMITER)


def _recorded_sample(m: Measurement, base: Base) -> bytes:
    raw = m.rate_dps / base.dps_per_lsb
    flags = RATE_CLIPPED if abs(raw) >= COUNTS_MAX + 0.5 else 0
    flags |= still_flags(-1.0 if m.still is None else m.still)
    counts = temp_centi_c = 0
    if m.encoder_deg is not None and isfinite(m.encoder_deg):
        flags |= ENCODER_VALID
        counts = in_32_bits(m.encoder_deg / 360.0 * base.encoder_cpr)
    if m.temp_c is not None and isfinite(m.temp_c):
        flags |= TEMPERATURE_VALID
        temp_centi_c = in_16_bits(m.temp_c * 100.0)
    return sample_frame(flags, m.seq, m.t_us, in_16_bits(raw), temp_centi_c, counts)


ENCODER = WireEncoder("native", frames, recorded, hello_frame)
