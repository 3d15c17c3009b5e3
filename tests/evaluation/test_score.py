"""Scores by their definitions, equal to the sums of the kernels."""

import numpy as np
import pytest

pytest.importorskip("numba", reason="comparing needs the workstation extra")
from gyrodrift.evaluation.kernels.hdr import sums
from gyrodrift.evaluation.reference import Reference
from gyrodrift.evaluation.score import Score, mean_score, score_of


def reference(count: int = 400) -> Reference:
    dice = np.random.default_rng(1)
    reference_deg = np.cumsum(dice.normal(0.0, 0.1, count))
    reference_deg -= reference_deg[0]
    reference_deg[3::7] = np.nan
    dt_s = np.full(count, 0.01)
    dt_s[0] = 0.0
    return Reference("walk", dt_s, dice.normal(0.0, 10.0, count), reference_deg, 0.5)


def test_scores_of_a_yaw_computed_by_hand() -> None:
    """Samples without a reference are ignored; NE is E over the minutes."""
    yaw_deg = np.array([0.0, 1.0, 99.0, -3.0])
    walk = Reference("x", np.array([0.0, 1.0, 1.0, 1.0]), yaw_deg, np.array([0.0, 0.0, np.nan, 1.0]), 2.0)
    assert score_of(walk, yaw_deg) == Score(5.0 / 3.0, 5.0 / 6.0, 17.0 / 3.0, 4.0)


def test_scores_equal_the_sums_of_the_kernel() -> None:
    """Mean squared, mean absolute and largest error of HDR without a bias estimate."""
    walk = reference()
    squares, absolutes, worst, count = sums(
        walk.dt_s, walk.rate_dps, walk.reference_deg, np.array([[0.0, 0.0, 1.0, 0.0, 1.0]])
    )
    score = score_of(walk, np.cumsum(walk.rate_dps * walk.dt_s))
    assert score.pi_deg2 == pytest.approx(squares[0] / count, rel=1e-12)
    assert score.e_deg == pytest.approx(absolutes[0] / count, rel=1e-12)
    assert score.worst_deg == pytest.approx(worst[0], rel=1e-12)


@pytest.mark.parametrize("value", [np.nan, np.inf, 1e200])
def test_a_yaw_that_overflows_has_infinite_errors(value: float) -> None:
    walk = reference()
    assert score_of(walk, np.full(400, value)) == Score(np.inf, np.inf, np.inf, np.inf)


def test_sessions_have_the_same_weight() -> None:
    """The mean is not weighted by duration."""
    assert mean_score([Score(1.0, 2.0, 3.0, 4.0), Score(3.0, 2.0, 1.0, 0.0)]) == Score(2.0, 2.0, 2.0, 2.0)
