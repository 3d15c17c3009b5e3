"""Levels that values take, and medians, quantiles and maxima as numpy and scipy compute them."""

import numpy as np
import pytest
from scipy.ndimage import maximum_filter1d, median_filter

from gyrodrift.diagnose.recording.order_statistics import (
    distinct,
    median,
    median_of_five,
    median_of_nine,
    medians,
    quantiles,
    running_maximum,
)

RNG = np.random.default_rng(5)


@pytest.mark.parametrize("step", [0.0, 0.0305, 360.0 / 512])
@pytest.mark.parametrize("count", [0, 1, 2, 8, 5000])
def test_distinct_values_rise_and_come_once(count: int, step: float) -> None:
    values = RNG.normal(0.0, 100.0, count)
    values = np.rint(values / step) * step if step else values
    values[:: max(2, count // 4)] = np.resize([np.nan, 0.0, np.inf, -0.0], len(values[:: max(2, count // 4)]))
    assert np.array_equal(distinct(values), sorted({*np.round(values[np.isfinite(values)], 9)}))


@pytest.mark.parametrize("count", [1, 2, 3, 4, 5, 9, 10, 101, 1000])
@pytest.mark.parametrize("step", [0.0, 0.5])
def test_medians_quantiles_and_maxima_are_those_of_numpy_and_scipy(count: int, step: float) -> None:
    """Equal to the bit, with ties and with fewer values than a window."""
    values = RNG.standard_normal(count)
    values = np.rint(values / step) * step if step else values
    shares = (0.0, 0.05, 0.4, 0.5, 0.9, 1.0)
    rows = RNG.standard_normal((4, count))
    assert median(values) == np.median(values)
    assert np.array_equal(medians(rows), np.median(rows, axis=1))
    assert np.array_equal(quantiles(values, shares), np.quantile(values, shares))
    assert np.array_equal(quantiles(rows, 0.9), np.quantile(rows, 0.9, axis=1))
    assert np.array_equal(median_of_five(values), median_filter(values, 5))
    assert np.array_equal(median_of_nine(values), median_filter(values, 9))
    for length in {1, min(2, count), min(7, count)}:
        assert np.array_equal(running_maximum(values, length), maximum_filter1d(values, length))


def test_no_value_has_no_median() -> None:
    assert np.isnan(median(np.zeros(0)))
