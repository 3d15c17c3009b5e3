"""Stated probabilities: between 0 and 1, and lower the more speaks against a cause."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gyrodrift.diagnose.inference.probability import LogisticFeatures, probability_of

SHARES = st.floats(0.0, 1.0)
RIVALS = st.floats(0.0, 1e6)


@given(RIVALS, SHARES, st.booleans())
def test_it_is_a_probability(rivals: float, unexplained: float, is_random: bool) -> None:  # noqa: FBT001 - drawn
    """Never certain."""
    assert 0.0 < probability_of(LogisticFeatures(rivals, unexplained, is_random)) < 1.0


@given(st.lists(RIVALS, min_size=2), SHARES, st.booleans())
def test_more_rivals_never_raise_it(rivals: list[float], unexplained: float, is_random: bool) -> None:  # noqa: FBT001 - drawn
    """Whatever else there is."""
    found = [probability_of(LogisticFeatures(one, unexplained, is_random)) for one in sorted(rivals)]
    assert all(first >= second for first, second in pairwise(found))


@given(RIVALS, st.lists(SHARES, min_size=2))
def test_more_unexplained_never_raises_it(rivals: float, shares: list[float]) -> None:
    """Nor does randomness."""
    found = [probability_of(LogisticFeatures(rivals, one, is_random=False)) for one in sorted(shares)]
    assert all(first >= second for first, second in pairwise(found))
    assert probability_of(LogisticFeatures(rivals, shares[0], is_random=True)) <= probability_of(
        LogisticFeatures(rivals, shares[0], is_random=False)
    )


@given(RIVALS, st.lists(SHARES, min_size=2))
def test_more_unknown_beside_it_never_raises_it(rivals: float, shares: list[float]) -> None:
    """Nor lowers it where nothing is left."""
    found = [
        probability_of(LogisticFeatures(rivals, 0.1, is_random=False, beside_unknown=one)) for one in sorted(shares)
    ]
    assert all(first >= second for first, second in pairwise(found))
    assert found[0] <= probability_of(LogisticFeatures(rivals, 0.1, is_random=False))


@pytest.mark.parametrize(
    ("one", "logit"),
    [
        (LogisticFeatures(0.0, 0.0, is_random=False), 2.8),
        (LogisticFeatures(1.0, 0.0, is_random=False), 2.8 - 4.0 * 0.693147),
        (LogisticFeatures(0.0, 0.2, is_random=False), 1.6),
        (LogisticFeatures(0.0, 0.2, is_random=True), -0.2),
        (LogisticFeatures(0.0, 0.0, is_random=False, beside_unknown=0.3), 1.3),
    ],
)
def test_it_is_a_logistic_curve(one: LogisticFeatures, logit: float) -> None:
    """Of 2.8, less 4 for the logarithm of rivals, 6 for all that is left, 1.8 for what is random, 5 for the unknown."""
    assert probability_of(one) == pytest.approx(1.0 / (1.0 + np.exp(-logit)), rel=1e-5)
