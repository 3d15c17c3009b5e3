"""Medians and quantiles are those of numpy and scipy, to the last bit."""

import numpy as np
import pytest
from scipy.ndimage import median_filter

from gyrodrift.diagnose.recording.order_statistics import (
    different,
    distinct,
    median,
    quantile,
    quantiles,
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


@pytest.mark.parametrize("power", [1, 9, 100])
@pytest.mark.parametrize("count", [33, 34, 999, 20_000])
def test_a_median_is_numpys_however_far_apart_values_lie(count: int, power: int) -> None:
    """Where nearly all of them share one bin, again and again; and where they all are the same but one."""
    values = RNG.normal(0.0, 1.0, count) ** power
    assert median(values) == float(np.median(values))
    values[1:] = 2.0
    assert median(values) == 2.0


@pytest.mark.parametrize("count", [1, 2, 8, 100, 101])
@pytest.mark.parametrize("share", [0.0, 0.5, 0.9, 0.97, 1.0])
def test_a_quantile_is_numpys(count: int, share: float) -> None:
    """Between neighbours and at the ends."""
    rows = RNG.normal(0.0, 1.0, (7, count))
    assert np.array_equal(row_quantiles(rows, share), np.quantile(rows, share, axis=1))
    assert [quantile(row, share) for row in rows] == np.quantile(rows, share, axis=1).tolist()


@pytest.mark.parametrize("count", [1, 2, 3, 8, 100, 101])
def test_several_quantiles_are_numpys(count: int) -> None:
    """Of equal values too, in any order of the shares."""
    values = np.round(RNG.normal(0.0, 1.0, count), 1) * 0.3
    shares = (0.01, 0.5, 0.25, 1.0, 0.99, 0.0)
    assert quantiles(values, shares) == tuple(np.quantile(values, shares))


def test_equal_values_count_once() -> None:
    """Four values, two of them twice, and none."""
    assert different(np.array([3.0, -1.0, 3.0, 0.5, -1.0, 7.0])) == 4
    assert different(np.zeros(0)) == 0


@pytest.mark.parametrize("step", [0.0, 0.0305, 360.0 / 512])
@pytest.mark.parametrize("count", [0, 1, 2, 8, 5000])
def test_distinct_values_are_numpys(count: int, step: float) -> None:
    """On a grid and off it, both zeros, what is no number left out."""
    values = RNG.normal(0.0, 100.0, count)
    values = np.rint(values / step) * step if step else values
    values[:: max(2, count // 4)] = np.resize([np.nan, 0.0, np.inf, -0.0], len(values[:: max(2, count // 4)]))
    assert np.array_equal(distinct(values, 9), np.unique(np.round(values[np.isfinite(values)], 9)))


@pytest.mark.parametrize("count", [1, 2, 3, 8, 9, 500])
def test_a_running_median_is_scipys(count: int) -> None:
    """Mirrored at the ends, also where there are fewer samples than it spans."""
    values = np.round(RNG.normal(0.0, 1.0, count), 1)
    assert np.array_equal(running_median_5(values), median_filter(values, 5))
    assert np.array_equal(running_median_9(values), median_filter(values, 9))
