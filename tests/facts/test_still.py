"""Rest in a stream: limits relative to noise, lost samples, and the quietest windows."""

import numpy as np
import pytest

from gyrodrift.facts.arrays import median_slope, robust_sigma, true_runs, white_noise
from gyrodrift.facts.still import StillRule, has_hole, quiet_windows

RULE = StillRule(level=0.2, level_errors=6.0, scatter=0.3, scatter_sigmas=3.0)


@pytest.mark.parametrize(("change", "noise", "expected"), [(0.19, 0.0, True), (0.25, 0.1, False), (0.25, 0.5, True)])
def test_a_mean_is_level_within_the_floor_or_its_errors(*, change: float, noise: float, expected: bool) -> None:
    """Six standard errors of the mean of a hundred samples."""
    assert RULE.is_level(change, noise, 100) is expected


@pytest.mark.parametrize(
    ("deviation", "noise", "expected"), [(0.29, 0.0, True), (0.31, 0.1, False), (0.31, 0.11, True)]
)
def test_a_block_is_calm_within_the_floor_or_its_noise(*, deviation: float, noise: float, expected: bool) -> None:
    """Three standard deviations of a sample."""
    assert RULE.is_calm(deviation, noise) is expected


def test_lost_samples_make_a_hole() -> None:
    """Two of them do not, since clocks jitter."""
    assert not has_hole(np.array([0.0, 1.0, 4.0]), 1.0)
    assert has_hole(np.array([0.0, 1.0, 5.0]), 1.0)


def test_windows_with_motion_or_another_rate_are_not_quiet() -> None:
    """A window that shakes and a window that turns evenly, among twelve."""
    means, deviations = np.full(12, 0.3), np.full(12, 0.05)
    deviations[3], means[7] = 0.2, 20.0
    assert np.flatnonzero(~quiet_windows(means, deviations, 2.0, 1.0)).tolist() == [3, 7]


def test_noise_scatter_and_slope_ignore_what_is_not_theirs() -> None:
    """A slow motion under white noise, and outliers on a line."""
    rng = np.random.default_rng(1)
    noise = 0.1 * rng.standard_normal(10_000)
    assert white_noise(noise + np.sin(np.arange(10_000) / 1000.0)) == pytest.approx(0.1, rel=0.03)
    outlying = np.where(np.arange(10_000) % 20 == 0, 50.0, noise)
    assert robust_sigma(outlying) == pytest.approx(0.1, rel=0.1)
    x = np.arange(30.0)
    assert median_slope(x, np.where(x == 7.0, 99.0, 2.0 * x)) == pytest.approx(2.0)


def test_runs_are_half_open() -> None:
    assert true_runs(np.array([True, True, False, True])) == ((0, 2), (3, 4))
    assert true_runs(np.zeros(3, bool)) == ()
