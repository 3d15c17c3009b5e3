"""Prefixes of terminals and logs, and the clocks in them."""

import pytest

from gyrodrift.columns.fields import Headings
from gyrodrift.columns.guess import guess
from gyrodrift.columns.log_prefix import Prefixed, split_prefix


@pytest.mark.parametrize(
    ("line", "stamp", "unit"),
    [
        ("12:34:56.789 -> gz: 1", "45296.789", "s"),
        ("12:34:56.789 PM -> gz: 1", "45296.789", "s"),
        ("12:34:56 -> gz: 1", "", ""),
        ("[00:00:01.234,567] <inf> imu: gz: 1", "1.234567", "s"),
        ("I (1234) app: gz: 1", "1234", "ms"),
        ("[123456] gz: 1", "123456", ""),
        ("[   12.345678] gz: 1", "12.345678", "s"),
        ("[  1234][I][main.cpp:12] loop(): gz: 1", "1234", ""),
        ("[INFO] [1714551300.123456789] [imu_node]: gz: 1", "1714551300.123456789", "s"),
        ("2024-01-02 03:04:05.678 INFO gz: 1", "1704164645.678", "s"),
        ("2024-01-02 03:04:05,678 - imu - INFO - gz: 1", "1704164645.678", "s"),
        ("INFO:root:gz: 1", "", ""),
    ],
)
def test_a_prefix_is_split_off_and_its_time_is_a_clock(line: str, stamp: str, unit: str) -> None:
    """A time without a fraction is too coarse for a clock."""
    assert split_prefix(line) == Prefixed("gz: 1", stamp, unit)


@pytest.mark.parametrize(
    "line",
    [
        "12:34:56.789,0.1,0.2",
        "12:34:56.789 0.1 0.2",
        "[0.1, 0.2, 0.3]",
        "[0.1] [0.2] [0.3]",
        "[gyro] x: 1 y: 2",
        "(1.5) gz=1",
        "Info: gz=1",
        "T:5 gz:1",
        "ERROR 12",
        "<inf>",
    ],
)
def test_other_lines_have_no_prefix(line: str) -> None:
    assert split_prefix(line) == Prefixed(line)


def test_the_name_of_a_setpoint_or_a_quantity_is_kept() -> None:
    rests = [split_prefix(f"<inf> {module}: yaw: 1").rest for module in ("imu", "gyro", "target")]
    assert rests == ["yaw: 1", "gyro: yaw: 1", "target: yaw: 1"]


def test_the_clock_of_a_prefix_is_the_last_column_and_goes_on_after_midnight() -> None:
    headings = Headings()
    parsed = [headings.fields_of(line) for line in ("23:59:59.5 -> gz: 1", "00:00:00.5 -> gz: 1", "0:00:01.5 -> 1,2")]
    assert [fields and fields.values for fields in parsed] == [
        ("1", "86399.5"),
        ("1", "86400.5"),
        ("1", "2", "86401.5"),
    ]
    assert parsed[0] is not None
    assert parsed[0].labels == ("gz", "time")


def test_a_log_of_zephyr_is_proposed_with_its_clock() -> None:
    """The comma of its time is no column, and labels may stand before numbers without a colon."""
    lines = [f"[00:00:{i * 0.02:06.3f},000] <inf> imu: gx {i % 3} gy {i % 5} gz {i % 7} dps" for i in range(50)]
    result = guess(lines)
    assert result is not None
    assert result.spec == "gx=gx:dps, gy=gy:dps, gz=rate:dps, time=t_s"
