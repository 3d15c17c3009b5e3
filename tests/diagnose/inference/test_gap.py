"""The size of the gap, and how much of it is closed."""

import numpy as np
import pytest
from inference_support import evidence

from gyrodrift.diagnose.features.vector import FEATURES
from gyrodrift.diagnose.inference.gap import (
    HeldOut,
    by_session,
    distribution_squares,
    gap_of,
    no_gap,
    returning_share,
    shrink_of,
    total_of,
)
from gyrodrift.values.arrays import Floats

F = len(FEATURES)


def certain(z: Floats) -> HeldOut:
    """The simulator with causes that are not random."""
    return HeldOut(z, np.zeros_like(z))


def test_a_gap_is_a_root_mean_square() -> None:
    assert by_session(np.array([[3.0, -4.0, 0.0, 0.0], [1e9, -20.0, 20.0, 20.0]])) == pytest.approx([2.5, 20.0])
    assert total_of(np.array([3.0, 4.0])) == pytest.approx(np.sqrt(12.5))


def test_shrink_is_the_share_above_the_floor_that_is_closed() -> None:
    assert shrink_of(np.full(3, 5.0), np.full(3, 2.0), 1.0) == pytest.approx(0.75)
    assert shrink_of(np.full(3, 5.0), np.full(3, 0.2), 1.0) == 1.0
    assert shrink_of(np.full(3, 5.0), np.full(3, 6.0), 1.0) == pytest.approx(-0.25)


def test_where_there_is_no_gap_none_is_closed() -> None:
    assert shrink_of(np.full(3, 1.04), np.full(3, 0.2), 1.0) is None
    result = no_gap(evidence(np.full((4, F), 1.04)))
    assert (result.before, result.after, result.floor) == pytest.approx((1.04, 1.04, 1.0))
    assert result.shrink is result.shrink_low is result.shrink_high is None


def test_sessions_that_are_alike_leave_no_interval() -> None:
    result = gap_of(evidence(np.full((4, F), 5.0)), certain(np.full((4, F), 2.0)))
    assert (result.before, result.after, result.floor) == pytest.approx((5.0, 2.0, 1.0))
    assert (result.shrink, result.shrink_low, result.shrink_high) == pytest.approx((0.75, 0.75, 0.75))


def test_sessions_that_differ_have_an_interval_around_the_whole() -> None:
    after = certain(np.array([1.0, 2.0, 3.0, 4.0])[:, None] * np.ones(F))
    result = gap_of(evidence(np.full((4, F), 5.0)), after)
    assert result.shrink is not None
    assert result.shrink_low is not None
    assert result.shrink_high is not None
    assert 0.25 <= result.shrink_low < result.shrink < result.shrink_high <= 1.0
    assert result == gap_of(evidence(np.full((4, F), 5.0)), after)


def test_the_share_that_returns_without_a_cause_is_one_of_squares() -> None:
    before = evidence(np.full((4, F), 5.0))
    after, without = certain(np.full((4, F), 3.0)), certain(np.full((4, F), 4.0))
    assert returning_share(before, without, after) == pytest.approx(7.0 / 25.0)
    assert returning_share(before, after, without) == 0.0
    assert returning_share(evidence(np.zeros((4, F))), without, after) == 0.0


def test_the_share_of_a_very_large_error_is_that_of_the_error() -> None:
    result = gap_of(evidence(np.full((4, F), 400.0)), certain(np.full((4, F), 40.0)))
    assert result.shrink == pytest.approx((20.0 - 2.0) / (20.0 - 1.0))


@pytest.mark.parametrize("width", [4.0, 25.0, 100.0])
def test_a_wide_random_cause_closes_nothing_of_a_shift(width: float) -> None:
    shift = evidence(np.full((4, F), 5.0))
    result = gap_of(shift, HeldOut(shift.z, np.full((4, F), width)))
    assert result.shrink is not None
    assert result.shrink <= 0.0


def test_a_right_random_cause_closes_the_spread_that_it_predicts() -> None:
    z = 4.0 * np.random.default_rng(0).standard_normal((5, 2000))
    assert distribution_squares(z, np.full((5, 2000), 15.0)).mean() == pytest.approx(1.0, abs=0.8)
    assert distribution_squares(z, np.zeros((5, 2000))).mean() > 10.0
