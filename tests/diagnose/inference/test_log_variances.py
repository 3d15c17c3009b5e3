"""Changes between simulated sizes: linear features and variances that are added are exact."""

from dataclasses import replace

import numpy as np
import pytest
from inference_support import candidate, row

from gyrodrift.diagnose.features.vector import (
    FEATURES,
    IS_LOG,
    LEAST_VARIANCE,
    LINEAR,
    NUMBER,
    combined,
    in_device,
)
from gyrodrift.diagnose.inference.log_variances import between_scaled, interpolated

LOG = FEATURES[int(np.flatnonzero(IS_LOG & ~LINEAR)[0])].name
POINTS, BETWEEN = np.array([1.0, 4.0, 16.0]), np.array([1.0, 2.0, 4.0, 7.0, 16.0, 20.0])
TRIED = replace(candidate("rate_random_walk"), grid_points=POINTS, sizes=BETWEEN)


def test_a_change_in_proportion_to_the_size_is_exact_between_simulated_sizes() -> None:
    nodes = np.array([row({"rate": 3.0 * point}) for point in POINTS])
    assert between_scaled(TRIED, nodes)[:, NUMBER["rate"]] == pytest.approx(3.0 * BETWEEN)


def test_an_added_variance_is_exact_between_simulated_sizes() -> None:
    """The variance is 1 + 0.5 size² times as large."""
    nodes = np.array([row({LOG: np.log1p(0.5 * point**2)}) for point in POINTS])
    assert between_scaled(TRIED, nodes)[:, NUMBER[LOG]] == pytest.approx(np.log1p(0.5 * BETWEEN**2))


def test_realisations_are_scaled_one_by_one() -> None:
    draws = np.random.default_rng(1).standard_normal((2, 5, 1)) * row({"rate": 1.0})
    nodes = POINTS[:, None, None, None] * draws
    assert between_scaled(TRIED, nodes) == pytest.approx(BETWEEN[:, None, None, None] * draws)


def test_two_added_variances_add() -> None:
    """Doubled and tripled is fourfold; a variance that one takes away is a factor."""
    double, triple, half = (row({LOG: np.log(factor), "rate": 1.0}) for factor in (2.0, 3.0, 0.5))
    total = combined(double, triple)
    assert (total[NUMBER[LOG]], total[NUMBER["rate"]]) == pytest.approx((np.log(4.0), 2.0))
    assert combined(double, half)[NUMBER[LOG]] == pytest.approx(0.0)
    assert combined(half, half)[NUMBER[LOG]] == pytest.approx(np.log(0.25))
    assert combined(row({LOG: -90.0}), row({LOG: -90.0}))[NUMBER[LOG]] < np.log(LEAST_VARIANCE)


def test_a_device_that_wanders_anyway_hides_a_small_wander() -> None:
    """Variances and shares of samples add to those of the device: 4 + 3 is 7/4 of 4, and 1 % + 3 % is twice 1 %."""
    simulated, offset = row({"equal_moving": 0.0}), row({LOG: np.log(4.0), "equal_moving": 0.1, "rate": 5.0})
    change = in_device(row({LOG: np.log(4.0), "equal_moving": 0.03**0.5, "rate": 3.0}), offset, simulated)
    assert change[NUMBER[LOG]] == pytest.approx(np.log(7.0 / 4.0))
    assert (change[NUMBER["equal_moving"]], change[NUMBER["rate"]]) == pytest.approx((0.1, 3.0))
    assert not in_device(row({}), offset, simulated).any()


def test_a_share_of_samples_is_exact_between_simulated_sizes() -> None:
    """A change of a root is a power of the size: 0.5 alone, and 1 beside a larger share."""
    nodes = np.array([row({"equal_moving": 0.1 * point**0.5, "drop_share": 1e-3 * point}) for point in POINTS])
    change = interpolated(TRIED, nodes)
    assert change[:-1, NUMBER["equal_moving"]] == pytest.approx(0.1 * BETWEEN[:-1] ** 0.5)
    assert change[:-1, NUMBER["drop_share"]] == pytest.approx(1e-3 * BETWEEN[:-1])
