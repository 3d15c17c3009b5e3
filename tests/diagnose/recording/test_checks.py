"""Checks of recordings before a comparison."""

import re
from dataclasses import replace

import numpy as np
import pytest

from gyrodrift.diagnose.recording.checks import check_recording, together_s
from gyrodrift.diagnose.recording.recording import Recording, recording_of
from gyrodrift.session.session import Session
from gyrodrift.values.arrays import Floats
from gyrodrift.values.errors import DataError

T_S: Floats = np.arange(12_000, dtype=np.float64) * 0.01
TRUE_DPS = 40.0 * np.sin(2.0 * np.pi * T_S / 13.0) + 25.0 * np.sin(2.0 * np.pi * T_S / 3.7)
ANGLE_DEG: Floats = np.cumsum(TRUE_DPS) * 0.01


def recording(rate_dps: Floats = TRUE_DPS, angle_deg: Floats = ANGLE_DEG) -> Recording:
    noise = np.random.default_rng(1).normal(0.0, 0.05, len(T_S))
    return recording_of(Session("swing", T_S, rate_dps + noise + 0.3, 1.7e9 + T_S, np.arange(len(T_S)), angle_deg))


def test_a_good_recording_passes_as_it_is() -> None:
    whole = recording()
    passed = check_recording(whole)
    assert passed.recording is whole
    assert passed.remarks == ()


@pytest.mark.parametrize(
    ("factor", "statement"),
    [
        (-1.0, "the sign opposite to the encoder's"),
        (np.pi / 180.0, "in radians per second"),
        (-np.pi / 180.0, "the sign opposite"),
    ],
)
def test_sign_and_unit_are_told_and_put_right(factor: float, statement: str) -> None:
    whole = recording()
    passed = check_recording(replace(whole, rate_dps=whole.rate_dps * factor))
    assert passed.recording is not None
    assert statement in " ".join(passed.remarks)
    assert np.allclose(passed.recording.rate_dps, whole.rate_dps)


def test_an_angle_in_radians_is_asked_about() -> None:
    whole = recording()
    passed = check_recording(replace(whole, rate_dps=np.rad2deg(whole.rate_dps)))
    assert passed.recording is None
    assert "encoder:rad" in passed.remarks[-1]
    assert "--rate-unit dps" in passed.remarks[-1]


@pytest.mark.parametrize("factor", [1.0, -1.0, np.pi / 180.0])
@pytest.mark.parametrize("speed_dps", [20.0, -7.0, 200.0])
def test_an_even_spin_is_alike_at_any_lag_and_has_a_sign_and_a_unit(speed_dps: float, factor: float) -> None:
    """Noise alone changes, and tells of no other axis and no other time."""
    whole = recording(np.full(len(T_S), speed_dps), np.round(speed_dps * T_S * 20.0) / 20.0)
    passed = check_recording(replace(whole, rate_dps=whole.rate_dps * factor))
    assert passed.recording is not None
    assert len(passed.remarks) == (factor != 1.0)
    assert np.allclose(passed.recording.rate_dps, whole.rate_dps)


@pytest.mark.parametrize("lag", [-80, 150])
def test_an_encoder_of_another_time_is_shifted(lag: int) -> None:
    late_deg = ANGLE_DEG[np.clip(np.arange(len(T_S)) - lag, 0, len(T_S) - 1)]
    passed = check_recording(recording(angle_deg=late_deg))
    assert passed.recording is not None
    report = re.search(r"are ([0-9.]+) s apart; the encoder was shifted", passed.remarks[0])
    assert report is not None
    assert float(report[1]) == pytest.approx(abs(lag) / 100.0, abs=0.03)
    shifted = np.gradient(passed.recording.encoder_deg, 0.01)[500:-500]
    assert np.corrcoef(shifted, TRUE_DPS[500:-500])[0, 1] > 0.99


def test_another_axis_is_refused() -> None:
    passed = check_recording(recording(rate_dps=30.0 * np.cos(2.0 * np.pi * T_S / 5.3)))
    assert passed.recording is None
    assert "another axis" in passed.remarks[0]


def test_a_dead_encoder_is_refused_and_a_still_is_not() -> None:
    """The gyro tells which it is."""
    assert "does not move while the gyro does" in check_recording(recording(angle_deg=np.zeros(len(T_S)))).remarks[0]
    still = check_recording(recording(np.zeros(len(T_S)), np.zeros(len(T_S))))
    assert still.recording is not None
    assert "nothing moves in it" in still.remarks[0]


def test_a_recording_that_only_rests_is_told_of() -> None:
    still = recording(np.zeros(len(T_S)), np.zeros(len(T_S)))
    passed = check_recording(still)
    assert passed.recording is still
    assert "nothing moves" in " ".join(passed.remarks)


def test_all_findings_are_told_in_their_order() -> None:
    """Lag, sign, unit; each check looks at what the one before put right."""
    late_deg = ANGLE_DEG[np.clip(np.arange(len(T_S)) + 100, 0, len(T_S) - 1)]
    whole = recording(angle_deg=late_deg)
    passed = check_recording(replace(whole, rate_dps=-np.deg2rad(whole.rate_dps)))
    words = ("1.00 s apart", "sign opposite", "in radians per second")
    assert len(passed.remarks) == len(words)
    assert all(word in remark for word, remark in zip(words, passed.remarks, strict=True))
    assert all(remark.startswith("swing: ") for remark in passed.remarks)
    assert passed.recording is not None
    assert np.allclose(passed.recording.rate_dps, whole.rate_dps)


def test_a_refusal_keeps_what_was_told_before() -> None:
    second = recording(rate_dps=30.0 * np.cos(2.0 * np.pi * T_S / 5.3))
    passed = check_recording(second)
    assert passed.recording is None
    assert ["another axis" in remark for remark in passed.remarks] == [True]


@pytest.mark.parametrize(
    ("gain", "is_unit"), [(1.0 / 1.3, False), (1.3, False), (57.3 / 1.3, True), (57.3 / 1.5, False)]
)
def test_a_scale_error_is_no_unit(*, gain: float, is_unit: bool) -> None:
    whole = recording()
    passed = check_recording(replace(whole, rate_dps=whole.rate_dps * gain))
    assert ("57.3 times as far" in " ".join(passed.remarks)) is is_unit
    assert (passed.recording is None) is is_unit


@pytest.mark.parametrize(("apart_s", "is_shifted"), [(0.2, False), (0.3, True)])
def test_a_delay_of_a_sensor_is_left_as_it_is(*, apart_s: float, is_shifted: bool) -> None:
    lag = round(apart_s / 0.01)
    passed = check_recording(recording(angle_deg=ANGLE_DEG[np.clip(np.arange(len(T_S)) - lag, 0, len(T_S) - 1)]))
    assert any("apart" in remark for remark in passed.remarks) is is_shifted


def of_length(samples: int) -> Recording:
    return recording_of(Session("short", T_S[:samples], TRUE_DPS[:samples], encoder_deg=ANGLE_DEG[:samples]))


@pytest.mark.parametrize(("samples", "is_refused"), [(1999, True), (2000, False), (3300, False)])
def test_a_recording_counts_from_twenty_seconds_on(*, samples: int, is_refused: bool) -> None:
    """A hundred samples a second; one that is refused is told with its length."""
    passed = check_recording(of_length(samples))
    assert (passed.recording is None) is is_refused
    assert ("20.0 s long; a recording counts from 20 s on" in " ".join(passed.remarks)) is is_refused


def test_short_recordings_count_together() -> None:
    """Three of twenty seconds are a minute."""
    assert together_s([of_length(2000)] * 3) == pytest.approx(60.0)


@pytest.mark.parametrize(
    ("count", "words"),
    [
        (0, "there are 0.0 s in 0 recordings; at least 60 s in all are needed"),
        (1, "there are 25.0 s in 1 recording; at least 60 s"),
        (2, "there are 50.0 s in 2 recordings; at least 60 s .*: record 10.0 s more"),
    ],
)
def test_less_than_a_minute_in_all_is_refused(count: int, words: str) -> None:
    with pytest.raises(DataError, match=words):
        together_s([of_length(2500)] * count)
