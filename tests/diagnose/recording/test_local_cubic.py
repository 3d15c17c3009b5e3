"""Noise is taken out of what is smooth, and corners stay."""

import numpy as np
import pytest

from gyrodrift.diagnose.recording.motion_posterior import local_cubic
from gyrodrift.values.arrays import Floats

SAMPLE_RATE_HZ, SIGMA = 100.0, 0.02
T_S = np.arange(3000) / SAMPLE_RATE_HZ


def noise() -> Floats:
    return np.random.default_rng(5).normal(0.0, SIGMA, len(T_S))


@pytest.mark.parametrize("hz", [0.1, 0.5, 1.0])
def test_a_smooth_motion_loses_its_noise(hz: float) -> None:
    sine_dps = 60.0 * np.sin(2.0 * np.pi * hz * T_S)
    remaining = local_cubic(sine_dps + noise(), SIGMA, 30) - sine_dps
    assert remaining[100:-100].std() < SIGMA * 2.0 / 3.0


def test_a_corner_stays_where_and_what_it_is() -> None:
    dice = np.random.default_rng(7)
    ramp_dps = np.maximum(0.0, 90.0 * (T_S - 15.0))
    near = slice(1490, 1511)
    result = [local_cubic(ramp_dps + dice.normal(0.0, SIGMA, len(T_S)), SIGMA, 30)[near] for _ in range(100)]
    off = np.mean(result, axis=0) - ramp_dps[near]
    assert np.abs(off).max() < 4.0 * SIGMA / np.sqrt(100.0)


def test_what_is_shorter_than_a_window_stays() -> None:
    values = np.array([1.0, 2.0, 4.0])
    assert np.array_equal(local_cubic(values, SIGMA, 30), values)


def test_no_window_is_wider_than_asked_for() -> None:
    values = noise()
    assert np.array_equal(local_cubic(values, SIGMA, 1), values)
    assert local_cubic(values, SIGMA, 2).std() > 1.3 * local_cubic(values, SIGMA, 30).std()
