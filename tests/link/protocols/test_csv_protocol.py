"""The csv protocol: what hobby sketches print, and what serial lines make of it."""

from collections.abc import Callable
from math import cos, inf, isnan, sin
from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gyrodrift.columns.shape import has_csv_shape
from gyrodrift.link.protocols.csv import CsvDecoder
from gyrodrift.values.sample import Reading

THREE = b"100,1.5\n10100,2.5\n20100,-3.5\n"


def test_columns_are_time_rate_angle_and_temperature() -> None:
    """The last two may be absent."""
    readings = CsvDecoder().push(b"0,1,2.5,25.1\r\n10000,-1e-2,2.6,25.2\r\n20000,.5,2.7,nan\r\n")
    assert readings[:2] == [Reading(0, None, 1.0, 2.5, 25.1), Reading(10000, None, -0.01, 2.6, 25.2)]
    assert isnan(readings[2].temp_c)
    assert isnan(CsvDecoder().push(THREE)[0].encoder_deg)


def test_comments_banners_and_blank_lines_are_no_samples() -> None:
    """A header counts as a line that does not parse, a comment as nothing."""
    decoder = CsvDecoder()
    assert len(decoder.push(b"# hello\n\n  \r\nt_us,rate_dps\n" + THREE)) == 3
    assert (decoder.counters.frames, decoder.counters.damaged) == (3, 1)


@pytest.mark.parametrize("header", [b"t_us,heading", b"t_ms,gz_dps", b"t_us,gz", b"micros,gz [rad/s]"])
def test_a_header_that_names_other_columns_counts(header: bytes) -> None:
    """At the start of the stream, unless the user asks for csv; one of a device that boots again does not."""
    assert CsvDecoder().push(header + b"\n" + THREE) == []
    assert len(CsvDecoder(heeds_header=False).push(header + b"\n" + THREE)) == 3
    assert len(CsvDecoder().push(THREE + header + b"\n" + THREE)) == 6


@pytest.mark.parametrize(
    "message", [b"rst:0x1 (POWERON_RESET),boot:0x13", b"MPU6050 found, calibrating", b"t_us,gz (dps)"]
)
def test_a_message_at_boot_is_no_header(message: bytes) -> None:
    assert len(CsvDecoder().push(message + b"\n" + THREE)) == 3


@pytest.mark.parametrize(
    "line",
    [b"30100", b"30100,", b"x,1", b"30100;1", b"1_0,2", b"3.5,1", b"30100,1,2,3,4", b"30100,0x10",
     b"30100,1e9", b"30100,1.2.3", b"30100,--1", b"\xff\xfe,1", b"30100,1" + b" " * 300],
)  # fmt: skip
def test_a_line_that_does_not_parse_is_counted_and_skipped(line: bytes) -> None:
    """Numbers as Python would forgive them are no numbers here."""
    decoder = CsvDecoder()
    decoder.push(THREE)
    assert decoder.push(line + b"\n") == []
    assert decoder.counters.damaged == 1
    assert len(decoder.push(b"40100,1.5\n")) == 1


def test_a_clock_of_signed_32_bits_goes_on() -> None:
    """`long t = micros()` is negative after 35.8 minutes."""
    readings = CsvDecoder().push(b"2147473648,1\n2147483647,1\n-2147473648,1\n-2147463648,1\n")
    assert [(reading.t_us or 0) - 2147473648 for reading in readings] == [0, 9999, 20000, 30000]


def test_rates_that_are_not_finite_are_passed_on_for_the_filter_to_count() -> None:
    """A sketch prints nan when its sensor does not answer."""
    decoder = CsvDecoder()
    decoder.push(THREE)
    rates = [reading.rate_dps for reading in decoder.push(b"30100,nan\n40100,inf\n50100,-inf\n")]
    assert isnan(rates[0])
    assert rates[1:] == [inf, -inf]


@pytest.mark.parametrize(
    ("partial", "rest"),
    [
        (b"678,0.5\n", b"12355678,0.6\n12365678,0.7\n"),
        (b"0.5,1.0\n", b"12355678,0.6,1.1\n12365678,0.7,1.2\n12375678,0.8,1.3\n"),
        (b"5,1.0\n", b"12355678,0.6,1.1\n12365678,0.7,1.2\n"),
        (b",0.5\n", b"12355678,0.6\n12365678,0.7\n12375678,0.8\n"),
    ],
)
def test_the_shortened_line_at_which_a_reader_joins_is_no_sample(partial: bytes, rest: bytes) -> None:
    decoder = CsvDecoder()
    readings = decoder.push(partial + rest)
    assert readings[0].t_us == 12355678
    assert decoder.counters.damaged == 1
    assert len(readings) == rest.count(b"\n")


def test_a_first_line_that_is_whole_is_kept() -> None:
    """Time may start at 0, and a slow device steps by more than a second."""
    assert len(CsvDecoder().push(b"0,1\n2000000,1\n4000000,1\n")) == 3
    assert len(CsvDecoder().push(THREE)) == 3


def test_a_line_cut_short_or_merged_does_not_pass_for_a_sample() -> None:
    """A device keeps its number of columns."""
    decoder = CsvDecoder()
    decoder.push(b"0,1,10\n10000,1,10\n20000,1,10\n")
    assert decoder.push(b"30000,1\n40000,1,10\n") == [Reading(40000, None, 1.0, 10.0)]
    assert decoder.push(b"50000,1,1060000,1,10\n70000,1,10\n") == [Reading(70000, None, 1.0, 10.0)]
    assert decoder.counters.damaged == 2


def test_a_device_that_changes_its_columns_for_good_is_followed() -> None:
    decoder = CsvDecoder()
    decoder.push(THREE)
    assert decoder.push(b"30100,1,5\n40100,1,5\n") == []
    assert [reading.t_us for reading in decoder.push(b"50100,1,5\n")] == [30100, 40100, 50100]
    assert decoder.counters.damaged == 0


def test_an_angle_without_end_is_none() -> None:
    lines = b"".join(b"%d,0.5,%b,%b\n" % (i * 10_000, *words) for i, words in enumerate([(b"inf", b"1e999")] * 4))
    readings = CsvDecoder().push(lines)
    assert len(readings) == 4
    assert all(isnan(item.encoder_deg) and isnan(item.temp_c) for item in readings)


@pytest.mark.parametrize("tail", [b"x", b",", b"e", b"..", b" 1"])
def test_digits_without_end_are_damage(tail: bytes) -> None:
    decoder = CsvDecoder()
    assert decoder.push(b"1,0.5,%b%b\n" % (b"1" * 240, tail)) == []
    assert decoder.counters.damaged == 1


@given(st.floats(-1e4, 1e4), st.floats(allow_nan=False, allow_infinity=False))
def test_whatever_a_float_is_printed_as_is_read(rate_dps: float, encoder_deg: float) -> None:
    lines = b"".join(f"{i}, {rate_dps!r} ,{encoder_deg:e}\n".encode() for i in range(3))
    readings = CsvDecoder().push(lines)
    assert [(item.rate_dps, item.encoder_deg) for item in readings] == [(rate_dps, float(f"{encoder_deg:e}"))] * 3


def plausible(line: Callable[[int, Random], str], lines: int = 12, seed: int = 4) -> bool:
    """Whether so many lines, 20 ms apart, can be csv."""
    dice = Random(seed)
    return has_csv_shape(CsvDecoder().push("".join(f"{line(i, dice)}\n" for i in range(lines)).encode()))


ANGLE_STEP_DEG = 360.0 / 4096
OWN: dict[str, Callable[[int, Random], str]] = {
    "rate alone": lambda i, dice: f"{20_000 * i},{dice.gauss(0.5, 0.05):.3f}",
    "an encoder at rest": lambda i, dice: f"{20_000 * i},{dice.gauss(0.5, 0.05):.3f},12.3",
    "an encoder between two counts": lambda i, dice: (
        f"{20_000 * i},{dice.gauss(0.5, 0.05):.3f},{12.3 + dice.choice([0.0, ANGLE_STEP_DEG]):.3f}"
    ),
    "an encoder that turns": lambda i, dice: f"{20_000 * i},{dice.gauss(60.0, 0.05):.3f},{1.2 * i:.3f},25.1",
    "rates of another unit beside it": lambda i, dice: f"{20_000 * i},{1.05 * sin(i / 9):.4f},{-10.8 * cos(i / 9):.3f}",
    "a line said twice": lambda i, dice: f"{20_000 * (i - (i == 5))},1.0",
    "a clock that wraps": lambda i, dice: f"{(2**32 - 100_000 + 20_000 * i) % 2**32},1.0",
}
REST: dict[str, Callable[[int, Random], str]] = {
    "three axes behind a clock": lambda i, dice: (
        f"{20_000 * i},{dice.gauss(0.3, 0.05):.3f},{dice.gauss(-0.8, 0.05):.3f},{dice.gauss(0.5, 0.05):.3f}"
    ),
    "raw counts": lambda i, dice: f"{430 + int(dice.gauss(0, 9))},{int(dice.gauss(-90, 9))},{int(dice.gauss(60, 9))}",
    "whole seconds": lambda i, dice: f"{1_700_000_000 + i // 50},0.3,-0.8,0.5",
    "yaw before rate": lambda i, dice: f"{20_000 * i},170.00,{dice.gauss(0.5, 0.05):.3f}",
    "a temperature in counts": lambda i, dice: f"{20_000 * i},0.5,0.0,-3600",
    "a pressure": lambda i, dice: f"{20_000 * i},0.5,0.0,1013.2",
}


@pytest.mark.parametrize("name", OWN)
def test_what_csv_says_is_plausible(name: str) -> None:
    assert plausible(OWN[name])


@pytest.mark.parametrize("name", REST)
def test_lines_that_only_look_like_csv_are_not(name: str) -> None:
    assert not plausible(REST[name])


def test_slow_lines_are_judged_by_their_time() -> None:
    assert not plausible(lambda i, dice: f"{20_000 * i},0.5", lines=4)
    assert plausible(lambda i, dice: f"{500_000 * i},0.5", lines=4)
    assert not plausible(lambda i, dice: f"{(430, 431, 425, 440)[i]},-90", lines=4), "a number that falls is no hour"
