"""What the device says: measurements as native frames, csv lines or WitMotion frames.

Written from the protocol, not from the host's decoders: a codec that both ends share would hide its own bugs.
"""

import struct
from collections.abc import Callable, Iterator
from math import floor, log10
from typing import NamedTuple

from firmware_sim.measure import Block
from firmware_sim.rig import Base

HELLO_TYPE, SAMPLE_TYPE, VERSION = 0x01, 0x02, 0x01
ENCODER_VALID, TEMPERATURE_VALID, RATE_CLIPPED = 0x01, 0x02, 0x04
DEVICE_ID = b"firmware_sim"

WT901_DPS_PER_LSB = 2000.0 / 32768.0
WT901_GRAVITY_RAW = 2048
"""1 g at the ±16 g range over 16 bits: what a level device says on its z axis."""


class Frame(NamedTuple):
    """Bytes that leave together; `t_s` is when the host has them, in s since power-on.

    `rows` is how many measurements are in it: 0 for HELLO.
    """

    t_s: float
    content: bytes
    rows: int


Speech = Callable[[Iterator[Block], Base], Iterator[Frame]]


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
    return cobs_encode(payload + struct.pack("<H", crc16_ccitt_false(payload))) + b"\0"


def hello_frame(base: Base) -> bytes:
    """HELLO, which tells the scale of everything else."""
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
    """SAMPLE; counter, clock and encoder wrap as the device's registers do."""
    counts = (encoder_counts + 0x80000000) % 0x100000000 - 0x80000000
    fields = (SAMPLE_TYPE, flags, seq & 0xFFFF, t_us & 0xFFFFFFFF, rate_raw, temp_centi_c, counts)
    return native_frame(struct.pack("<BBHIhhi", *fields))


def csv_line(t_us: int, rate_dps: float, encoder_deg: float | None, temp_c: float | None) -> bytes:
    """A line with the fewest digits that tell each number from all others; what is absent before a value is nan."""
    values = [rate_dps, encoder_deg, temp_c]
    while values[-1] is None:
        values.pop()
    texts = ("nan" if value is None else repr(value) for value in values)
    return f"{t_us & 0xFFFFFFFF},{','.join(texts)}\r\n".encode()


def wt901_frame(kind: int, *values: int) -> bytes:
    """0x55, kind, four 16-bit values, and the low byte of the sum of all before."""
    frame = struct.pack("<BBhhhh", 0x55, kind, *values)
    return frame + bytes((sum(frame) & 0xFF,))


def wt901_sample(rate_dps: float, temp_centi_c: int) -> bytes:
    """Acceleration, rates and angles of one measurement, as a WT901 sends them."""
    raw = max(-32768, min(32767, round(rate_dps / WT901_DPS_PER_LSB)))
    return (
        wt901_frame(0x51, 0, 0, WT901_GRAVITY_RAW, temp_centi_c)
        + wt901_frame(0x52, 0, 0, raw, temp_centi_c)
        + wt901_frame(0x53, 0, 0, 0, temp_centi_c)
    )


def native(blocks: Iterator[Block], base: Base) -> Iterator[Frame]:
    """HELLO at power-on, once a second, and where the clock has begun anew; SAMPLE for each measurement."""
    hello = hello_frame(base)
    next_hello_s = last_us = 0.0
    for block in blocks:
        always = TEMPERATURE_VALID | (ENCODER_VALID if base.encoder_cpr else 0)
        for seq, t_us, t_host_s, rate_raw, is_clipped, temp_centi_c, counts in block.rows():
            if t_us / 1e6 >= next_hello_s or t_us < last_us:
                yield Frame(t_host_s, hello, 0)
                next_hello_s = t_us // 1_000_000 + 1.0
            last_us = t_us
            flags = always | (RATE_CLIPPED if is_clipped else 0)
            yield Frame(t_host_s, sample_frame(flags, seq, t_us, rate_raw, temp_centi_c, counts), 1)


def csv(blocks: Iterator[Block], base: Base) -> Iterator[Frame]:
    """A banner, then a line for each measurement, as a hobby sketch prints them."""
    yield Frame(0.0, b"# t_us,rate_dps,encoder_deg,temp_c\r\n", 0)
    deg_per_count = 360.0 / base.encoder_cpr if base.encoder_cpr else 0.0
    rate_digits, angle_digits = _digits(base.dps_per_lsb), _digits(deg_per_count or 1.0)
    for block in blocks:
        for _, t_us, t_host_s, rate_raw, _, temp_centi_c, counts in block.rows():
            angle_deg = round(counts * deg_per_count, angle_digits) if deg_per_count else None
            line = csv_line(t_us, round(rate_raw * base.dps_per_lsb, rate_digits), angle_deg, temp_centi_c / 100.0)
            yield Frame(t_host_s, line, 1)


def _digits(step: float) -> int:
    """Decimals that tell every multiple of a step from the next, with one to spare."""
    return max(4, 2 - floor(log10(step)))


def witmotion(blocks: Iterator[Block], base: Base) -> Iterator[Frame]:
    """The frames of a WT901 for each measurement; it has no clock to tell, and no encoder."""
    for block in blocks:
        for _, _, t_host_s, rate_raw, _, temp_centi_c, _ in block.rows():
            yield Frame(t_host_s, wt901_sample(rate_raw * base.dps_per_lsb, temp_centi_c), 1)


PROTOCOLS: dict[str, Speech] = {"native": native, "csv": csv, "witmotion": witmotion}
