"""Messages of sources in one stream of bytes, and changes of it: whole frames of MAVLink, and packets of the others.

A packet is two bytes of head, a kind that is not used, two bytes of length, and the content.
"""

import struct
from collections.abc import Iterator
from random import Random

from pymavlink.dialects.v20 import common

from gyrodrift.link.sources.can import BOSCH_IDS, XSENS_IDS

HEAD, HEADER = b"\xa7\x1d", struct.Struct("<2sBH")
CAN_HEADER = struct.Struct("<QI")
"""Time of reception and id before the content of a frame."""

MAVLINK_IDS = (0, 26, 27, 30, 105, 116, 129)
"""HEARTBEAT, ATTITUDE, and the messages with rates."""

JSON_VALUES = ("0", "-1", "0.5", "1e400", "NaN", "1" + 30 * "0", "null", "[]", "{}", '"x"', "true")
SPECIAL = (0, 1, 0x7F, 0x80, 0xFF)


def changed_packets(content: bytes, random: Random) -> bytes:
    """One to some whole packets of one source put into the stream."""
    make = random.choice((_mavlink, _iio, _can, _imu))
    made = b"".join(make(random) for _ in range(random.choice((1, 2, 3, 12))))
    start = random.randint(0, len(content))
    return content[:start] + made + content[start:]


def packet(content: bytes) -> bytes:
    """A packet."""
    return HEADER.pack(HEAD, 1, len(content)) + content


def packets_of(content: bytes) -> Iterator[bytes]:
    """Contents of the packets in a stream."""
    position = content.find(HEAD)
    while 0 <= position <= len(content) - HEADER.size:
        _, _, length = HEADER.unpack_from(content, position)
        yield content[position + HEADER.size : position + HEADER.size + length]
        position = content.find(HEAD, position + 1)


def any_bytes(random: Random, size: int) -> bytes:
    """Random bytes, with many extreme values."""
    return bytes(random.choice((random.choice(SPECIAL), random.randrange(256))) for _ in range(size))


def _mavlink(random: Random) -> bytes:
    number = random.choice(MAVLINK_IDS)
    payload = any_bytes(random, random.choice((0, 9, 22, 24, 26, 29, 62, 63, 255)))
    addressed = bytes((len(payload), 0, 0, 1, random.randint(1, 2), 1)) + number.to_bytes(3, "little") + payload
    crc = common.x25crc(addressed + bytes((common.mavlink_map[number].crc_extra,))).crc
    return b"\xfd" + addressed + struct.pack("<H", crc)


def _iio(random: Random) -> bytes:
    return packet(any_bytes(random, random.choice((8, 16, 16, 24))))


def _can(random: Random) -> bytes:
    header = CAN_HEADER.pack(random.getrandbits(64), random.choice((*BOSCH_IDS, *XSENS_IDS, 0x7FF)))
    return packet(header + any_bytes(random, random.choice((0, 2, 4, 6, 8, 64))))


def _imu(random: Random) -> bytes:
    x, y, z, seconds, nanoseconds, covariance = (random.choice(JSON_VALUES) for _ in range(6))
    vector = f'{{"x": {x}, "y": {y}, "z": {z}}}'
    stamp = f'{{"stamp": {{"sec": {seconds}, "nanosec": {nanoseconds}}}}}'
    fields = f'"header": {stamp}, "angular_velocity": {vector}, "linear_acceleration": {vector}'
    text = f'{{"op": "publish", "msg": {{{fields}, "linear_acceleration_covariance": [{covariance}]}}}}'
    return packet(text.encode())
