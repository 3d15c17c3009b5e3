"""Change points of a bias: found where they are, and not where there are none."""

import numpy as np
import pytest

from gyrodrift.diagnose.predictive_checks.residual_series import change_points_of
from gyrodrift.values.arrays import Floats

SECONDS = 400
EVEN = np.ones(SECONDS, bool)


def noise(seed: int = 1) -> Floats:
    return np.random.default_rng(seed).normal(0.0, 0.005, SECONDS)


def test_change_points_are_found_with_their_height() -> None:
    level_dps = noise()
    level_dps[120:260] += 0.1
    result = change_points_of(level_dps, EVEN)
    assert [item.second for item in result] == pytest.approx([120, 260], abs=1)
    assert [item.step_dps for item in result] == pytest.approx([0.1, -0.1], abs=0.01)


def test_many_change_points_are_found() -> None:
    level_dps = noise() + 0.2 * (np.arange(SECONDS) // 20 % 2)
    assert len(change_points_of(level_dps, EVEN)) == SECONDS // 20 - 1


@pytest.mark.parametrize("seed", range(20))
def test_noise_has_no_change_points(seed: int) -> None:
    """Nor does what drifts, or an outlier."""
    position = np.arange(SECONDS)
    assert change_points_of(noise(seed), EVEN) == ()
    assert change_points_of(noise(seed) + 0.3 * np.exp(-position / 60.0), EVEN) == ()
    outlier = noise(seed)
    outlier[200] += 3.0
    assert change_points_of(outlier, EVEN) == ()


def test_a_drift_across_a_gap_is_no_change_point() -> None:
    """Seconds in which it accelerates are left out."""
    even = EVEN.copy()
    even[150:230] = False
    assert change_points_of(noise() + 0.001 * np.arange(SECONDS), even) == ()


@pytest.mark.parametrize("level_dps", [np.zeros(0), np.zeros(3), np.zeros(50), np.full(50, 1e9)])
def test_too_little_or_nothing_has_no_change_points(level_dps: Floats) -> None:
    assert change_points_of(level_dps, np.ones(len(level_dps), bool)) == ()
    assert change_points_of(level_dps, np.zeros(len(level_dps), bool)) == ()
