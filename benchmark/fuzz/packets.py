"""Changes of streams of packets: whole packets of a source, with a right checksum and any content."""

import struct
from random import Random

from gyrodrift.link.sources.can_frames import FRAME, FRAME_HEADER
from gyrodrift.link.sources.can_gyros import BOSCH_IDS, XSENS_IDS
from gyrodrift.link.sources.iio_scans import IioPacket
from gyrodrift.link.sources.mavlink_frames import EXTRAS, HEADER_2, checksum
from gyrodrift.link.sources.packets import packet
from gyrodrift.link.sources.ros_imu import MESSAGE

NAMES = ("anglvel_x", "anglvel_y", "anglvel_z", "accel_x", "temp", "timestamp")
JSON_VALUES = ("0", "-1", "0.5", "1e400", "NaN", "1" + 30 * "0", "null", "[]", "{}", '"x"', "true")
SPECIAL = (0, 1, 0x7F, 0x80, 0xFF)


def changed_packets(content: bytes, random: Random) -> bytes:
    """One to some whole packets of one source put into the stream."""
    make = random.choice((_mavlink, _iio, _can, _imu))
    made = b"".join(make(random) for _ in range(random.choice((1, 2, 3, 12))))
    start = random.randint(0, len(content))
    return content[:start] + made + content[start:]


def any_bytes(random: Random, size: int) -> bytes:
    """Random bytes, with many extreme values."""
    return bytes(random.choice((random.choice(SPECIAL), random.randrange(256))) for _ in range(size))


def _mavlink(random: Random) -> bytes:
    number = random.choice([*EXTRAS, 30])
    payload = any_bytes(random, random.choice((0, 9, 22, 24, 26, 29, 62, 63, 255)))
    addressed = bytes((len(payload), 0, 0, 1, random.randint(1, 2), 1)) + number.to_bytes(3, "little") + payload
    assert len(addressed) == HEADER_2 - 1 + len(payload)
    return b"\xfd" + addressed + struct.pack("<H", checksum(addressed + bytes((EXTRAS.get(number, 39),))))


def _iio(random: Random) -> bytes:
    kind = random.choice(list(IioPacket))
    if kind in (IioPacket.GYRO_LAYOUT, IioPacket.ACCEL_LAYOUT):
        scale = random.choice(("0.001", "1e300", "-1", "NaN", "[]"))
        channels = ", ".join(f'["{name}", "le:s16/16>>0", {scale}, 0]' for name in random.sample(NAMES, 3))
        matrix = "1, 0, 0, 0, 1, 0, 0, 0, 1"
        text = f'{{"name": "x", "rate_hz": 1, "matrix": [{matrix}], "channels": [{channels}]}}'
        return packet(kind, text.encode())
    return packet(kind, any_bytes(random, random.choice((4, 6, 8, 16, 24))))


def _can(random: Random) -> bytes:
    header = FRAME_HEADER.pack(random.getrandbits(64), random.choice((*BOSCH_IDS, *XSENS_IDS, 0x7FF)))
    return packet(FRAME, header + any_bytes(random, random.choice((0, 2, 4, 6, 8, 64))))


def _imu(random: Random) -> bytes:
    x, y, z, seconds, nanoseconds, covariance = (random.choice(JSON_VALUES) for _ in range(6))
    vector = f'{{"x": {x}, "y": {y}, "z": {z}}}'
    stamp = f'{{"stamp": {{"sec": {seconds}, "nanosec": {nanoseconds}}}}}'
    fields = f'"header": {stamp}, "angular_velocity": {vector}, "linear_acceleration": {vector}'
    text = f'{{"op": "publish", "msg": {{{fields}, "linear_acceleration_covariance": [{covariance}]}}}}'
    return packet(MESSAGE, text.encode())
