"""Zeroing yaw of restlevel: the sigma counts from the zero, and yaw does not jump."""

import numpy as np
import pytest

from gyrodrift.filters.restlevel.model import RestlevelCoefficients, RestlevelParams, RestlevelState
from gyrodrift.filters.restlevel.step import coefficients, step
from gyrodrift.filters.restlevel.zero import scale_sigma_deg, with_scale_sigma, zero_yaw

RATE_HZ = 100.0
BIAS_DPS = 0.4
C = coefficients(RestlevelParams())
NO_SCALE = coefficients(RestlevelParams(scale_percent=0.0))


def run(
    state: RestlevelState,
    true_dps: np.ndarray[tuple[int], np.dtype[np.float64]],
    seed: int,
    c: RestlevelCoefficients = C,
) -> None:
    """Step through rates with a bias and white noise."""
    measured = true_dps + BIAS_DPS + np.random.default_rng(seed).normal(0.0, 0.05, len(true_dps))
    for rate_dps in measured.tolist():
        step(c, state, (state.samples + 1) / RATE_HZ, rate_dps)


def moving(seconds: float) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    return 40.0 * np.sin(np.arange(round(seconds * RATE_HZ)) / 40.0)


@pytest.mark.parametrize("gone_s", [0.0, 0.11, 0.25])
def test_sigma_restarts_at_a_zero_and_yaw_goes_on(gone_s: float) -> None:
    state = RestlevelState()
    run(state, moving(60.0 + gone_s), 1)
    before_deg, before_sigma_deg = state.yaw_deg, state.yaw_sigma_deg
    assert before_sigma_deg > 10.0
    zero_yaw(state)
    assert (state.yaw_deg, state.yaw_sigma_deg) == (before_deg, 0.0)
    run(state, np.zeros(1), 2)
    assert state.yaw_deg == pytest.approx(before_deg, abs=0.3)
    assert state.yaw_sigma_deg < 0.3


@pytest.mark.parametrize("seed", range(4))
def test_a_bias_found_after_a_zero_corrects_only_the_yaw_since(seed: int) -> None:
    """The yaw relative to the zero is right within its sigma, which counts the motion since the zero alone."""
    state, since = RestlevelState(), moving(10.0)
    run(state, moving(60.0), seed, NO_SCALE)
    zero_deg = state.yaw_deg
    zero_yaw(state)
    run(state, since, seed + 10, NO_SCALE)
    moved_sigma_deg = state.yaw_sigma_deg
    run(state, np.zeros(2000), seed + 20, NO_SCALE)
    error_deg = state.yaw_deg - zero_deg - since.sum() / RATE_HZ
    assert state.bias_dps == pytest.approx(BIAS_DPS, abs=0.02)
    assert moved_sigma_deg > 2.0
    assert abs(error_deg) < 3.0 * state.yaw_sigma_deg < 12.0


def test_a_zero_at_rest_stays_at_zero() -> None:
    """Zero a device that stands: yaw and sigma stay small."""
    state = RestlevelState()
    run(state, np.r_[np.zeros(1000), moving(30.0), np.zeros(1033)], 3)
    zero_deg = state.yaw_deg
    zero_yaw(state)
    run(state, np.zeros(1000), 4)
    assert state.yaw_deg == pytest.approx(zero_deg, abs=0.02)
    assert state.yaw_sigma_deg < 0.02


def test_a_zero_before_the_first_sample_changes_nothing() -> None:
    state = RestlevelState()
    zero_yaw(state)
    assert state == RestlevelState()


def test_the_scale_share_counts_from_the_zero_and_shrinks_with_a_calibration() -> None:
    """A turn of 360 deg with a scale sigma of 1 % adds 3.6 deg, and more for the way; after a zero nothing."""
    state = RestlevelState()
    run(state, np.r_[np.zeros(1000), np.full(400, 90.0), np.zeros(1000)], 5)
    calibrated = coefficients(with_scale_sigma(RestlevelParams(), 0.001))
    share_deg = scale_sigma_deg(C, state)
    assert 3.6 < share_deg <= state.yaw_sigma_deg
    assert scale_sigma_deg(calibrated, state) == pytest.approx(0.1 * share_deg)
    assert with_scale_sigma(RestlevelParams(), 0.02) == RestlevelParams()
    zero_yaw(state)
    assert scale_sigma_deg(C, state) == 0.0
