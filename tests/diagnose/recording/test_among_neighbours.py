"""Held samples: found on slopes of any rate and noise, and none where a motion only begins or ends."""

import numpy as np
import pytest

from gyrodrift.arrays import Floats, Mask
from gyrodrift.diagnose.recording.among_neighbours import held_on_a_slope

SEEDS = range(40)


def quantised(rate_dps: Floats, rng: np.random.Generator) -> tuple[Floats, float]:
    """As a gyro of some noise and some step gives it, and the noise of a sample."""
    lsb_dps, sigma_dps = rng.uniform(0.007, 0.061), rng.uniform(0.005, 0.1)
    noisy_dps = rate_dps + rng.normal(0.0, sigma_dps, len(rate_dps))
    return lsb_dps * np.rint(noisy_dps / lsb_dps), max(sigma_dps, lsb_dps / np.sqrt(12.0))


def held(rate_dps: Floats, which: Mask) -> Floats:
    """Each of those repeats the one before it."""
    held_dps = rate_dps.copy()
    held_dps[which] = rate_dps[np.flatnonzero(which) - 1]
    return held_dps


@pytest.mark.parametrize("seed", SEEDS)
def test_where_a_motion_begins_or_ends_a_sample_is_not_held(seed: int) -> None:
    """Rests between ramps of any steepness, that begin and end between two samples; noise may pass for one slope."""
    rng = np.random.default_rng(seed)
    corners = np.cumsum(rng.uniform(5.0, 30.0, 200))
    levels_dps = np.repeat(rng.uniform(-100.0, 100.0, 100) * (np.arange(100) % 2), 2)
    rate_dps, sigma_dps = quantised(np.interp(np.arange(corners[-1]), corners, levels_dps), rng)
    assert np.count_nonzero(np.diff(rate_dps) == 0.0) > 10
    assert np.count_nonzero(held_on_a_slope(rate_dps, sigma_dps)) <= 1


@pytest.mark.parametrize("seed", SEEDS)
def test_a_sample_that_repeats_the_one_before_it_is_found_on_a_slope(seed: int) -> None:
    """And nothing else is."""
    rng = np.random.default_rng(seed)
    phase = rng.uniform(0.005, 0.1) * np.arange(4000)
    smooth_dps = rng.uniform(50.0, 500.0) * np.sin(phase)
    sampled_dps, sigma_dps = quantised(smooth_dps, rng)
    which = np.zeros(len(phase), bool)
    which[rng.choice(np.arange(4, len(phase), 4), 200, replace=False)] = True
    found = held_on_a_slope(held(sampled_dps, which), sigma_dps)
    slope_dps = np.gradient(smooth_dps)
    steep = which & (np.abs(slope_dps) > np.maximum(12.0 * sigma_dps, 3.0 * np.abs(np.gradient(slope_dps))))
    assert np.count_nonzero(steep & found) > 0.98 * np.count_nonzero(steep)
    assert not found[~which].any()
