"""A session on its grid."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from gyrodrift.diagnose.recording.recording import filled, fit_line, recording_of
from gyrodrift.session.session import Session
from gyrodrift.values.arrays import Floats
from gyrodrift.values.errors import DataError

COUNT = 1000
T_S: Floats = np.arange(COUNT, dtype=np.float64) * 0.01


def session() -> Session:
    """Ten seconds of a slow turn, by a device clock that is 1 % fast, with all columns."""
    return Session(
        name="turn",
        t_device_s=3.0 + T_S * 1.01,
        rate_dps=np.full(COUNT, 5.0),
        t_host_s=1.7e9 + T_S,
        seq=np.arange(COUNT) + 7,
        encoder_deg=5.0 * T_S,
        temp_c=np.full(COUNT, 25.0),
    )


def test_true_time_is_the_hosts() -> None:
    assert recording_of(session()).period_s == pytest.approx(0.01, rel=1e-9)
    assert recording_of(replace(session(), t_host_s=None)).period_s == pytest.approx(0.0101, rel=1e-9)


def test_samples_that_are_missing_leave_holes() -> None:
    whole = session()
    kept = np.delete(np.arange(COUNT), [10, 11, 500])
    columns = {
        name: getattr(whole, name)[kept] for name in ("t_device_s", "rate_dps", "t_host_s", "seq", "encoder_deg")
    }
    result = recording_of(Session("holes", **columns))
    assert len(result.rate_dps) == COUNT
    assert np.flatnonzero(np.isnan(result.rate_dps)).tolist() == [10, 11, 500]
    assert np.allclose(filled(result.encoder_deg), 5.0 * T_S)


def test_without_a_counter_holes_are_seen_by_the_clock() -> None:
    whole = session()
    kept = np.delete(np.arange(COUNT), [10, 11, 500])
    columns = {name: getattr(whole, name)[kept] for name in ("t_device_s", "rate_dps", "encoder_deg")}
    result = recording_of(Session("holes", **columns))
    assert np.flatnonzero(np.isnan(result.rate_dps)).tolist() == [10, 11, 500]
    assert not result.has_counter


def test_a_counter_of_sixteen_bits_goes_round() -> None:
    result = recording_of(replace(session(), seq=(np.arange(COUNT) + 65_000) % 65_536))
    assert len(result.rate_dps) == COUNT
    assert np.isfinite(result.rate_dps).all()


def test_samples_that_come_twice_or_late_are_counted() -> None:
    order = np.arange(COUNT)
    order[[20, 21]] = order[[21, 20]]
    order = np.insert(order, 300, 299)
    whole = session()
    columns = {
        name: getattr(whole, name)[order] for name in ("t_device_s", "rate_dps", "t_host_s", "seq", "encoder_deg")
    }
    result = recording_of(Session("mixed", **columns))
    assert (result.repeated, result.disordered) == (1, 1)
    assert len(result.rate_dps) == COUNT


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"encoder_deg": None}, "has no encoder"),
        ({"seq": np.arange(COUNT) * 50}, "by its counter it has 49951 samples, but the file has 1000"),
        ({"rate_dps": np.full(COUNT, np.nan)}, "has no numbers"),
    ],
)
def test_what_cannot_be_compared_is_refused(change: dict[str, object], message: str) -> None:
    with pytest.raises(DataError, match=message):
        recording_of(replace(session(), **change))  # type: ignore[arg-type]  # any column


def test_a_line_is_found_through_holes() -> None:
    values = 3.0 + 0.25 * np.arange(100.0)
    values[[5, 50]] = np.nan
    assert fit_line(values) == pytest.approx((0.25, 3.0))


@pytest.mark.parametrize(
    ("column", "values", "message"),
    [
        ("t_device_s", T_S[::-1], r"turn: its samples are -0\.01 s apart; expected 1e-05 to 1 s"),
        ("t_device_s", T_S * 0.0, r"turn: its samples are 0 s apart"),
        ("t_device_s", T_S * 1e-15, r"turn: its samples are 1e-17 s apart"),
        ("t_device_s", T_S * 1e9, r"turn: its samples are 1e\+07 s apart"),
        ("t_device_s", T_S * 1e15, r"turn: has a device time of 9\.99e\+15 s; the largest plausible value is 1e\+12"),
        ("t_host_s", T_S * 0.0 + 5.0, r"turn: its samples are 0 s apart"),
        ("encoder_deg", T_S * 1e300, r"turn: has an angle of 9\.99e\+300 degrees"),
        ("rate_dps", T_S * 1e300, r"turn: has a rate of 9\.99e\+300 deg/s"),
    ],
)
def test_times_and_values_that_make_no_sense_are_told(column: str, values: Floats, message: str) -> None:
    changed: dict[str, Any] = {"seq": None, column: values}
    report = replace(session(), **changed)
    with pytest.raises(DataError, match=message):
        recording_of(report)
