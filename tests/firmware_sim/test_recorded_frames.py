"""Frames of encoders for samples of a recording, against frames worked out by hand."""

import struct
from math import inf, nan

import pytest
from cobs import cobs

from firmware_sim.rig import Base
from firmware_sim.wire.encoder import Frame, Measurement
from firmware_sim.wire.native import hello_frame
from firmware_sim.wire.registry import ENCODERS

BASE = Base(sample_rate_hz=2.0, dps_per_lsb=0.5, encoder_cpr=720)
RISING = [Measurement(0.5 * i, 500_000 * i, i, 1.5 * i, 10.0 * i, 25.0) for i in range(5)]


def encoded(protocol: str, *measurements: Measurement) -> list[Frame]:
    return list(ENCODERS[protocol].recorded(measurements, BASE))


def native_sample(frame: Frame) -> tuple[int, ...]:
    """Flags, seq, t_us, rate_raw, temp_centi_c, encoder_counts."""
    return struct.unpack("<BBHIhhi", cobs.decode(frame.content[:-1])[:-2])[1:]


def test_native_says_hello_once_a_second() -> None:
    """Two samples a second from 0 to 2 s: at 0, 1 and 2 s."""
    frames = encoded("native", *RISING)
    assert [frame.t_s for frame in frames if frame.rows == 0] == [0.0, 1.0, 2.0]
    assert {frame.content for frame in frames if frame.rows == 0} == {hello_frame(BASE)}


def test_native_rounds_to_counts() -> None:
    assert native_sample(encoded("native", *RISING)[5]) == (0b011, 3, 1_500_000, 9, 2500, 60)


@pytest.mark.parametrize(("rate_dps", "counts"), [(1e5, 32767), (-1e5, -32767)])
def test_native_marks_a_rate_beyond_its_counts(rate_dps: float, counts: int) -> None:
    """Clipped at 32767 counts; what is absent has no flag and reads 0."""
    _, frame = encoded("native", Measurement(0.0, 7, 1, rate_dps, None, nan))
    assert native_sample(frame) == (0b100, 1, 7, counts, 0, 0)


@pytest.mark.parametrize("protocol", ["native", "witmotion"])
@pytest.mark.parametrize("rate_dps", [nan, inf])
def test_counts_have_no_word_for_what_is_no_number(protocol: str, rate_dps: float) -> None:
    frames = encoded(protocol, Measurement(0.0, 7, 1, rate_dps, 1.0, 20.0))
    assert sum(frame.rows for frame in frames) == 0


def test_csv_keeps_every_digit_and_what_is_no_number() -> None:
    """A line a sample, without a banner; the clock wraps at 32 bits."""
    (frame,) = encoded("csv", Measurement(0.25, 2**32 + 3, 1, 0.1 + 0.2, None, 20.5))
    assert frame == Frame(0.25, b"3,0.30000000000000004,nan,20.5\r\n", 1, b"\r\n")
    assert encoded("csv", Measurement(0.0, 1, 1, nan, None, None))[0].content == b"1,nan\r\n"


def test_witmotion_takes_the_nearest_count_of_its_own() -> None:
    (frame,) = encoded("witmotion", Measurement(0.25, 3, 1, 10.0, 5.0, None))
    assert struct.unpack("<hh", frame.content[17:21]) == (164, 0)
    assert (frame.t_s, frame.rows, frame.end_mark) == (0.25, 1, b"")


def test_text_is_what_a_sketch_prints_for_a_serial_plotter() -> None:
    """Milliseconds, and 131 counts for 1 deg/s; a rate that is no number cannot be said."""
    unsaid = Measurement(9.0, 9_000_000, 9, nan, None, None)
    frames = encoded("text", *RISING[:2], Measurement(1.0, 1_000_250, 2, -1e5, None, None), unsaid)
    assert [frame.content for frame in frames] == [
        b"t_ms:0,gx:0,gy:0,gz:0\r\n",
        b"t_ms:500,gx:0,gy:0,gz:196\r\n",
        b"t_ms:1000.250,gx:0,gy:0,gz:-32767\r\n",
    ]


@pytest.mark.parametrize("protocol", ["native", "witmotion"])
@pytest.mark.parametrize(
    ("temp_c", "statement"), [(400.0, 32767), (-1e300, -32767), (1e308, 32767), (inf, 0), (-inf, 0)]
)
def test_a_temperature_beyond_its_register_is_the_nearest_that_can_be_said(
    protocol: str, temp_c: float, statement: int
) -> None:
    frame = encoded(protocol, Measurement(0.0, 7, 1, 1.0, None, temp_c))[-1]
    result = native_sample(frame)[4] if protocol == "native" else struct.unpack_from("<h", frame.content, 19)[0]
    assert result == statement


@pytest.mark.parametrize("protocol", ["native", "witmotion"])
@pytest.mark.parametrize("rate_dps", [1e308, -1e308])
def test_a_rate_beyond_everything_is_clipped(protocol: str, rate_dps: float) -> None:
    frame = encoded(protocol, Measurement(0.0, 7, 1, rate_dps, inf, 25.0))[-1]
    raw = native_sample(frame)[3] if protocol == "native" else struct.unpack_from("<h", frame.content, 17)[0]
    assert raw == (32767 if rate_dps > 0 else -32767)
