"""The size of the gap, and how much of it is closed."""

import numpy as np
import pytest
from inference_support import evidence

from gyrodrift.diagnose.features.vector import FEATURES
from gyrodrift.diagnose.inference.gap import by_session, gap_of, no_gap, returning_share, shrink_of, total_of

F = len(FEATURES)


def test_a_gap_is_a_root_mean_square() -> None:
    """Over features and over sessions; no z counts for more than 20."""
    assert by_session(np.array([[3.0, -4.0, 0.0, 0.0], [1e9, -20.0, 20.0, 20.0]])) == pytest.approx([2.5, 20.0])
    assert total_of(np.array([3.0, 4.0])) == pytest.approx(np.sqrt(12.5))


def test_shrink_is_the_share_above_the_floor_that_is_closed() -> None:
    """From 5 to 2 over a floor of 1 are three of four; below the floor there is nothing to win."""
    assert shrink_of(np.full(3, 5.0), np.full(3, 2.0), 1.0) == pytest.approx(0.75)
    assert shrink_of(np.full(3, 5.0), np.full(3, 0.2), 1.0) == 1.0
    assert shrink_of(np.full(3, 5.0), np.full(3, 6.0), 1.0) == pytest.approx(-0.25)


def test_where_there_is_no_gap_none_is_closed() -> None:
    """Within a twentieth of the floor."""
    assert shrink_of(np.full(3, 1.04), np.full(3, 0.2), 1.0) is None
    found = no_gap(evidence(np.full((4, F), 1.04)))
    assert (found.before, found.after, found.floor) == pytest.approx((1.04, 1.04, 1.0))
    assert found.shrink is found.shrink_low is found.shrink_high is None


def test_sessions_that_are_alike_leave_no_interval() -> None:
    """Whichever are drawn."""
    found = gap_of(evidence(np.full((4, F), 5.0)), np.full((4, F), 2.0))
    assert (found.before, found.after, found.floor) == pytest.approx((5.0, 2.0, 1.0))
    assert (found.shrink, found.shrink_low, found.shrink_high) == pytest.approx((0.75, 0.75, 0.75))


def test_sessions_that_differ_have_an_interval_around_the_whole() -> None:
    """From that of the worst session to that of the best; the same every time."""
    after = np.array([1.0, 2.0, 3.0, 4.0])[:, None] * np.ones(F)
    found = gap_of(evidence(np.full((4, F), 5.0)), after)
    assert found.shrink is not None
    assert found.shrink_low is not None
    assert found.shrink_high is not None
    assert 0.25 <= found.shrink_low < found.shrink < found.shrink_high <= 1.0
    assert found == gap_of(evidence(np.full((4, F), 5.0)), after)


def test_the_share_that_returns_without_a_cause_is_one_of_squares() -> None:
    """From 3 of 5 back to 4 of 5 are 7 of 25; no z counts for more than 20, and nothing returns below zero."""
    before = evidence(np.full((4, F), 5.0))
    after, without = np.full((4, F), 3.0), np.full((4, F), 4.0)
    assert returning_share(before, without, after) == pytest.approx(7.0 / 25.0)
    assert returning_share(before, after, without) == 0.0
    far = evidence(np.full((4, F), 90.0))
    assert returning_share(far, np.full((4, F), 80.0), np.full((4, F), 30.0)) == 0.0
    assert returning_share(evidence(np.zeros((4, F))), without, after) == 0.0
