"""Sizes fitted together, simulated again, and scored on sessions that are held out."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from inference_support import SESSIONS, SIZES, added, candidate, evidence, exactly, response, rows

from gyrodrift.diagnose.features.vector import NUMBER
from gyrodrift.diagnose.inference.evidence import Response
from gyrodrift.diagnose.inference.fit import best_of, cross_validated, fitted, fitted_without, resimulated
from gyrodrift.diagnose.inference.surrogate import Cause, Surrogate
from gyrodrift.diagnose.simulate.response_table import SimulatedSet

RATE, DRIFT = response("scale_factor", {"rate": 2.0}), response("clock_drift", {"clock_ratio": 3.0, "rate": 1.0})


def test_the_best_size_is_the_true_one() -> None:
    """5, of the sizes 1 to 8."""
    surrogate = Surrogate(evidence({"rate": 10.0}, RATE))
    assert fitted(surrogate, (Cause(RATE, 0),))[0].size == 5.0


def test_two_that_move_one_feature_are_fitted_together() -> None:
    """Sizes 2 and 4 are found although either alone would take another."""
    surrogate = Surrogate(evidence({"rate": 8.0, "clock_ratio": 12.0}, RATE, DRIFT))
    assert [cause.size for cause in fitted(surrogate, (Cause(RATE, 0), Cause(DRIFT, 0)))] == [2.0, 4.0]
    assert fitted(surrogate, (Cause(RATE, 0),))[0].size == 4.0


def test_the_variant_is_fitted_with_the_size() -> None:
    """The second form of the effect is the one that is there."""
    other = replace(RATE, mean=2.0 * rows({"abs_rate": 1.0}) * SIZES[:, None, None])
    found = fitted(Surrogate(evidence({"abs_rate": 6.0}, RATE, other)), (Cause(RATE, 0),))
    assert found == (Cause(other, 2),)


def test_without_a_response_there_is_nothing_to_choose() -> None:
    """A mistake of the caller."""
    with pytest.raises(ValueError, match="at least one response"):
        best_of(Surrogate(evidence({})), (), [])


def test_a_held_out_session_does_not_move_the_size() -> None:
    """It may say what it wants; the others say 3."""
    for own in (0.0, 6.0, 16.0):
        difference = rows({"rate": 6.0})
        difference[2] = rows({"rate": own})[0]
        surrogate = Surrogate(evidence(difference, RATE))
        assert fitted_without(surrogate, (Cause(RATE, 0),), 2)[0].size == 3.0


def test_a_score_is_that_of_a_session_under_the_sizes_of_the_others() -> None:
    """Worked out session by session."""
    difference = rows({})
    difference[:, NUMBER["rate"]] = [4.0, 6.0, 6.0, 16.0]
    surrogate = Surrogate(evidence(difference, RATE))
    found = cross_validated(surrogate, (Cause(RATE, 0),), added).found
    for held_out in range(SESSIONS):
        others = [session for session in range(SESSIONS) if session != held_out]
        best = int(np.argmax(surrogate.curve((), RATE)[:, others].sum(axis=1)))
        assert found.scores[held_out] == pytest.approx(surrogate.curve((), RATE)[best, held_out])
    assert found.causes[0].size == 3.0


def test_one_session_is_scored_under_its_own_size() -> None:
    """There is no other."""
    alone = response("scale_factor", {"rate": 2.0}, sessions=1)
    surrogate = Surrogate(evidence(rows({"rate": 6.0}, 1), alone))
    found, after = cross_validated(surrogate, (Cause(alone, 0),), added)
    assert found.causes[0].size == 3.0
    assert found.scores == pytest.approx(after.scores(found.causes))
    assert fitted_without(surrogate, (Cause(alone, 0),), 0)[0].size == 3.0


def half_as_much(causes: Sequence[Cause]) -> SimulatedSet:
    """A simulator of which the tables promise twice what it does."""
    return exactly(0.5 * added(causes).change)


def test_a_set_that_its_tables_get_wrong_is_fitted_again() -> None:
    """Size 3 by the tables does half as much; the offset of that is made up for by 4, and the second run is at 4."""
    seen: list[float] = []

    def simulate(causes: Sequence[Cause]) -> SimulatedSet:
        seen.append(causes[0].size)
        return half_as_much(causes)

    surrogate = Surrogate(evidence({"rate": 6.0}, RATE))
    causes, after = resimulated(surrogate, (Cause(RATE, 2),), simulate)
    assert seen == [3.0, 4.0]  # 6 − 3 are missing at 3: one and a half sizes more, and 4 comes before 5
    assert after.knows(causes)
    assert not surrogate.knows(causes)


def test_a_set_that_is_known_is_simulated_once_more_only() -> None:
    """Its sizes may have moved since."""
    seen: list[int] = []

    def simulate(causes: Sequence[Cause]) -> SimulatedSet:
        seen.append(len(causes))
        return half_as_much(causes)

    surrogate = Surrogate(evidence({"rate": 6.0}, RATE)).refined((Cause(RATE, 0),), half_as_much((Cause(RATE, 0),)))
    assert resimulated(surrogate, (Cause(RATE, 2),), simulate).causes == (Cause(RATE, 2),)
    assert seen == [1]


def test_what_no_effect_does_costs_more() -> None:
    """4 of the log-likelihood; random or not."""
    strange = Response(candidate("?moving"), RATE.mean, RATE.spread)
    surrogate = Surrogate(evidence({"rate": 6.0}, RATE, strange))
    totals = [cross_validated(surrogate, (Cause(one, 2),), added).found.total for one in (RATE, strange)]
    assert totals[0] - totals[1] == pytest.approx(4.0)


def test_a_variant_that_is_nearly_as_good_is_simulated_itself() -> None:
    """The tables have the slower one a little ahead; simulated, it is off by what the quicker one is not."""
    slower, quicker = (replace(RATE, mean=RATE.mean + rows({"time": time})) for time in (0.0, 0.6))
    simulated = []

    def simulate(causes: Sequence[Cause]) -> SimulatedSet:
        simulated.append(causes[0].response)
        wrong = rows({"abs_rate": 1.0}) if causes[0].response is slower else rows({})
        return exactly(added(causes).change + wrong)

    found, surrogate = resimulated(Surrogate(evidence({"rate": 6.0}, slower, quicker)), (Cause(slower, 2),), simulate)
    assert found == (Cause(quicker, 2),)
    assert simulated == [slower, quicker]
    assert surrogate.knows(found)


def test_a_variant_that_is_far_behind_is_not() -> None:
    """By more than a correction moves."""
    slower, far = RATE, replace(RATE, mean=RATE.mean + rows({"time": 9.0}))
    simulated = []

    def simulate(causes: Sequence[Cause]) -> SimulatedSet:
        simulated.append(causes[0].response)
        return added(causes)

    resimulated(Surrogate(evidence({"rate": 6.0}, slower, far)), (Cause(slower, 2),), simulate)
    assert far not in simulated
