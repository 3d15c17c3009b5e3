"""What a cause earns: by explaining, and by excusing."""

import numpy as np
import pytest
from inference_support import SESSIONS, added, evidence, random_response, response

from gyrodrift.diagnose.features.design_matrix import COLUMNS
from gyrodrift.diagnose.inference.earned import Earned, earned_by, unearned
from gyrodrift.diagnose.inference.fit import cross_validated
from gyrodrift.diagnose.inference.search import with_one_more
from gyrodrift.diagnose.inference.surrogate import Cause, Surrogate

OTHERS = {column.name: 10.0 for column in COLUMNS if column.name not in {"rate", "temperature"}}
"""Regressors that something else moves, by ten sigmas each."""


def test_what_fits_explains_and_excuses() -> None:
    """It may be off by a tenth and by 4 % of 10, a variance of 1.16 beside that of chance, which is 1."""
    right = Cause(response("scale_factor", {"rate": 2.0}), 4)
    earned = earned_by(Surrogate(evidence({"rate": 10.0}, right.response)), (right,), right)
    whole, explained = (SESSIONS * 2.5 * np.log1p(100.0 / (4.0 * each)) for each in (1.0, 2.16))
    assert earned.explained == pytest.approx(explained)
    assert earned.excused == pytest.approx(whole - explained)
    assert earned.unearned == 0.0


def test_only_what_is_excused_beyond_what_is_explained_is_not_earned() -> None:
    """What moves features away from where they are explains less than nothing."""
    assert [Earned(*pair).unearned for pair in ((8.0, 5.0), (5.0, 8.0), (-2.0, 3.0))] == [0.0, 3.0, 5.0]


def test_a_spread_is_no_excuse() -> None:
    """It is what a random cause does."""
    walk = random_response("rate_random_walk", {"time": 3.0})
    one = Cause(walk, 3)
    assert earned_by(Surrogate(evidence({"time": 12.0}, walk)), (one,), one) == Earned(0.0, 0.0)


def test_a_wrong_cause_that_is_far_too_large_hides_no_true_one() -> None:
    """By the likelihood alone it gains the most: 4 % of 60 excuse all that others did."""
    large, small = (
        response("temp_bias", {"rate": 60.0}, np.ones(1)),
        response("scale_factor", {"rate": 40.0}, np.ones(1)),
    )
    wrong, right = (Cause(one, 0) for one in (large, small))
    surrogate = Surrogate(evidence({"rate": 40.0, "temperature": 40.0, **OTHERS}, large, small))
    assert unearned(surrogate, (wrong,), (wrong,)) > 100.0
    assert surrogate.scores((wrong,)).sum() > surrogate.scores((right,)).sum()
    assert with_one_more(surrogate, (), added).found[0].names == ("scale_factor",)
    found, _ = cross_validated(surrogate, (wrong,), added)
    assert found.total == pytest.approx(found.scores.sum() - found.unearned)
