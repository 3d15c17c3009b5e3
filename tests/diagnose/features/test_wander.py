"""How a bias wanders and scatters, of series of known statistics."""

import numpy as np
import pytest
from features_support import white

from gyrodrift.diagnose.features.block_means import LEAST_DPS, block_means, log_variance

NOTHING = np.log(LEAST_DPS**2)


def test_a_variance_is_that_of_white_noise() -> None:
    assert np.exp(0.5 * log_variance(white(0.1))) == pytest.approx(0.1, rel=0.02)


def test_one_outlier_adds_a_bounded_part() -> None:
    values = np.ones(100)
    values[7] = 1e6
    assert np.exp(log_variance(values)) == pytest.approx(0.99 + 0.30, rel=1e-3)


@pytest.mark.parametrize("values", [[], [0.0], [0.0] * 50])
def test_nothing_scatters_by_the_least(values: list[float]) -> None:
    """Empty, a single block, and constant."""
    assert log_variance(np.array(values)) == pytest.approx(NOTHING)


@pytest.mark.parametrize("count", [1, 5, 20])
def test_means_of_white_noise_scatter_less(count: int) -> None:
    """Steps between means of n have a variance of 2 / n."""
    steps = np.diff(block_means(white(0.3, count=40_000), count))
    assert np.exp(log_variance(steps)) == pytest.approx(2.0 * 0.3**2 / count, rel=0.08)


def test_means_are_of_whole_blocks() -> None:
    assert block_means(np.array([1.0, 3.0, 5.0, 9.0, 100.0]), 2).tolist() == [2.0, 7.0]
    assert len(block_means(np.ones(3), 4)) == 0
