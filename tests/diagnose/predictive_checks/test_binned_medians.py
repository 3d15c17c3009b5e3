"""The shape of a cloud: bins that hold every value once, medians that follow it, and how high it is."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gyrodrift.diagnose.predictive_checks.binned_medians import LEAST, bins_of, medians, trend_rms_dps

RNG = np.random.default_rng(2)
X = np.sort(RNG.uniform(-100.0, 100.0, 2000))


@given(st.lists(st.integers(-20, 20) | st.floats(-1e6, 1e6), max_size=300))
def test_bins_part_the_values(values: list[float]) -> None:
    x = np.sort(np.array(values, dtype=np.float64))
    bins = bins_of(x)
    assert all(item.stop - item.start >= LEAST for item in bins)
    for remaining, right in pairwise(bins):
        assert remaining.stop <= right.start
        assert x[remaining.stop - 1] < x[right.start]


def test_medians_follow_a_shape() -> None:
    """Past outliers, with an error that holds."""
    y = np.abs(X) + RNG.normal(0.0, 5.0, len(X))
    y[::50] = 1e4
    result = medians(X, y)
    assert len(result.x) > 10
    assert np.abs(result.y - np.abs(result.x)).max() < 5.0
    assert 0.2 < np.median(result.error) < 2.0


def test_values_that_come_often_have_a_bin_of_their_own() -> None:
    x = np.sort(np.concatenate([np.zeros(1000), X]))
    y = np.where(x == 0.0, 3.0, 0.0)
    assert medians(x, y).y.max() == 3.0


def test_a_shape_is_as_high_as_it_is() -> None:
    """RMS of what follows x; noise alone has next to none."""
    noise = RNG.normal(0.0, 1.0, len(X))
    assert trend_rms_dps(X, 0.02 * X + noise) == pytest.approx(np.std(0.02 * X), rel=0.1)
    assert trend_rms_dps(X, noise) < 0.1


def test_nothing_has_no_shape() -> None:
    assert trend_rms_dps(np.zeros(0), np.zeros(0)) == trend_rms_dps(np.zeros(9), np.ones(9)) == 0.0
    assert len(medians(np.zeros(0), np.zeros(0)).x) == 0


def test_values_that_differ_by_rounding_alone_are_one_bin() -> None:
    for value in (1.0, 1e-17, 5e-324):
        values = np.repeat([value, np.nextafter(value, 2.0)], 100)
        assert bins_of(values) == [slice(0, 200)]
