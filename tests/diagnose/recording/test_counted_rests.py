"""A rest within its count: whatever path is drawn, of whatever encoder."""

import numpy as np
import pytest

from gyrodrift.diagnose.recording.counted_rests import CountedRests, counted_rests
from gyrodrift.values.arrays import Floats

SAMPLES = 1000
SPANS = ((0, 150), (300, 400), (420, 425), (700, 1000))


def rounded(count_deg: float, zero_deg: float, angle_deg: Floats) -> Floats:
    nearest: Floats = np.rint((angle_deg - zero_deg) / count_deg) * count_deg + zero_deg
    return nearest


@pytest.mark.parametrize("seed", range(40))
def test_a_path_rests_within_the_counts_that_were_read(seed: int) -> None:
    rng = np.random.default_rng(seed)
    count_deg, zero_deg, away_deg = np.exp(rng.uniform(-5.0, 0.0)), rng.uniform(-1.0, 1.0), rng.uniform(-3.0, 3.0)
    true_deg = np.cumsum(rng.normal(0.0, 0.3, SAMPLES))
    for first, end in SPANS:
        true_deg[first:end] = true_deg[first]
    read_deg = rounded(count_deg, zero_deg, true_deg)
    result = counted_rests(
        SPANS, read_deg, read_deg + away_deg, lambda angle: rounded(count_deg, zero_deg, angle), count_deg
    )
    path_deg = true_deg + away_deg + np.interp(np.arange(SAMPLES), np.linspace(0, SAMPLES, 9), rng.normal(0.0, 0.4, 9))
    for first, end in SPANS:
        path_deg[first:end] = path_deg[first:end].mean()
    moved_deg = path_deg + result.correction_deg(path_deg)
    for first, end in SPANS:
        middle_deg = read_deg[first] + away_deg
        off, was_off = abs(moved_deg[first] - middle_deg), abs(path_deg[first] - middle_deg)
        assert off < 0.51 * count_deg
        assert off <= was_off + 1e-9
        if was_off < 0.49 * count_deg:
            assert moved_deg[first] == path_deg[first]
        np.testing.assert_allclose(moved_deg[first:end], moved_deg[first])


def test_between_rests_it_moves_along_lines() -> None:
    within = CountedRests(((0, 3), (7, 10)), np.array([0.0, 0.0]), np.array([1.0, 1.0]))
    way = within.correction_deg(np.where(np.arange(10) < 5, 0.5, 1.4))
    np.testing.assert_allclose(way, [0.0, 0.0, 0.0, -0.16, -0.32, -0.48, -0.64, -0.8, -0.8, -0.8])


def test_without_a_rest_nothing_is_moved() -> None:
    none = np.empty(0)
    assert not CountedRests((), none, none).correction_deg(np.linspace(0.0, 50.0, SAMPLES)).any()


def test_a_coarse_disc_read_in_fine_steps_stands_for_the_interval_of_its_own() -> None:
    def read(angle: Floats) -> Floats:
        return np.floor(rounded(2.5, 0.0, angle) + 0.5 + 1e-6)

    index = np.array([3.0] * 10 + [5.0] * 10)
    result = counted_rests(((0, 10), (10, 20)), index, index, read, 2.5)
    np.testing.assert_allclose(result.low_deg, [1.25, 3.75], atol=0.02)
    np.testing.assert_allclose(result.high_deg, [3.75, 6.25], atol=0.02)
