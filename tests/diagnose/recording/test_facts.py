"""Facts of a rig against what recordings hold: told where they contradict each other, and nowhere else."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from recordings_support import Recordings

from firmware_sim.motion.profile import load_profile
from firmware_sim.rig import Base, Rig, parse_effect, with_effects
from gyrodrift.diagnose.recording.facts import Contradiction, contradictions
from gyrodrift.diagnose.recording.levels import levels_of
from gyrodrift.diagnose.recording.recording import Recording, recording_of
from gyrodrift.session.files import load_session
from gyrodrift.session.session import Session
from gyrodrift.simulation.sessions import Simulation, write_simulation
from gyrodrift.values.arrays import Floats

T_S: Floats = np.arange(6000, dtype=np.float64) * 0.01
TRUE_DPS = 60.0 * np.sin(2.0 * np.pi * T_S / 13.0) * (T_S > 5.0)
ANGLE_DEG: Floats = np.cumsum(TRUE_DPS) * 0.01
NOISE_DPS = np.random.default_rng(2).normal(0.3, 0.05, len(T_S))
LSB = 0.0153


def stepped(values: Floats, step: float) -> Floats:
    return np.round(values / step) * step


def recorded(
    lsb: float = LSB, cpr: float = 4096, gain: float = 1.0, text: tuple[int, int] = (12, 12), size: float = 1.0
) -> Recording:
    """A minute of swings after a rest, in steps of `lsb` and `cpr`, as text of so many decimals."""
    rate_dps = np.round(stepped(size * TRUE_DPS + NOISE_DPS, lsb), text[0])
    angle_deg = np.round(stepped(size * ANGLE_DEG / gain, 360.0 / cpr), text[1])
    return recording_of(Session("swings", T_S, rate_dps, 1.7e9 + T_S, np.arange(len(T_S)), angle_deg))


def beside(base: Base, *recordings: Recording) -> tuple[Contradiction, ...]:
    return contradictions(recordings, base.dps_per_lsb, base.encoder_cpr)


def only(actual: Sequence[Contradiction], fact: str) -> Contradiction:
    """The one that there is."""
    assert [item.fact for item in actual] == [fact]
    return actual[0]


OWN = Base(dps_per_lsb=LSB, encoder_cpr=4096)


@pytest.mark.parametrize("text", [(12, 12), (6, 6), (4, 4), (3, 3)])
def test_a_rig_with_the_recordings_own_facts_is_not_contradicted(text: tuple[int, int]) -> None:
    """Nor where a file's decimals are coarse."""
    assert beside(OWN, recorded(text=text)) == ()


@pytest.mark.parametrize("cpr", [512, 1024, 3000, 3900])
@pytest.mark.parametrize("decimals", [12, 4, 3])
def test_a_finer_encoder_contradicts_the_rig(cpr: int, decimals: int) -> None:
    result = only(beside(Base(dps_per_lsb=LSB, encoder_cpr=cpr), recorded(text=(12, decimals))), "encoder_cpr")
    assert (result.rig, result.sessions, result.unit) == (cpr, 4096.0, "counts per turn")
    assert f"has {cpr} counts" in result.says
    assert "finer than that: state encoder_cpr: 4096" in result.says


@pytest.mark.parametrize("cpr", [4200, 6144, 10_000, 36_000])
def test_steps_that_are_no_whole_number_of_counts_contradict_the_rig(cpr: int) -> None:
    """An encoder of 4096 counts has no angle that one of 36000 has, but every 128th."""
    result = only(beside(Base(dps_per_lsb=LSB, encoder_cpr=cpr), recorded(text=(12, 4))), "encoder_cpr")
    assert result.sessions == 4096.0
    assert "no whole number of these" in result.says


def test_an_encoder_too_fine_for_neighbouring_angles_is_known_by_its_grid() -> None:
    result = only(beside(Base(dps_per_lsb=LSB, encoder_cpr=8192), recorded(cpr=65_536, size=5.0)), "encoder_cpr")
    assert result.sessions == 65_536.0
    assert "finer than that" in result.says


@pytest.mark.parametrize("cpr", [8192, 40_960])
def test_coarser_steps_of_whole_counts_are_an_effect(cpr: int) -> None:
    assert beside(Base(dps_per_lsb=LSB, encoder_cpr=cpr), recorded()) == ()


def test_an_angle_without_steps_contradicts_a_coarser_encoder_alone() -> None:
    """An optical reference to four decimals; beside 3 600 000 counts of 0.0001 degrees it is as good as they."""
    dice = np.random.default_rng(3)
    optical = replace(recorded(), encoder_deg=np.round(ANGLE_DEG + dice.normal(0.0, 0.01, len(T_S)), 4))
    result = only(beside(OWN, optical), "encoder_cpr")
    assert result.sessions is None
    assert "no steps" in result.says
    assert beside(Base(dps_per_lsb=LSB, encoder_cpr=3_600_000), optical) == ()


def test_a_rig_without_encoder_is_told() -> None:
    result = only(beside(Base(dps_per_lsb=LSB, encoder_cpr=0), recorded()), "encoder_cpr")
    assert (result.rig, result.sessions) == (0.0, 4096.0)


@pytest.mark.parametrize(("lsb", "kind"), [(0.0306, "finer"), (0.061, "finer"), (0.0133, "no whole number")])
@pytest.mark.parametrize("decimals", [12, 4])
def test_another_lsb_contradicts_the_rig(lsb: float, kind: str, decimals: int) -> None:
    """A half, a quarter and eight sevenths of the rig's; spikes and lost samples make no difference."""
    item = recorded(text=(decimals, 12))
    rate_dps = item.rate_dps.copy()
    rate_dps[100:5900:100] += 3000.0 * LSB
    rate_dps[50:5900:97] = np.nan
    result = only(beside(Base(dps_per_lsb=lsb, encoder_cpr=4096), replace(item, rate_dps=rate_dps)), "dps_per_lsb")
    assert result.rig == lsb
    assert result.sessions == pytest.approx(LSB, rel=0.01)
    assert kind in result.says
    assert f"{lsb:.4g} deg/s" in result.says
    assert "state dps_per_lsb: 0.0153" in result.says


@pytest.mark.parametrize("lsb", [LSB / 2.0, LSB / 5.0, LSB * 1.01])
def test_a_coarser_readout_and_a_rounded_lsb_are_no_contradiction(lsb: float) -> None:
    """The effect `quantization`, and a data sheet with two digits."""
    assert beside(Base(dps_per_lsb=lsb, encoder_cpr=4096), recorded()) == ()


def test_rates_without_steps_contradict_any_lsb() -> None:
    smooth = replace(recorded(), rate_dps=TRUE_DPS + NOISE_DPS)
    result = only(beside(OWN, smooth), "dps_per_lsb")
    assert result.sessions is None
    assert "record what the gyro reads out" in result.says


@pytest.mark.parametrize("digits", [7, 8, 9])
def test_digits_of_a_simulator_are_no_steps(digits: int) -> None:
    t_s = np.arange(6000) / 100.0
    rate_dps = 90.0 * np.sin(0.7 * t_s) + 20.0 * np.sin(3.1 * t_s)
    angle_deg = np.cumsum(rate_dps) / 100.0
    levels = [levels_of(np.round(values, digits)) for values in (rate_dps, angle_deg)]
    assert [level.step for level in levels] == [None, None]


def test_text_that_is_coarser_than_the_lsb_says_nothing() -> None:
    """Two decimals, and a hundredth of a degree, beside finer steps."""
    base = Base(dps_per_lsb=0.0077, encoder_cpr=40_000)
    assert beside(base, recorded(lsb=1e-6, cpr=1e7, text=(2, 2))) == ()


def test_text_in_radians_is_seen_through() -> None:
    """Rates of four decimals in rad/s come in steps of 0.0057 deg/s, which are the text's."""
    item = recorded()
    text = replace(item, rate_dps=np.rad2deg(np.round(np.deg2rad(item.rate_dps), 4)))
    assert levels_of(text.rate_dps).text == pytest.approx(180.0 / np.pi * 1e-4)
    assert beside(OWN, text) == ()


def test_rates_beyond_the_range_are_told() -> None:
    item = recorded(lsb=0.015625)
    base = Base(dps_per_lsb=0.015625, encoder_cpr=4096)
    for count in (4, 5):
        rate_dps = item.rate_dps.copy()
        rate_dps[1000 : 1000 + count] = 600.0
        beyond = beside(base, replace(item, rate_dps=rate_dps))
        assert len(beyond) == (count == 5)
    result = only(beyond, "range_dps")
    assert (result.rig, result.sessions, result.unit) == (512.0, 600.0, "deg/s")
    assert "600 deg/s" in result.says
    assert "512 deg/s" in result.says


@pytest.mark.parametrize(("gain", "agree"), [(0.25, 16_384), (0.5, 8192), (2.0, 2048), (4.0, 1024)])
def test_a_quadrature_mistake_is_told_with_the_counts_that_agree(gain: float, agree: int) -> None:
    """A gyro that turns so much farther than the encoder, to 3 %, with bias."""
    result = only(beside(OWN, recorded(gain=gain * 1.03)), "turn_ratio")
    assert (result.rig, result.sessions) == (4096.0, agree)
    assert f"with {agree} counts per turn instead of 4096" in result.says


@pytest.mark.parametrize("gain", [0.8, 1.0, 1.2, 1.5, 3.0])
def test_a_scale_error_is_no_quadrature_mistake(gain: float) -> None:
    """Nor is one of a half."""
    assert beside(OWN, recorded(gain=gain)) == ()


def test_a_gyro_that_ends_at_half_the_rates_is_no_quadrature_mistake() -> None:
    """Slow turns are right: it is saturated."""
    item = recorded(size=3.0)
    assert beside(OWN, replace(item, rate_dps=np.clip(item.rate_dps, -62 * LSB, 62 * LSB))) == ()


def test_a_recording_at_rest_contradicts_no_encoder() -> None:
    still = replace(recorded(), rate_dps=stepped(NOISE_DPS, LSB), encoder_deg=np.zeros(len(T_S)))
    assert beside(Base(dps_per_lsb=LSB, encoder_cpr=77), still) == ()


EFFECTS = (
    "quantization:step_dps=0.0625",
    "quantization:step_dps=0.011",
    "deadband",
    "spikes",
    "stale_hold",
    "backlash",
)
ENCODERS = ("encoder_quantization", "encoder_quantization:cpr=4096", "encoder_slip", "encoder_eccentricity")


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    st.builds(
        Base,
        sample_rate_hz=st.sampled_from([50.0, 100.0, 200.0, 400.0]),
        dps_per_lsb=st.floats(0.0076, 0.061),
        noise_dps_rthz=st.floats(0.0015, 0.02),
        encoder_cpr=st.integers(512, 65_536),
        encoder_phase_deg=st.floats(-360.0, 360.0),
    ),
    st.sets(st.sampled_from([*EFFECTS, *ENCODERS]), max_size=2),
    st.sampled_from(["identify", "turntable", "drive", "rest", "constant-spin"]),
    st.sampled_from(["mcap", "csv"]),
    st.integers(4, 6),
)
def test_no_rig_contradicts_its_own_sessions(
    tmp_path: Path, base: Base, named: set[str], motion: str, ending: str, decimals: int
) -> None:
    rig = with_effects(Rig(base=base), [parse_effect(name) for name in sorted(named)])
    path = tmp_path / f"one.{ending}"
    write_simulation(path, Simulation(rig, load_profile(motion), 1, minutes=0.6))
    whole = load_session(path)
    assert whole.encoder_deg is not None
    cut = replace(whole, rate_dps=np.round(whole.rate_dps, decimals), encoder_deg=np.round(whole.encoder_deg, decimals))
    assert beside(base, recording_of(whole), recording_of(cut)) == ()


@pytest.mark.parametrize(
    ("name", "lsb"),
    [
        ("broad_01", 0.061),
        ("broad_06", 0.061),
        ("broad_14", 0.061),
        ("mpu6050_still", 1.0 / 131.0),
        ("temperature_sweep", 250.0 / 32768.0 / 50.0),
    ],
)
def test_real_sensors_do_not_contradict_their_own_lsb(recordings: Recordings, name: str, lsb: float) -> None:
    real = recording_of(load_session(recordings.path(name)))
    assert beside(Base(dps_per_lsb=lsb, encoder_cpr=3_600_000), real) == ()
