"""Devices that send an angle and no rate: each form is read as the angle that it is, and turned the right way round."""

from collections.abc import Callable
from functools import reduce
from itertools import pairwise
from math import cos, radians, sin
from operator import xor
from pathlib import Path
from struct import pack

import pytest
from hypothesis import given
from hypothesis import strategies as st
from sources_support import Host
from support import speaking_on

from gyrodrift.link.protocols.decoder import ANGLES_BEFORE
from gyrodrift.link.protocols.navx import NavxDecoder
from gyrodrift.link.protocols.nmea import AskedNmeaDecoder, NmeaDecoder
from gyrodrift.link.protocols.vectornav_ascii import VectornavAsciiDecoder
from gyrodrift.link.protocols.witmotion import WitmotionDecoder
from gyrodrift.link.protocols.xsens import XsensDecoder
from gyrodrift.values.quaternion import yaw_of
from gyrodrift.values.sample import Reading, Sample

TRUE_DEG = 250.0
"""Counter-clockwise, over more than half a turn: each form wraps on the way."""

HZ = 20


def wrapped(yaw_deg: float) -> float:
    """From -180 to 180 deg."""
    return (yaw_deg + 180.0) % 360.0 - 180.0


def sentence(body: str) -> bytes:
    return f"${body}*{reduce(xor, body.encode(), 0):02X}\r\n".encode()


def wit(kind: int, *values: int) -> bytes:
    content = pack("<BB4h", 0x55, kind, *values)
    return content + bytes((sum(content) & 0xFF,))


def mtdata2(kind: int, content: bytes) -> bytes:
    body = b"\xff\x36" + bytes((len(content) + 3,)) + pack(">HB", kind, len(content)) + content
    return b"\xfa" + body + bytes((-sum(body) & 0xFF,))


def half(yaw_deg: float) -> tuple[float, float]:
    """Cosine and sine of half of it: what a quaternion about the vertical consists of."""
    return cos(radians(yaw_deg) / 2), sin(radians(yaw_deg) / 2)


def navx(yaw_deg: float) -> bytes:
    content = f"!y{wrapped(-yaw_deg):+07.2f}{0.53:+07.2f}{-1.2:+07.2f}{123.4:+07.2f}".encode()
    return content + f"{sum(content) % 256:02X}\r\n".encode()


def witmotion(yaw_deg: float) -> bytes:
    acceleration, angle = wit(0x51, 0, 0, 2048, 2500), round(wrapped(yaw_deg) / 180 * 32767)
    return acceleration + wit(0x53, 100, -50, angle, 18000)


def vnqtn(yaw_deg: float) -> bytes:
    w, z = half(-yaw_deg)
    return sentence(f"VNQTN,+0.000000,+0.000000,{z:+.6f},{w:+.6f}")


FORMS: dict[str, tuple[str, Callable[[float], bytes]]] = {
    "navX, clockwise": ("navx", navx),
    "WT901 with angles alone": ("witmotion", witmotion),
    "NMEA true heading": ("nmea", lambda yaw: sentence(f"HEHDT,{-yaw % 360:.1f},T")),
    "NMEA magnetic heading": ("nmea", lambda yaw: sentence(f"HCHDM,{-yaw % 360:.1f},M")),
    "NMEA heading of the sensor": ("nmea", lambda yaw: sentence(f"HCHDG,{-yaw % 360:.1f},,,12.6,W")),
    "NMEA heading with a status": ("nmea", lambda yaw: sentence(f"GPTHS,{-yaw % 360:.2f},A")),
    "NMEA heading beside a rate that is not valid": (
        "nmea",
        lambda yaw: sentence("HEROT,0.0,V") + sentence(f"HEHDT,{-yaw % 360:.1f},T"),
    ),
    "VectorNav yaw, pitch, roll": (
        "vectornav-ascii",
        lambda yaw: sentence(f"VNYPR,{wrapped(-yaw):+08.3f},-007.330,+000.715"),
    ),
    "VectorNav quaternion": ("vectornav-ascii", vnqtn),
    "Xsens Euler angles, z up": ("xsens", lambda yaw: mtdata2(0x2030, pack(">3f", 1.0, 2.0, wrapped(yaw)))),
    "Xsens Euler angles, z down": ("xsens", lambda yaw: mtdata2(0x2037, pack(">3d", 1.0, 2.0, wrapped(-yaw)))),
    "Xsens quaternion": ("xsens", lambda yaw: mtdata2(0x2010, pack(">4f", half(yaw)[0], 0.0, 0.0, half(yaw)[1]))),
}


def played(port: Path, frame: Callable[[float], bytes]) -> tuple[list[Sample], Host]:
    """Samples of 2 s of rest, the turn within 4 s, and 1 s of rest, and their host; a frame is read as it comes."""
    turns = (TRUE_DEG * min(1.0, max(0.0, (i / HZ - 2.0) / 4.0)) for i in range(7 * HZ))
    with speaking_on(port) as device, Host(port) as host:
        return host.hear(device, (frame(110.0 + turn) for turn in turns), 1.0 / HZ), host


@pytest.mark.promise("Text and units")
@pytest.mark.parametrize("form", FORMS)
def test_the_turn_of_a_device_that_sends_an_angle_is_the_true_one(port: Path, form: str) -> None:
    """A device that sends only an angle turns by the true angle, with the right sign."""
    protocol, frame = FORMS[form]
    samples, host = played(port, frame)
    turned_deg = sum(now.rate_dps * (now.t_device_s - before.t_device_s) for before, now in pairwise(samples))
    assert turned_deg == pytest.approx(TRUE_DEG, abs=0.2)
    assert ("protocol_found", {"protocol": protocol, "baud": 115200}) in host.told
    assert host.names().count("rate_from_angle") == 1
    assert "rate_unit_differs" not in host.names()


WITH_RATE: dict[str, tuple[type, Callable[[float], bytes], Callable[[float], bytes]]] = {
    "witmotion": (WitmotionDecoder, witmotion, lambda rate: wit(0x52, 0, 0, round(rate / 2000 * 32768), 2500)),
    "nmea": (NmeaDecoder, FORMS["NMEA true heading"][1], lambda rate: sentence(f"TIROT,{-60 * rate:.1f},A")),
    "vectornav-ascii": (
        VectornavAsciiDecoder,
        FORMS["VectorNav yaw, pitch, roll"][1],
        lambda rate: sentence(f"VNGYR,0.0,0.0,{radians(-rate):+.6f}"),
    ),
    "xsens": (
        XsensDecoder,
        FORMS["Xsens Euler angles, z up"][1],
        lambda rate: mtdata2(0x8020, pack(">3f", 0.0, 0.0, radians(rate))),
    ),
}


@pytest.mark.promise("Text and units")
@pytest.mark.parametrize("protocol", WITH_RATE)
@pytest.mark.parametrize("joined_at", [0, 1])
def test_a_device_that_sends_both_is_read_by_its_rate(protocol: str, joined_at: int) -> None:
    """A device that sends angle and rate is read by its rate."""
    decoder, angle, rate = WITH_RATE[protocol]
    stream = [item for i in range(30) for item in (angle(i), rate(5.0))][joined_at:]
    readings: list[Reading] = decoder().push(b"".join(stream))
    assert len(readings) >= 29
    assert [reading.rate_dps for reading in readings] == pytest.approx([5.0] * len(readings), abs=0.05)


@pytest.mark.parametrize("protocol", WITH_RATE)
def test_an_angle_waits_for_a_rate_and_then_stays(protocol: str) -> None:
    """A rate that comes later would count the same turn twice."""
    decoder, angle, rate = WITH_RATE[protocol]
    stream = [angle(i) for i in range(ANGLES_BEFORE + 3)] + [item for i in range(9) for item in (rate(5.0), angle(i))]
    readings = decoder().push(b"".join(stream))
    assert all(reading.rate_dps != reading.rate_dps for reading in readings)
    assert len(readings) == 3 + 9


def test_of_two_compasses_the_first_is_listened_to() -> None:
    decoder = NmeaDecoder()
    stream = (sentence("HEHDT,10.0,T") + sentence("HCHDM,190.0,M")) * 9
    assert {reading.yaw_deg for reading in decoder.push(stream)} in ({-10.0}, {-190.0})
    assert len(decoder.counters.passed_over) == 1


@pytest.mark.parametrize("body", ["HEHDT,,T", "HEHDT,370.0,T", "HEHDT,-1.0,T", "GPTHS,10.0,V", "HEHDT,inf,T"])
def test_a_heading_that_is_none_is_passed_over(body: str) -> None:
    """Empty, out of range, not valid."""
    assert NmeaDecoder().push(sentence(body) * 20) == []


@pytest.mark.promise("Text and units")
def test_sentences_without_a_checksum_are_read_by_who_asks_for_them() -> None:
    """NMEA sentences without a checksum are read only with `--protocol nmea`."""
    line = b"$TIROT,-300.0,A\r\n"
    assert NmeaDecoder().push(line * 9) == []
    assert [reading.rate_dps for reading in AskedNmeaDecoder().push(line * 9)] == [5.0] * 9
    decoder = AskedNmeaDecoder()
    assert len(decoder.push(sentence("TIROT,-300.0,A") + line * 9)) == 1
    assert decoder.counters.damaged == 9


@pytest.mark.promise("Text and units")
@pytest.mark.parametrize(
    "line",
    [
        b"$TIROT,-300.0",
        b"$TIROT,-300.0,",
        b"$TIROT,-3$TIROT,-300.0,A",
        b"TIROT,-300.0,A",
        b"$TIROT,-300.0,A,9",
        b"$HEHDT,12",
        b"$HCHDG,98.3,,",
        b"$TIROT,-300.0,A*",
        b"$TIROT,-300.0,A*0",
    ],
)
def test_a_sentence_without_a_checksum_has_to_be_whole(line: bytes) -> None:
    """A sentence without a checksum must be complete."""
    assert AskedNmeaDecoder().push((line + b"\r\n") * 20) == []


def test_who_asks_for_nmea_by_name_reads_it_without_checksums(port: Path) -> None:
    with speaking_on(port) as device, Host(port, protocol="nmea") as host:
        samples = host.hear(device, [b"$TIROT,-300.0,A\r\n"] * 40, 0.1)
    assert {sample.rate_dps for sample in samples} == {5.0}


def test_a_navx_message_worked_out_by_hand_is_read() -> None:
    (reading,) = NavxDecoder().push(b"!y+012.34-001.20+000.53+123.40DF\r\n")
    assert reading.yaw_deg == -12.34


@given(st.binary(max_size=2000))
def test_random_bytes_never_make_a_navx_sample(noise: bytes) -> None:
    """Nor do messages whose digits are damaged."""
    assert NavxDecoder().push(noise) == []
    assert NavxDecoder().push(b"\r\n!y+0".join(noise[i : i + 30] for i in range(0, len(noise), 30))) == []


@given(st.integers(2, 29), st.integers(1, 255))
def test_one_damaged_byte_of_a_navx_message_is_never_believed(position: int, flip: int) -> None:
    broken = bytearray(navx(33.3))
    broken[position] ^= flip
    assert NavxDecoder().push(bytes(broken)) == []


@given(st.floats(-179.9, 179.9), st.floats(-80, 80), st.floats(-179, 179))
def test_the_yaw_of_a_quaternion_is_that_of_its_euler_angles(yaw: float, pitch: float, roll: float) -> None:
    (cy, sy), (cp, sp), (cr, sr) = half(yaw), half(pitch), half(roll)
    w, x = cr * cp * cy + sr * sp * sy, sr * cp * cy - cr * sp * sy
    y, z = cr * sp * cy + sr * cp * sy, cr * cp * sy - sr * sp * cy
    assert wrapped(yaw_of(w, x, y, z) - yaw) == pytest.approx(0.0, abs=1e-6)
