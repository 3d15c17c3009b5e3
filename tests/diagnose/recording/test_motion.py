"""Motion between the samples of a recording, before them and after, and its temperature."""

from functools import cache

import numpy as np
import pytest

from gyrodrift.diagnose.recording.gyro_noise import GyroModel
from gyrodrift.diagnose.recording.motion import ReplayedMotion
from gyrodrift.diagnose.recording.motion_posterior import motion_posterior_of
from gyrodrift.diagnose.recording.outliers import clean
from gyrodrift.diagnose.recording.recording import recording_of
from gyrodrift.session.session import Session
from gyrodrift.values.arrays import Floats

RATE_HZ = 100.0
T_S = np.arange(20_000) / RATE_HZ
GYRO = GyroModel(0.0)


def true_angle_deg(t_s: Floats) -> Floats:
    """Rest, a smooth start, steady turning, and swings of up to 6 Hz."""
    turning = 20.0 * np.logaddexp(0.0, (t_s - 30.0) * 4.0) / 4.0
    swings = np.where(
        t_s > 120.0, 4.0 * np.sin(2.0 * np.pi * 6.0 * t_s) / (2.0 * np.pi * 6.0) * np.tanh(t_s - 120.0), 0.0
    )
    return turning + swings


def true_rate_dps(t_s: Floats) -> Floats:
    return (true_angle_deg(t_s + 5e-5) - true_angle_deg(t_s - 5e-5)) / 1e-4


@cache
def rebuilt(noise_dps: float = 0.05, cpr: int = 36_000, *, is_warm: bool = False) -> ReplayedMotion:
    rate_dps = true_rate_dps(T_S) + np.random.default_rng(3).normal(0.0, noise_dps, len(T_S))
    angle_deg = np.round(true_angle_deg(T_S) * cpr / 360.0) * 360.0 / cpr
    temp_c = np.round(20.0 + T_S / 50.0, 1) if is_warm else None
    session = Session("s", T_S, rate_dps, None, np.arange(len(T_S)), angle_deg, temp_c)
    return motion_posterior_of(clean(recording_of(session)), GYRO).mean


def test_the_motion_is_that_of_the_device() -> None:
    motion = rebuilt()
    inside = slice(100, -100)
    error_dps = (motion.rate_dps - true_rate_dps(T_S))[inside]
    steady = (T_S[inside] > 40.0) & (T_S[inside] < 110.0)
    assert not motion.rate_dps[T_S < 20.0].any()
    assert np.std(error_dps[steady]) < 0.01
    assert np.std(error_dps) < 0.05
    assert np.abs(motion.angle_deg - true_angle_deg(T_S))[inside].max() < 0.01


def test_a_coarse_encoder_does_not_shake_the_motion() -> None:
    motion = rebuilt(cpr=720)
    steady = (T_S > 40.0) & (T_S < 110.0)
    assert np.std((motion.rate_dps - true_rate_dps(T_S))[steady]) < 0.05


def test_rate_and_angle_are_of_one_curve() -> None:
    motion = rebuilt()
    t_s = np.linspace(5.0, 195.0, 5001)
    later, earlier = motion.motion_at(t_s + 1e-5)[0], motion.motion_at(t_s - 1e-5)[0]
    assert np.allclose((later - earlier) / 2e-5, motion.motion_at(t_s)[1], atol=1e-3)


def test_the_temperature_is_smoothed_and_known_between_samples() -> None:
    """A ramp of 1 °C in 50 s, read to a tenth of a degree."""
    motion = rebuilt(is_warm=True)
    assert np.abs(motion.sensor_c - (20.0 + T_S / 50.0)).max() < 0.06
    assert motion.sensor_c_at(np.array([60.005, 500.0])) == pytest.approx([21.2, 24.0], abs=0.06)


def test_without_a_temperature_it_is_that_of_the_room() -> None:
    assert np.all(rebuilt().sensor_c == 25.0)


def test_before_the_first_sample_it_rests() -> None:
    motion = rebuilt()
    angle_deg, rate_dps = motion.motion_at(np.array([-1.0, 1e6]))
    assert rate_dps[0] == 0.0
    assert angle_deg == pytest.approx(motion.angle_deg[[0, -1]], abs=1e-3)
