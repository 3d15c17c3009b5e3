"""Motion rebuilt from an encoder, and what is taken out of rate and angle before."""

import numpy as np
import pytest

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.recording.outliers import Cleaned, cleaned, granularity, motion_behind, step_of
from gyrodrift.diagnose.recording.recording import recording_of
from gyrodrift.session.session import Session

RATE_HZ = 100.0
T_S = np.arange(20_000) / RATE_HZ


def true_angle_deg(t_s: Floats) -> Floats:
    """Rest, a smooth start, steady turning, and swings of up to 6 Hz."""
    turning = 20.0 * np.logaddexp(0.0, (t_s - 30.0) * 4.0) / 4.0
    swings = np.where(
        t_s > 120.0, 4.0 * np.sin(2.0 * np.pi * 6.0 * t_s) / (2.0 * np.pi * 6.0) * np.tanh(t_s - 120.0), 0.0
    )
    return turning + swings


def true_rate_dps(t_s: Floats) -> Floats:
    """By small differences of the angle."""
    return (true_angle_deg(t_s + 5e-5) - true_angle_deg(t_s - 5e-5)) / 1e-4


def seen(
    noise_dps: float = 0.05,
    cpr: int = 36_000,
    wild: dict[int, float] | None = None,
    jumps: dict[int, float] | None = None,
) -> Cleaned:
    dice = np.random.default_rng(3)
    rate_dps = true_rate_dps(T_S) + dice.normal(0.0, noise_dps, len(T_S))
    angle_deg = np.round(true_angle_deg(T_S) * cpr / 360.0) * 360.0 / cpr
    for at, height in (wild or {}).items():
        rate_dps[at] += height
    for at, height in (jumps or {}).items():
        angle_deg[at:] += height
    return cleaned(recording_of(Session("s", T_S, rate_dps, None, np.arange(len(T_S)), angle_deg)))


def test_the_motion_is_that_of_the_device() -> None:
    """At rest, steady and quick, well below the noise of a gyro, without its help."""
    motion = motion_behind(seen())
    inside = slice(100, -100)
    error_dps = (motion.rate_dps - true_rate_dps(T_S))[inside]
    steady = (T_S[inside] > 40.0) & (T_S[inside] < 110.0)
    assert np.abs(error_dps[T_S[inside] < 20.0]).max() < 1e-3
    assert np.std(error_dps[steady]) < 0.01
    assert np.std(error_dps) < 0.2
    assert np.abs(motion.angle_deg - true_angle_deg(T_S))[inside].max() < 0.01


def test_rate_and_angle_are_of_one_curve() -> None:
    """Between the points too: the rate is the slope of the angle."""
    motion = motion_behind(seen())
    t_s = np.linspace(5.0, 195.0, 5001)
    later, earlier = motion.at(t_s + 1e-5)[0], motion.at(t_s - 1e-5)[0]
    assert np.allclose((later - earlier) / 2e-5, motion.at(t_s)[1], atol=1e-3)


def test_a_coarse_encoder_does_not_shake_the_motion() -> None:
    """Half a degree a step, and the rebuilt rate scatters by less than a deg/s."""
    motion = motion_behind(seen(cpr=720))
    steady = (T_S > 40.0) & (T_S < 110.0)
    assert np.std((motion.rate_dps - true_rate_dps(T_S))[steady]) < 0.5


def test_wild_samples_are_found_and_taken_out() -> None:
    """Of either sign, also while it turns quickly."""
    wild = {500: 30.0, 9000: -12.0, 15_000: 25.0}
    found = seen(wild=wild)
    assert sorted(found.spikes_dps.round().tolist()) == pytest.approx([-12.0, 25.0, 30.0], abs=1.0)
    assert np.abs(found.rate_dps - true_rate_dps(T_S)).max() < 1.0


def test_jumps_of_the_angle_are_found_and_taken_back() -> None:
    """And are not taken for wild rates."""
    found = seen(jumps={2000: 0.2, 9000: -0.3})
    assert sorted(found.slips_deg.tolist()) == pytest.approx([-0.3, 0.2], abs=0.02)
    assert np.abs(found.encoder_deg - true_angle_deg(T_S)).max() < 0.05
    assert len(found.spikes_dps) == 0


def test_steps_are_read_off_the_values() -> None:
    """Of dense and of sparse ones."""
    values = np.round(np.random.default_rng(1).normal(0.0, 3.0, 4000) / 0.25) * 0.25
    assert granularity(values) == pytest.approx(0.25)
    assert step_of(values) == pytest.approx(0.25)
    assert granularity(np.full(5, 1.0)) == 0.0
    assert step_of(np.full(5, 1.0)) == 0.0
