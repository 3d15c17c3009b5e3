"""Xsens MTData2: a message of a real device, and items in every precision."""

from struct import pack

import golden_frames as golden
import pytest

from gyrodrift.link.protocols.xsens import XsensDecoder

DPS = 57.29577951308232
FULL = golden.XSENS_MTI300 + bytes((-sum(golden.XSENS_MTI300[1:]) & 0xFF,))


def message(*items: tuple[int, bytes], extended: bool = False) -> bytes:
    payload = b"".join(pack(">HB", kind, len(content)) + content for kind, content in items)
    length = b"\xff" + pack(">H", len(payload)) if extended else bytes((len(payload),))
    body = b"\xff\x36" + length + payload
    return b"\xfa" + body + bytes((-sum(body) & 0xFF,))


def test_a_message_of_a_real_device_is_read() -> None:
    """Ticks of 0.1 ms, rate in rad/s."""
    (reading,) = XsensDecoder().push(FULL)
    assert (reading.t_us, reading.seq, reading.temp_c) == (20332454 * 100, 37261, 37.625)
    assert reading.rate_dps == pytest.approx(-0.00163019 * DPS, rel=1e-5)


@pytest.mark.parametrize(
    ("kind", "content"),
    [
        (0x8020, pack(">3f", 1, 2, -1.5)),
        (0x8028, pack(">3f", 1, 2, -1.5)),
        (0x8021, pack(">3i", 0, 0, -3 << 19)),
        (0x8022, pack(">IhIhIh", 0, 1, 0, 2, 1 << 31, -2)),
        (0x8023, pack(">3d", 1, 2, -1.5)),
        (0x8040, pack(">3f", 1, 2, -1.5)),
    ],
    ids=["float", "float in NWU", "12.20", "16.32", "double", "high rate"],
)
def test_every_precision_is_read(kind: int, content: bytes) -> None:
    """The low digit of the id says which."""
    (reading,) = XsensDecoder().push(message((0x1060, pack(">I", 5)), (kind, content)))
    assert reading.t_us == 500
    assert reading.rate_dps == pytest.approx(-1.5 * DPS)


def test_a_message_of_extended_length_is_read() -> None:
    extra = [(0xA010, bytes(100)) for _ in range(3)]
    (reading,) = XsensDecoder().push(message(*extra, (0x8020, pack(">3f", 0, 0, 1)), extended=True))
    assert reading.rate_dps == pytest.approx(DPS)


def test_a_temperature_holds_until_the_next_one() -> None:
    rate, warm = (0x8020, pack(">3f", 0, 0, 1)), (0x0810, pack(">f", 30.5))
    readings = XsensDecoder().push(message(rate, warm) + message(rate) + message(rate))
    assert [reading.temp_c for reading in readings] == [30.5] * 3


def test_without_a_sample_time_there_is_no_clock() -> None:
    decoder = XsensDecoder()
    (reading,) = decoder.push(message((0x8020, pack(">3f", 0, 0, 1))) + message((0x1020, b"\0\1")))
    assert reading.t_us is None
    assert (decoder.counters.frames, decoder.counters.other_frames) == (2, 1)


def test_no_damaged_byte_is_believed() -> None:
    """Wherever it stands; the messages around it are read."""
    for position in range(len(FULL)):
        broken = bytearray(FULL)
        broken[position] ^= 0x5A
        decoder = XsensDecoder()
        assert (len(decoder.push(FULL + bytes(broken) + FULL * 6)), decoder.counters.damaged) == (7, 1), position
