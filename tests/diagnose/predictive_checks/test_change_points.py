"""Jumps of a bias: found where they are, and not where there are none."""

import numpy as np
import pytest

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.predictive_checks.change_points import jumps_of

SECONDS = 400
EVEN = np.ones(SECONDS, bool)


def noise(seed: int = 1) -> Floats:
    return np.random.default_rng(seed).normal(0.0, 0.005, SECONDS)


def test_jumps_are_found_with_their_height() -> None:
    """There and back."""
    level_dps = noise()
    level_dps[120:260] += 0.1
    found = jumps_of(level_dps, EVEN)
    assert [jump.second for jump in found] == pytest.approx([120, 260], abs=1)
    assert [jump.step_dps for jump in found] == pytest.approx([0.1, -0.1], abs=0.01)


def test_many_jumps_are_found() -> None:
    """A bias on two levels."""
    level_dps = noise() + 0.2 * (np.arange(SECONDS) // 20 % 2)
    assert len(jumps_of(level_dps, EVEN)) == SECONDS // 20 - 1


@pytest.mark.parametrize("seed", range(20))
def test_noise_does_not_jump(seed: int) -> None:
    """Nor does what drifts, or a wild second."""
    place = np.arange(SECONDS)
    assert jumps_of(noise(seed), EVEN) == ()
    assert jumps_of(noise(seed) + 0.3 * np.exp(-place / 60.0), EVEN) == ()
    wild = noise(seed)
    wild[200] += 3.0
    assert jumps_of(wild, EVEN) == ()


def test_a_drift_across_a_gap_is_no_jump() -> None:
    """Seconds in which it accelerates are left out."""
    even = EVEN.copy()
    even[150:230] = False
    assert jumps_of(noise() + 0.001 * np.arange(SECONDS), even) == ()


@pytest.mark.parametrize("level_dps", [np.zeros(0), np.zeros(3), np.zeros(50), np.full(50, 1e9)])
def test_too_little_or_nothing_has_no_jumps(level_dps: Floats) -> None:
    """And no warning."""
    assert jumps_of(level_dps, np.ones(len(level_dps), bool)) == ()
    assert jumps_of(level_dps, np.zeros(len(level_dps), bool)) == ()
