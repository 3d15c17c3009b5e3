"""The size of the gap, and how much of it is closed."""

import numpy as np
import pytest
from inference_support import evidence

from gyrodrift.diagnose.features.vector import FEATURES
from gyrodrift.diagnose.inference.gap import by_session, gap_of, no_gap, returning_share, shrink_of, total_of

F = len(FEATURES)


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
    result = gap_of(evidence(np.full((4, F), 5.0)), np.full((4, F), 2.0))
    assert (result.before, result.after, result.floor) == pytest.approx((5.0, 2.0, 1.0))
    assert (result.shrink, result.shrink_low, result.shrink_high) == pytest.approx((0.75, 0.75, 0.75))


def test_sessions_that_differ_have_an_interval_around_the_whole() -> None:
    after = np.array([1.0, 2.0, 3.0, 4.0])[:, None] * np.ones(F)
    result = gap_of(evidence(np.full((4, F), 5.0)), after)
    assert result.shrink is not None
    assert result.shrink_low is not None
    assert result.shrink_high is not None
    assert 0.25 <= result.shrink_low < result.shrink < result.shrink_high <= 1.0
    assert result == gap_of(evidence(np.full((4, F), 5.0)), after)


def test_the_share_that_returns_without_a_cause_is_one_of_squares() -> None:
    before = evidence(np.full((4, F), 5.0))
    after, without = np.full((4, F), 3.0), np.full((4, F), 4.0)
    assert returning_share(before, without, after) == pytest.approx(7.0 / 25.0)
    assert returning_share(before, after, without) == 0.0
    far = evidence(np.full((4, F), 90.0))
    assert returning_share(far, np.full((4, F), 80.0), np.full((4, F), 30.0)) == 0.0
    assert returning_share(evidence(np.zeros((4, F))), without, after) == 0.0
