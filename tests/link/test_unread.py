"""Protocols that are known and not read: named by their bytes, each with a check of its own."""

import struct
from binascii import crc_hqx
from collections.abc import Callable
from dataclasses import replace
from functools import reduce
from math import sin
from operator import xor
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pynmeagps import GET, NMEAMessage
from sources_support import Host
from support import speaking_on

from gyrodrift.link.binary_frames import crc16_reflected, crc32_mpeg2
from gyrodrift.link.unread import FAILED_MAX, UNREAD, spoken
from gyrodrift.values.errors import DeviceSilentError


def mip(i: int) -> bytes:
    """Rates and accelerations, a field each, and the two sums of RFC 1145."""
    fields = struct.pack(">BBfff", 14, 0x05, 0.1, 0.2, sin(i)) + struct.pack(">BBfff", 14, 0x04, 0.0, 0.0, 1.0)
    content = b"\x75\x65\x80" + bytes((len(fields),)) + fields
    first = second = 0
    for byte in content:
        first = (first + byte) % 256
        second = (second + first) % 256
    return content + bytes((first, second))


def um7(i: int) -> bytes:
    """A batch of three registers of processed rates."""
    content = b"snp" + bytes((0x80 | 0x40 | 3 << 2, 0x61)) + struct.pack(">3f", 0.0, 1.0, sin(i))
    return content + struct.pack(">H", sum(content))


def x25(content: bytes) -> int:
    crc = 0xFFFF
    for byte in content:
        word = (byte ^ crc) & 0xFF
        word = (word ^ word << 4) & 0xFF
        crc = crc >> 8 ^ word << 8 ^ word << 3 ^ word >> 4
    return crc & 0xFFFF


def mavlink1(i: int) -> bytes:
    """ATTITUDE, whose extra byte is 39, and HEARTBEAT with 50 in turns."""
    kind, extra, payload = (30, 39, struct.pack("<I6f", i, *[sin(i)] * 6)) if i % 2 else (0, 50, bytes(9))
    content = bytes((len(payload), i & 0xFF, 1, 1, kind)) + payload
    return b"\xfe" + content + struct.pack("<H", x25(content + bytes((extra,))))


def mavlink2(i: int) -> bytes:
    """ATTITUDE, signed each third time."""
    is_signed, payload = not i % 3, struct.pack("<I6f", i, *[sin(i)] * 6)
    content = bytes((len(payload), is_signed, 0, i & 0xFF, 1, 1, 30, 0, 0)) + payload
    return b"\xfd" + content + struct.pack("<H", x25(content + b"\x27")) + bytes(13 * is_signed)


def rosserial(i: int) -> bytes:
    """A message of topic 125."""
    length, body = struct.pack("<H", 12), struct.pack("<H3f", 125, 0.0, 1.0, sin(i))
    return b"\xff\xfe" + length + bytes((255 - sum(length) % 256,)) + body + bytes((255 - sum(body) % 256,))


def teapot(i: int) -> bytes:
    """A quaternion, as the example of i2cdevlib sends it."""
    return b"$\x02" + struct.pack(">4h", 16384, 0, 0, i) + bytes((0, i & 0xFF)) + b"\r\n"


def mtdata(i: int) -> bytes:
    """Rates and accelerations of an MTi of the third generation."""
    content = b"\xff\x32" + bytes((26,)) + struct.pack(">6fH", 0.0, 0.0, 9.81, 0.0, 0.0, sin(i), i)
    return b"\xfa" + content + bytes((-sum(content) & 0xFF,))


def ubx(i: int) -> bytes:
    """NAV-PVT, shortened."""
    content = struct.pack("<BBHI", 0x01, 0x07, 24, i) + bytes(20)
    first = second = 0
    for byte in content:
        first = (first + byte) % 256
        second = (second + first) % 256
    return b"\xb5\x62" + content + bytes((first, second))


def rtcm(i: int) -> bytes:
    """A CRC of 24 bits by long division."""
    content = b"\xd3\x00\x13" + struct.pack(">HI", 1005 << 4, i) + bytes(13)
    rest = int.from_bytes(content, "big") << 24
    for bit in range(rest.bit_length() - 1, 23, -1):
        if rest >> bit & 1:
            rest ^= 0x1864CFB << bit - 24
    return content + rest.to_bytes(3, "big")


def crc32_from_0(content: bytes) -> int:
    crc = 0
    for byte in content:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0xEDB88320 if crc & 1 else 0)
    return crc


def novatel(i: int) -> bytes:
    """A log of 20 bytes behind a header of 28."""
    content = struct.pack("<3sBHBBH", b"\xaa\x44\x12", 28, 507, 0, 32, 20) + bytes(18) + struct.pack("<5I", *[i] * 5)
    return content + struct.pack("<I", crc32_from_0(content))


def novatel_short(i: int) -> bytes:
    """RAWIMUSX."""
    content = struct.pack("<3sBHHI", b"\xaa\x44\x13", 40, 1462, 2000, i) + bytes(40)
    return content + struct.pack("<I", crc32_from_0(content))


def hipnuc(i: int) -> bytes:
    """Its CRC begins with 0, and leaves itself out."""
    head, payload = b"\x5a\xa5" + struct.pack("<H", 16), struct.pack("<4f", 0.0, 1.0, 2.0, sin(i))
    return head + struct.pack("<H", crc_hqx(payload, crc_hqx(head, 0))) + payload


def navx(i: int) -> bytes:
    """Gyro registers in hexadecimal digits."""
    content = b"!g%04X%04X%04X" % (0, 1, i)
    return content + b"%02X\r\n" % (sum(content) % 256)


def navx_damaged(i: int) -> bytes:
    """A message of the right form."""
    return b"!y%+07.2f+000.53-001.20+123.40A5\r\n" % (i / 7 % 180)


def position(i: int) -> bytes:
    content: bytes = NMEAMessage("GP", "GLL", GET, lat=43.2, NS="N", lon=i / 90, EW="W", status="A").serialize()
    return content


def kvh(i: int) -> bytes:
    """Format A of the 1750: rates, accelerations, status, counter, temperature."""
    content = b"\xfe\x81\xff\x55" + struct.pack(">6fBBh", 0.0, 0.0, sin(i), 0.0, 0.0, 1.0, 0x77, i & 0x7F, 25)
    return content + struct.pack(">I", crc32_mpeg2(content))


def sbg(i: int) -> bytes:
    """IMU data, class 0, message 3."""
    content = bytes((3, 0)) + struct.pack("<HIH6f", 30, i, 0, 0.0, 0.0, 9.81, 0.0, 0.0, sin(i))
    return b"\xff\x5a" + content + struct.pack("<H", crc16_reflected(content, 0, 0x8408)) + b"\x33"


def lpbus(i: int) -> bytes:
    """Stream of sensor 1."""
    content = struct.pack("<HHH4f", 1, 9, 16, i / 400, 0.0, 0.0, sin(i))
    return b":" + content + struct.pack("<H", sum(content)) + b"\r\n"


def openimu(i: int) -> bytes:
    """Packet z1 of an OpenIMU300."""
    content = b"z1" + bytes((40,)) + struct.pack("<I9f", i, 0.0, 0.0, 9.8, 0.0, 0.0, sin(i), 0.0, 0.0, 0.0)
    return b"UU" + content + struct.pack(">H", crc_hqx(content, 0x1D0F))


def msp(i: int) -> bytes:
    """MSP_RAW_IMU."""
    content = bytes((18, 102)) + struct.pack("<9h", 0, 0, 512, 0, 0, i, 0, 0, 0)
    return b"$M>" + content + bytes((reduce(xor, content),))


def msp2(i: int) -> bytes:
    """MSP_RAW_IMU in the second version."""
    content = struct.pack("<BHH9h", 0, 102, 18, 0, 0, 512, 0, 0, i, 0, 0, 0)
    return b"$X>" + content + bytes((crc8_dvb_s2(content),))


def crc8_dvb_s2(content: bytes) -> int:
    crc = 0
    for byte in content:
        crc ^= byte
        for _ in range(8):
            crc = (crc * 2 ^ 0xD5) & 0xFF if crc > 0x7F else crc * 2
    return crc


def shtp(i: int) -> bytes:
    """A report on channel 3, with its escapes."""
    cargo = struct.pack("<HBB", 14, 3, i & 0xFF) + struct.pack("<BB4h", 2, i & 0xFF, 0x7E, 0x7D, 0, i)
    escaped = b"".join(bytes((0x7D, byte ^ 0x20)) if byte in {0x7D, 0x7E} else bytes((byte,)) for byte in cargo)
    return b"\x7e\x01" + escaped + b"\x7e"


def anpp(i: int) -> bytes:
    """Raw sensors, packet 28."""
    content = struct.pack("<12f", 0.0, 0.0, 9.8, 0.0, 0.0, sin(i), 0.0, 0.0, 0.0, 25.0, 1e5, 20.0)
    head = bytes((28, len(content))) + struct.pack("<H", crc_hqx(content, 0xFFFF))
    return bytes(((sum(head) ^ 0xFF) + 1 & 0xFF,)) + head + content


SPOKEN: dict[str, Callable[[int], bytes]] = {
    "MicroStrain MIP": mip,
    "UM6 or UM7": um7,
    "MAVLink 1": mavlink1,
    "MAVLink 2": mavlink2,
    "rosserial": rosserial,
    "teapot packets": teapot,
    "MTData": mtdata,
    "UBX": ubx,
    "RTCM 3": rtcm,
    "NovAtel binary": novatel,
    "NovAtel short": novatel_short,
    "HiPNUC": hipnuc,
    "KVH": kvh,
    "sbgECom": sbg,
    "LpBus": lpbus,
    "UU packets": openimu,
    "MSP of Betaflight": msp,
    "MSP 2": msp2,
    "RAWIMU": lambda i: b"%%RAWIMUSA,1105,4253.%03d;1105,4253.%03d,00000077,1,2,3,%d,5,6*%08x\r\n" % (i, i, i, i),
    "SHTP": shtp,
    "ANPP": anpp,
    "messages of a navX other": navx,
    "yaw messages (!y) of a navX": navx_damaged,
    "rate of turn in deg/min, positive to starboard": lambda i: b"$TIROT,%d.5,A\r\n" % -i,
    "NMEA 0183 without a rate of turn ($--ROT) or": position,
    "are headings in degrees, clockwise": lambda i: b"$HCHDG,%d.5,,,12.6,W\r\n" % i,
}


def test_each_that_is_known_has_a_stream_here() -> None:
    assert len(SPOKEN) == len(UNREAD)
    for name, frame in SPOKEN.items():
        stream = b"".join(frame(i) for i in range(250, 300))
        for cut in (0, 1, 5):
            result = spoken(stream[cut:])
            assert result is not None, name
            assert name in result.name


@pytest.mark.parametrize("name", SPOKEN)
def test_a_damaged_frame_hides_no_protocol(name: str) -> None:
    """Nor a byte that was lost."""
    frames = [SPOKEN[name](i) for i in range(30)]
    frames[5], frames[11] = frames[5][:3] + frames[5][4:], frames[11][:-1]
    result = spoken(b"".join(frames))
    assert result is not None
    assert name in result.name


@pytest.mark.parametrize("noise", [b"\xd3\x03\xff", b"ue", b"snp\xff", b"!a", b"\xb5\x62\x00\x00\xff\x7f", b"\xfe"])
def test_heads_without_end_are_given_up(noise: bytes) -> None:
    checks = []

    def is_whole(frame: bytes) -> bool:
        checks.append(frame)
        return False

    for item in UNREAD:
        checks.clear()
        assert not replace(item, is_whole=is_whole).is_spoken(noise * 10_000)
        assert len(checks) <= FAILED_MAX


@pytest.mark.parametrize("name", SPOKEN)
def test_two_frames_are_too_few(name: str) -> None:
    assert spoken(SPOKEN[name](1) + SPOKEN[name](2)) is None


@pytest.mark.promise("Text and units")
@given(st.binary(max_size=3000))
def test_random_bytes_are_none_of_them(noise: bytes) -> None:
    """Random bytes are not taken for a known protocol."""
    assert spoken(noise) is None
    for head in (b"\x75\x65", b"\xfe\x09", b"\xb5\x62", b"\xfa\xff\x32", b"\xff\xfe"):
        assert spoken(head.join(noise[i : i + 11] for i in range(0, len(noise), 11))) is None


@pytest.mark.promise("Text and units")
@pytest.mark.parametrize("name", SPOKEN)
def test_the_link_names_it_and_suspects_no_line_rate(port: Path, name: str) -> None:
    """A known protocol that gyrodrift does not read is named, and no baud rate is suspected."""
    frames = map(SPOKEN[name], range(500))
    with speaking_on(port) as device, Host(port, timeout_s=4.0) as host:
        with pytest.raises(DeviceSilentError, match="the device sends") as refused:
            host.hear(device, frames, 0.02)
        assert name in str(refused.value)
        assert "baud" not in str(refused.value)
        assert host.link.baud == 115200


@pytest.mark.promise("Text and units")
@pytest.mark.parametrize(
    ("options", "what"),
    [
        ({"protocol": "csv"}, "the device sends bno08x-rvc, not csv; leave out --protocol csv"),
        ({"columns": "t_ms, rate:dps"}, "the device sends bno08x-rvc, not text; leave out --columns"),
    ],
)
def test_a_device_that_speaks_another_protocol_than_was_asked_for_is_named(
    port: Path, options: dict[str, Any], what: str
) -> None:
    """A device with another protocol than requested is named."""

    def frame(i: int) -> bytes:
        body = struct.pack("<B6h3B", i & 0xFF, 0, 0, 0, 0, 0, 1000, 0, 0, 0)
        return b"\xaa\xaa" + body + bytes((sum(body) & 0xFF,))

    with speaking_on(port) as device, Host(port, timeout_s=4.0, **options) as host:
        with pytest.raises(DeviceSilentError, match=what):
            host.hear(device, map(frame, range(500)), 0.02)
        assert host.link.baud == 115200
