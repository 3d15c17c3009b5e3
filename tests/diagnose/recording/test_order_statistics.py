"""Medians and quantiles are those of numpy and scipy, to the last bit."""

import numpy as np
import pytest
from scipy.ndimage import median_filter

from gyrodrift.diagnose.recording.order_statistics import (
    median,
    row_medians,
    row_quantiles,
    running_median_5,
    running_median_9,
)

RNG = np.random.default_rng(5)


@pytest.mark.parametrize("count", [1, 2, 3, 4, 7, 100, 1001])
def test_a_median_is_numpys(count: int) -> None:
    """Of odd and even numbers of values, equal ones among them."""
    values = np.round(RNG.normal(0.0, 1.0, count), 1) * 0.3
    assert median(values) == float(np.median(values))
    rows = RNG.normal(0.0, 1.0, (5, count))
    assert np.array_equal(row_medians(rows), np.median(rows, axis=1))


@pytest.mark.parametrize("count", [1, 2, 8, 100, 101])
@pytest.mark.parametrize("share", [0.0, 0.5, 0.9, 0.97, 1.0])
def test_a_quantile_is_numpys(count: int, share: float) -> None:
    """Between neighbours and at the ends."""
    rows = RNG.normal(0.0, 1.0, (7, count))
    assert np.array_equal(row_quantiles(rows, share), np.quantile(rows, share, axis=1))


@pytest.mark.parametrize("count", [1, 2, 3, 8, 9, 500])
def test_a_running_median_is_scipys(count: int) -> None:
    """Mirrored at the ends, also where there are fewer samples than it spans."""
    values = np.round(RNG.normal(0.0, 1.0, count), 1)
    assert np.array_equal(running_median_5(values), median_filter(values, 5))
    assert np.array_equal(running_median_9(values), median_filter(values, 9))
