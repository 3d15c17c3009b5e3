"""WitMotion's Bluetooth family: frames without a checksum, by their distance alone."""

from struct import pack

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gyrodrift.link.protocols.witmotion_ble import WitmotionBleDecoder


def frame(rate_dps: float, yaw_deg: float = 0.0, g: tuple[float, float, float] = (0.0, 0.0, 1.0)) -> bytes:
    accelerations = (round(32768 * item / 16) for item in g)
    rates = (0, 0, round(32768 * rate_dps / 2000))
    return pack("<BB9h", 0x55, 0x61, *accelerations, *rates, 0, 0, round(32768 * yaw_deg / 180) % 65536 - 32768)


def rates(*contents: bytes) -> list[float]:
    decoder = WitmotionBleDecoder()
    return [round(reading.rate_dps) for content in contents for reading in decoder.push(content)]


def test_rates_are_read_once_four_frames_stand_in_a_row() -> None:
    """The first of them as well, and from then on each at once."""
    assert rates(*(frame(10.0 * i) for i in range(3))) == []
    assert rates(*(frame(10.0 * i) for i in range(6))) == [0, 10, 20, 30, 40, 50]


def test_bytes_worked_out_by_hand_are_read() -> None:
    """Level at 1 g, 61.035 deg/s about z, yaw 90 deg."""
    content = bytes.fromhex("5561 0000 0000 0008 0000 0000 e803 0000 0000 0040".replace(" ", ""))
    (*_, last) = WitmotionBleDecoder().push(content * 4)
    assert (last.t_us, last.seq) == (None, None)
    assert last.rate_dps == pytest.approx(61.035, abs=1e-3)


def test_answers_for_registers_between_them_are_passed_over() -> None:
    answer = b"\x55\x71\x3a" + bytes(17)
    decoder = WitmotionBleDecoder()
    assert len(decoder.push((frame(1.0) * 2 + answer) * 4)) == 8
    assert (decoder.counters.frames, decoder.counters.other_frames, decoder.counters.damaged) == (12, 4, 0)


@pytest.mark.promise("Text and units")
def test_a_lost_byte_costs_its_frame_and_gives_no_rate() -> None:
    """A lost byte costs its frame and gives no wrong rate."""
    whole = [frame(5.0, yaw_deg=30.0) for _ in range(30)]
    whole[10] = whole[10][:7] + whole[10][8:]
    decoder = WitmotionBleDecoder()
    readings = [reading for content in whole for reading in decoder.push(content)]
    assert {round(reading.rate_dps) for reading in readings} == {5}
    assert (len(readings), decoder.counters.damaged) == (29, 1)


def test_a_yaw_that_is_set_to_zero_costs_no_frame() -> None:
    """The next head tells that it is no damage."""
    assert len(rates(*[frame(1.0, 170.0)] * 9, *[frame(1.0, 0.0)] * 9, frame(1.0, 1.0))) == 19


@pytest.mark.parametrize("g", [(0.0, 0.0, 0.0), (9.0, 9.0, 9.0)])
def test_what_no_device_feels_is_no_frame(g: tuple[float, float, float]) -> None:
    """Heads at the right distance may stand in any table of bytes."""
    assert rates(frame(1.0, g=g) * 20) == []


@pytest.mark.promise("Text and units")
@given(st.binary(max_size=4000), st.integers(1, 200))
def test_random_bytes_never_make_a_sample(noise: bytes, piece: int) -> None:
    """Random bytes give no sample in frames without a checksum."""
    decoder = WitmotionBleDecoder()
    strewn = b"\x55\x61".join(noise[i : i + 7] for i in range(0, len(noise), 7))
    for content in (noise, strewn):
        for index in range(0, len(content), piece):
            assert decoder.push(content[index : index + piece]) == []
