"""Scores: those of `tune`, to the definition."""

import numpy as np
import pytest

pytest.importorskip("numba", reason="comparing needs the workstation extra")
from gyrodrift.evaluation.integration import euler
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


def test_a_yaw_by_hand() -> None:
    """Where there is no reference nothing is off; E over the minutes is NE."""
    yaw_deg = np.array([0.0, 1.0, 99.0, -3.0])
    one = Reference("x", np.array([0.0, 1.0, 1.0, 1.0]), yaw_deg, np.array([0.0, 0.0, np.nan, 1.0]), 2.0)
    assert score_of(one, yaw_deg) == Score(5.0 / 3.0, 5.0 / 6.0, 17.0 / 3.0, 4.0)


def test_it_is_what_tuning_goes_by() -> None:
    """Mean squared, mean absolute and largest error as the kernel adds them up, here of plain integration."""
    one = reference()
    squares, absolutes, worst, count = sums(
        one.dt_s, one.rate_dps, one.reference_deg, np.array([[0.0, 0.0, 1.0, 0.0, 1.0]])
    )
    score = score_of(one, euler(one.dt_s, one.rate_dps))
    assert score.pi_deg2 == pytest.approx(squares[0] / count, rel=1e-12)
    assert score.e_deg == pytest.approx(absolutes[0] / count, rel=1e-12)
    assert score.worst_deg == pytest.approx(worst[0], rel=1e-12)


@pytest.mark.parametrize("value", [np.nan, np.inf, 1e200])
def test_a_yaw_that_left_the_floats_is_infinitely_far_off(value: float) -> None:
    """In every measure."""
    one = reference()
    assert score_of(one, np.full(400, value)) == Score(np.inf, np.inf, np.inf, np.inf)


def test_sessions_count_alike() -> None:
    """Whatever they are."""
    assert mean_score([Score(1.0, 2.0, 3.0, 4.0), Score(3.0, 2.0, 1.0, 0.0)]) == Score(2.0, 2.0, 2.0, 2.0)
