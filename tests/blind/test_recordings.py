"""Real recordings in two sets, and what is put into them: on columns made by hand each effect does what it should."""

import numpy as np
import pytest
from blind.rows.recordings import LEAST_S, LEAST_SET_S, OWNED, Recorded, Rows, devices, recordings_of
from blind.rows.table import ROWS, draw_case
from blind.rows.tampering import ANYWHERE, MOVING, draw_tampering, tamper
from gyrogap.catalogue import EFFECTS
from gyrogap.physics.dice import effect_dice, plan_dice
from gyrogap.physics.kinds import InjectedEffect

HZ = 50.0
T_S = np.arange(3000) / HZ
RATE_DPS = 60.0 * np.sin(2.0 * np.pi * T_S / 6.0)
ANGLE_DEG = np.concatenate([[0.0], np.cumsum(RATE_DPS[:-1])]) / HZ
MADE = Rows({"t_device_s": T_S, "rate_dps": RATE_DPS, "encoder_deg": ANGLE_DEG})


def put(name: str, **parameters: float) -> Rows:
    return tamper(MADE, InjectedEffect(name, parameters), effect_dice(("test", name)))


def rate(name: str, **parameters: float) -> np.ndarray:
    return put(name, **parameters).columns["rate_dps"]


def test_gains() -> None:
    assert rate("scale_factor", error_percent=-4.0) == pytest.approx(0.96 * RATE_DPS)
    pair = rate("scale_asymmetry", error_percent=3.0)
    assert pair == pytest.approx(np.where(RATE_DPS > 0.0, 1.03, 0.97) * RATE_DPS)


def test_what_takes_time() -> None:
    """A delay shifts a sine, an RC filter lags it by atan(f/f_c) and takes cos of that."""
    late = rate("latency", delay_ms=60.0)
    assert late[10:] == pytest.approx(RATE_DPS[7:-3])
    passed = rate("bandwidth", cutoff_hz=1.5)[600:]
    wave = np.exp(-2j * np.pi * T_S[600:] / 6.0)
    ratio = np.mean(passed * wave) / np.mean(RATE_DPS[600:] * wave)
    lag = np.arctan(1.0 / 6.0 / 1.5)
    assert abs(ratio) == pytest.approx(np.cos(lag), abs=0.003)
    assert -np.angle(ratio) == pytest.approx(lag, abs=0.02)


def test_a_bias_settles() -> None:
    added = rate("warmup", amplitude_dps=2.0, settle_s=10.0) - RATE_DPS
    assert added[[0, 500]] == pytest.approx([2.0, 2.0 * np.exp(-1.0)])


def test_steps_and_ends() -> None:
    """Small rates are zero, steps are whole, and the range ends."""
    dead = rate("deadband", width_dps=2.0)
    assert dead[np.abs(RATE_DPS) < 2.0] == pytest.approx(0.0)
    assert np.abs(dead[dead != 0.0]).min() >= 2.0
    steps = rate("quantization", step_dps=1.5) / 1.5
    assert steps == pytest.approx(np.rint(steps))
    assert np.abs(rate("saturation", limit_dps=24.0)).max() == 24.0


def test_how_often() -> None:
    spread = 5.0 * np.sqrt(0.1 * 0.9 / len(T_S))
    assert np.mean(np.diff(rate("stale_hold", share_percent=10.0)) == 0.0) == pytest.approx(0.1, abs=spread)
    assert len(put("sample_drop", share_percent=10.0).t_s) / len(T_S) == pytest.approx(0.9, abs=spread)
    outlying = rate("spikes", height_dps=40.0, share_percent=10.0) - RATE_DPS
    assert np.mean(np.abs(outlying) > 1.0) == pytest.approx(0.1, abs=spread)
    assert set(np.round(outlying, 6)) == {-40.0, 0.0, 40.0}


def test_a_tone_has_its_power() -> None:
    tone = rate("vibration", amplitude_dps=3.0, frequency_hz=15.0) - RATE_DPS
    assert np.mean(np.square(tone)) == pytest.approx(4.5, rel=0.02)


def test_the_reference() -> None:
    """A play of 2° is half of it to either side when the direction is held; 180 counts are steps of 2°."""
    off = put("backlash", play_deg=2.0).columns["encoder_deg"] - ANGLE_DEG
    assert off.min() == pytest.approx(-1.0)
    assert off.max() == pytest.approx(1.0)
    counts = put("encoder_quantization", cpr=180.0).columns["encoder_deg"] / 2.0
    assert counts == pytest.approx(np.rint(counts))
    assert np.ptp(counts * 2.0 - ANGLE_DEG) <= 2.0


def test_stamps_scatter_and_stay_in_order() -> None:
    """Two thirds of a millisecond in second differences of √6 times as much."""
    stamps_s = put("timestamp_jitter", sigma_ms=1.0).t_s
    assert (np.diff(stamps_s) >= 0.0).all()
    assert np.std(np.diff(stamps_s, 2)) / np.sqrt(6.0) == pytest.approx(1e-3, rel=0.1)


@pytest.mark.parametrize("name", [*MOVING, *ANYWHERE])
def test_what_is_drawn_can_be_put_in(name: str) -> None:
    """Every effect changes the recording, and the catalogue knows it."""
    rng = plan_dice(("tampering", name))
    changed = tamper(MADE, draw_tampering(rng, name, HZ, 60.0), effect_dice(("tampering", name)))
    assert name in EFFECTS
    same = len(changed.t_s) == len(T_S) and all(
        np.array_equal(changed.columns[column], MADE.columns[column]) for column in MADE.columns
    )
    assert not same


def test_two_sets_of_a_device_share_no_recording() -> None:
    if not devices():
        pytest.skip("the folder of recordings is not there")
    assert set(devices()) == set(OWNED)
    for number in range(2 * len(OWNED)):
        parts = draw_case(9, "baseline_none", number).draft.parts
        last, today = parts["baseline"], parts["sessions"]
        assert isinstance(last, Recorded)
        assert isinstance(today, Recorded)
        assert not set(map(id, last.recordings)) & set(map(id, today.recordings))
        for item in (last, today):
            assert sum(rows.seconds for rows in item.recordings) > LEAST_SET_S
            assert min(rows.seconds for rows in item.recordings) >= LEAST_S


def test_every_effect_is_put_into_something() -> None:
    if not devices():
        pytest.skip("the folder of recordings is not there")
    cases = [draw_case(9, "baseline", number) for number in range(ROWS["baseline"].count)]
    assert {case.draft.faults[0].name for case in cases} == {*MOVING, *ANYWHERE}
    still = [case.draft for case in cases if case.draft.facts["device"] == "mpu6050_still"]
    assert len({draft.faults[0].name for draft in still}) >= 5
    assert {draft.faults[0].name for draft in still} <= set(ANYWHERE)


def test_recordings_begin_at_zero() -> None:
    """Times and angle, pieces of a long one too."""
    if not devices():
        pytest.skip("the folder of recordings is not there")
    for rows in recordings_of("broad"):
        assert (rows.t_s[0], rows.columns["encoder_deg"][0]) == (0.0, 0.0)
        assert rows.seconds < 61.0
