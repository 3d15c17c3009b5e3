"""VectorNav, binary and ASCII: frames of its maker, and any selection of fields."""

from binascii import crc_hqx
from struct import pack

import golden_frames as golden
import pytest

from gyrodrift.link.protocols.vectornav import VectornavDecoder
from gyrodrift.link.protocols.vectornav_ascii import VectornavAsciiDecoder

DPS = 57.29577951308232


def frame(groups: int, fields: list[int], payload: bytes) -> bytes:
    content = pack(f"<B{len(fields)}H", groups, *fields) + payload
    return b"\xfa" + content + pack(">H", crc_hqx(content, 0))


def test_the_frame_of_the_manual_is_whole_and_has_no_rate() -> None:
    """Angles alone are counted and passed over."""
    decoder = VectornavDecoder()
    assert decoder.push(golden.VECTORNAV_ANGLES * 3) == []
    assert (decoder.counters.frames, decoder.counters.other_frames, decoder.counters.damaged) == (3, 3, 0)


def test_time_rate_and_temperature_are_read() -> None:
    (reading,) = VectornavDecoder().push(golden.VECTORNAV_RATE)
    assert (reading.t_us, reading.seq, reading.temp_c) == (1000, None, 25.25)
    assert reading.rate_dps == pytest.approx(-0.5 * DPS)


@pytest.mark.parametrize(
    ("groups", "fields", "payload"),
    [
        (0b1, [0x0021], pack("<Q3f", 7_000, 9, 9, 2)),
        (0b1, [0x0221], pack("<Q3f6f", 7_000, 9, 9, 9, 1, 1, 1, 9, 9, 2)),
        (0b110, [0x0001, 0x0408], pack("<Q3f3f", 7_000, 9, 9, 2, 8, 8, 8)),
        (0b101, [0x0001, 0x0410], pack("<Qf3f", 7_000, 25.0, 9, 9, 2)),
        (0b10111, [0x0009, 0x0200, 0x0400, 0x0004], pack("<Q3fB3f4f", 7_000, 1, 1, 1, 3, 9, 9, 2, 1, 0, 0, 0)),
    ],
    ids=["angular rate", "not corrected in Imu", "not corrected in the IMU group", "temperature", "four groups"],
)
def test_fields_are_found_wherever_they_stand(groups: int, fields: list[int], payload: bytes) -> None:
    (reading,) = VectornavDecoder().push(frame(groups, fields, payload))
    assert reading.t_us == 7
    assert reading.rate_dps == pytest.approx(-2 * DPS)


def test_the_clock_wraps_as_that_of_every_device() -> None:
    """Nanoseconds of 64 bits are microseconds of 32."""
    (reading,) = VectornavDecoder().push(frame(1, [0x21], pack("<Q3f", (2**32 + 5) * 1000, 0, 0, 0)))
    assert reading.t_us == 5


def test_a_device_without_a_clock_stays_one() -> None:
    timed, untimed = frame(1, [0x21], pack("<Q3f", 7_000, 0, 0, 1)), frame(1, [0x20], pack("<3f", 0, 0, 1))
    first, second = VectornavDecoder(), VectornavDecoder()
    assert [reading.t_us for reading in first.push(untimed + timed)] == [None, None]
    assert [reading.t_us for reading in second.push(timed + untimed)] == [7]
    assert second.counters.other_frames == 1


def test_ascii_messages_between_frames_are_no_damage() -> None:
    """A device sends both on one port unless it is told otherwise."""
    decoder = VectornavDecoder()
    assert len(decoder.push((golden.VECTORNAV_RATE + golden.VECTORNAV_VNYMR) * 5)) == 5
    assert decoder.counters.damaged == 0


def test_ascii_messages_of_the_maker_are_read() -> None:
    """Rates in rad/s about an axis that points down."""
    (ymr,) = VectornavAsciiDecoder().push(golden.VECTORNAV_VNYMR)
    (imu,) = VectornavAsciiDecoder().push(golden.VECTORNAV_VNIMU)
    assert ymr.rate_dps == pytest.approx(0.000551 * DPS)
    assert imu.rate_dps == pytest.approx(0.044656 * DPS)
    assert imu.temp_c == 20.7


def test_of_two_messages_in_turns_one_is_listened_to() -> None:
    decoder = VectornavAsciiDecoder()
    assert len(decoder.push((golden.VECTORNAV_VNYMR + golden.VECTORNAV_VNIMU) * 4)) == 4
    assert (decoder.counters.other_frames, decoder.counters.damaged) == (4, 0)


def test_a_message_with_a_crc_of_sixteen_bits_is_read() -> None:
    """Register 30 chooses which checksum a device sends."""
    body = golden.VECTORNAV_VNIMU[1:].partition(b"*")[0]
    crc = crc_hqx(body, 0)
    assert len(VectornavAsciiDecoder().push(b"$%b*%04X\r\n" % (body, crc))) == 1
    assert not VectornavAsciiDecoder().push(b"$%b*%04X\r\n" % (body, crc ^ 1))
