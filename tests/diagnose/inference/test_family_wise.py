"""The threshold that chance passes seldom: against normal numbers of which nobody knows the center and the spread."""

import numpy as np
import pytest
from support import quick

from gyrodrift.diagnose.inference.evidence import FAMILY_WISE_ERROR, LEAST, family_wise_threshold, pooled_z
from gyrodrift.values.arrays import Floats

FEATURES = 60
STUDIES, SETS_OF_A_STUDY = 80, 25


def standardized(nulls: Floats) -> tuple[Floats, Floats, Floats]:
    """Nulls by their own center and spread, as evidence has them, and both."""
    pooled = nulls.reshape(-1, nulls.shape[-1])
    center, spread = pooled.mean(axis=0), pooled.std(axis=0, ddof=1)
    return (nulls - center) / spread, center, spread


@pytest.mark.parametrize(("sessions", "runs"), quick([(1, 10), (2, 10), (4, 6), (12, 4)], (1, 10), (4, 6)))
def test_chance_makes_one_of_all_features_deviate_as_seldom_as_it_says(sessions: int, runs: int) -> None:
    dice, passed = np.random.default_rng(sessions), 0
    for _ in range(STUDIES):
        nulls, center, spread = standardized(dice.standard_normal((sessions, runs, FEATURES)))
        threshold = family_wise_threshold(nulls)
        sets = (dice.standard_normal((SETS_OF_A_STUDY, sessions, FEATURES)) - center) / spread
        passed += sum(bool(np.abs(pooled_z(item)).max() > threshold) for item in sets)
    count = STUDIES * SETS_OF_A_STUDY
    standard_error = np.sqrt(FAMILY_WISE_ERROR * (1.0 - FAMILY_WISE_ERROR) / count)
    # Sets of one study share its null runs: their number counts for half of what it is.
    assert passed / count == pytest.approx(FAMILY_WISE_ERROR, abs=3.0 * np.sqrt(2.0) * standard_error)


def test_heavy_tails_raise_it_where_there_are_runs_enough_to_show_them() -> None:
    """Sixty nulls with two degrees of freedom, by a tenth and more."""
    dice = np.random.default_rng(2)
    normal = family_wise_threshold(standardized(dice.standard_normal((6, 10, FEATURES)))[0])
    heavy = family_wise_threshold(standardized(dice.standard_t(2.0, (6, 10, FEATURES)))[0])
    assert heavy > 1.1 * normal


def test_more_runs_and_fewer_features_lower_it() -> None:
    """Few runs know little of the tails; more features have more chances. What is not exact in the null stays."""
    dice = np.random.default_rng(3)
    few, many, narrow = (
        family_wise_threshold(standardized(dice.standard_normal(shape))[0])
        for shape in ((4, 3, 600), (4, 12, 600), (4, 12, FEATURES))
    )
    assert few > many > narrow == LEAST


def test_features_that_never_move_are_no_features() -> None:
    nulls, *_ = standardized(np.random.default_rng(4).standard_normal((4, 6, 10)))
    wide = np.concatenate([nulls, np.zeros((4, 6, 100))], axis=2)
    assert family_wise_threshold(wide) == pytest.approx(family_wise_threshold(nulls))


@pytest.mark.parametrize("shape", [(1, 1, 5), (3, 4, 5)])
def test_without_a_null_nothing_deviates(shape: tuple[int, int, int]) -> None:
    assert family_wise_threshold(np.zeros(shape)) == np.inf
