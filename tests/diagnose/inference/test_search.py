"""The search over sets of causes, on toys whose truth is known: one cause, masked pairs, idle causes, and none."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from inference_support import SESSIONS, added, candidate, evidence, exactly, random_response, response, rows

from gyrodrift.diagnose.features.vector import NUMBER
from gyrodrift.diagnose.inference.acceptance import GAIN, passes_acceptance
from gyrodrift.diagnose.inference.earned import earned_by
from gyrodrift.diagnose.inference.evidence import Response
from gyrodrift.diagnose.inference.fit import CauseSet, cross_validated
from gyrodrift.diagnose.inference.search import CLOSE, exchanged, search, with_one_more, without_idle
from gyrodrift.diagnose.inference.surrogate import Cause, Surrogate
from gyrodrift.diagnose.simulate.response_table import SimulatedSet

RATE = response("scale_factor", {"rate": 2.0})
DRIFT = response("clock_drift", {"clock_ratio": 3.0})
TREND = ("time", "time_squared", "decay_fast")


def test_of_two_candidates_the_true_one_is_found_at_its_size() -> None:
    """And nothing beside it."""
    found = search(evidence({"rate": 10.0}, RATE, DRIFT), added).found
    assert found.names == ("scale_factor",)
    assert found.causes[0].size == 5.0


def test_the_gain_is_that_of_the_density() -> None:
    """Of four sessions each half of five times the logarithm of 1 + z²/4, where nothing is left."""
    result = search(evidence({"rate": 10.0}, RATE, DRIFT), added)
    assert result.found.total - result.nothing.total == pytest.approx(SESSIONS * 2.5 * np.log1p(10.0**2 / 4.0))


def test_where_nothing_deviates_nothing_is_found() -> None:
    """Nor where what does is too little for a cause."""
    for amount in (0.0, 1.0):
        result = search(evidence({"rate": amount}, RATE, DRIFT), added)
        assert result.found is result.nothing


def test_without_candidates_nothing_is_found() -> None:
    """However much deviates."""
    assert search(evidence({"rate": 50.0}), added).found.causes == ()


def test_a_second_cause_is_added() -> None:
    """Each at its own size."""
    found = search(evidence({"rate": 6.0, "clock_ratio": 12.0}, RATE, DRIFT), added).found
    assert {cause.name: cause.size for cause in found.causes} == {"scale_factor": 3.0, "clock_drift": 4.0}


def test_two_that_mask_each_other_are_found() -> None:
    """In the feature that both move they cancel, so that either alone makes it worse and a decoy gains more."""
    sizes = np.arange(1.0, 9.0, 0.5)
    up = response("scale_factor", {"rate": 8.0, "abs_rate": 2.5}, sizes)
    down = response("clock_drift", {"rate": -8.0, "clock_ratio": 2.5}, sizes)
    decoy = response("temp_bias", {"abs_rate": 2.5, "temperature": 1.0}, sizes)
    surrogate_evidence = evidence({"abs_rate": 12.5, "clock_ratio": 12.5}, up, down, decoy)
    first, _ = with_one_more(Surrogate(surrogate_evidence), (), added)
    assert first[0].names == ("temp_bias",)
    found = search(surrogate_evidence, added).found
    assert set(found.names) == {"scale_factor", "clock_drift"}
    assert [cause.size for cause in found.causes] == [5.0, 5.0]


def test_a_cause_that_is_idle_beside_the_others_is_dropped() -> None:
    """Backward elimination leaves the one that explains."""
    surrogate = Surrogate(evidence({"rate": 10.0}, RATE, DRIFT))
    both, surrogate = cross_validated(surrogate, (Cause(RATE, 4), Cause(DRIFT, 0)), added)
    found, _ = without_idle(surrogate, both, added)
    assert found.names == ("scale_factor",)


def test_a_shorter_set_is_scored_at_the_sizes_of_the_longer_too() -> None:
    """Alone it was known at another size only, where it does what it does nowhere else, and there the fit stays."""

    def simulated(causes: Sequence[Cause]) -> SimulatedSet:
        (one,) = causes
        odd = {"rate": 10.0, "abs_rate": 5.0} if one.size == 2.0 else {"rate": 2.0 * one.size}
        return exactly(rows(odd if one.name == "scale_factor" else {"clock_ratio": 3.0 * one.size}))

    right, idle = Cause(RATE, 4), Cause(DRIFT, 0)
    surrogate = Surrogate(evidence({"rate": 10.0, "clock_ratio": 1.5}, RATE, DRIFT))
    both = CauseSet((right, idle), surrogate.scores((right, idle)))
    surrogate = surrogate.refined((Cause(RATE, 1),), simulated((Cause(RATE, 1),)))
    alone, surrogate = cross_validated(surrogate, (right,), simulated)
    assert alone.causes[0].size == 2.0
    found, _ = without_idle(surrogate, both, simulated)
    assert [(cause.name, cause.size) for cause in found.causes] == [("scale_factor", 5.0)]


def test_no_cause_that_explains_is_dropped() -> None:
    """Both are needed."""
    surrogate = Surrogate(evidence({"rate": 10.0, "clock_ratio": 9.0}, RATE, DRIFT))
    both, surrogate = cross_validated(surrogate, (Cause(RATE, 4), Cause(DRIFT, 2)), added)
    assert without_idle(surrogate, both, added)[0] is both


def test_a_wrong_cause_is_exchanged_for_the_right_one() -> None:
    """Beside one that stays."""
    wrong = response("temp_bias", {"rate": 1.0, "temperature": 1.0})
    surrogate = Surrogate(evidence({"rate": 10.0, "clock_ratio": 9.0}, RATE, DRIFT, wrong))
    found, surrogate = cross_validated(surrogate, (Cause(wrong, 4), Cause(DRIFT, 2)), added)
    better, _ = exchanged(surrogate, found, added)
    assert set(better.names) == {"scale_factor", "clock_drift"}
    assert better.total > found.total


def test_what_no_effect_does_is_found_where_it_explains_best() -> None:
    """An effect that does half of it does not take its place; one that does all of it does."""
    strange = Response(candidate("?moving"), response("scale_factor", {"moving": 2.0}).mean, RATE.spread)
    half = response("temp_bias", {"moving": 1.0, "temperature": 1.0})
    whole = response("temp_bias", {"moving": 2.0})
    assert search(evidence({"moving": 10.0}, strange, half), added).found.names == ("?moving",)
    assert search(evidence({"moving": 10.0}, strange, whole), added).found.names == ("temp_bias",)


@pytest.mark.parametrize(("swing", "names"), [(0.3, ("temp_bias",)), (4.0, ("?swing",))])
def test_chance_that_no_effect_is_has_to_stand_out_in_what_it_stands_for(swing: float, names: tuple[str, ...]) -> None:
    """However much else it explains; an effect that explains less is taken where it does not."""
    shown = {"walk_20s": 2.0, "wander_20s": 2.0}
    strange = Response(
        candidate("?swing", realisations=4), response("scale_factor", {**shown, "swing": 0.8}).mean, 0.0 * RATE.spread
    )
    less = response("temp_bias", {"walk_20s": 2.0, "wander_20s": 1.0})
    found = search(evidence({"walk_20s": 10.0, "wander_20s": 10.0, "swing": swing}, strange, less), added).found
    assert found.names == names


def test_a_cause_that_only_makes_everything_uncertain_is_not_accepted() -> None:
    """What a wide spread gains is no gain by where the features are."""
    walk = random_response("rate_random_walk", {"time": 3.0})
    difference = rows({})
    difference[:, NUMBER["time"]] = [20.0, -20.0, 20.0, -20.0]
    surrogate = Surrogate(evidence(difference, walk))
    found, surrogate = cross_validated(surrogate, (Cause(walk, 6),), added)
    nothing = CauseSet((), surrogate.scores(()))
    assert found.total - nothing.total > GAIN
    assert earned_by(surrogate, found.causes, found.causes[0]).explained == 0.0
    assert not passes_acceptance(surrogate, found, nothing)


def test_one_that_only_makes_everything_uncertain_hides_no_other() -> None:
    """It gains the most by far, and is not accepted; what explains a part is found all the same."""
    walk = random_response("rate_random_walk", dict.fromkeys(TREND, 3.0))
    difference = rows({"clock_ratio": 9.0})
    for name in TREND:
        difference[:, NUMBER[name]] = [20.0, -20.0, 20.0, -20.0]
    surrogate = Surrogate(evidence(difference, walk, DRIFT))
    uncertain, shifted = (surrogate.scores((cause,)).sum() for cause in (Cause(walk, 6), Cause(DRIFT, 2)))
    assert uncertain > shifted + CLOSE
    assert search(surrogate.evidence, added).found.names == ("clock_drift",)


def test_a_gain_has_to_be_larger_than_its_standard_error() -> None:
    """Three sessions that gain nothing do not confirm what one gains."""
    cause = Cause(RATE, 4)
    surrogate = Surrogate(evidence({"rate": 10.0}, RATE))
    nothing = CauseSet((), np.zeros(SESSIONS))
    assert passes_acceptance(surrogate, CauseSet((cause,), np.full(SESSIONS, 2.5)), nothing)
    assert not passes_acceptance(surrogate, CauseSet((cause,), np.array([10.0, 0.0, 0.0, 0.0])), nothing)


def test_one_session_is_enough_for_a_search() -> None:
    """Under its own sizes, without a standard error."""
    alone = response("scale_factor", {"rate": 4.0}, sessions=1)
    found = search(evidence(rows({"rate": 20.0}, 1), alone), added).found
    assert found.causes[0].size == 5.0


def test_a_search_ends_the_same_whatever_was_searched_before() -> None:
    """To the bit: nothing is kept between searches."""
    one = evidence({"rate": 6.0, "clock_ratio": 12.0}, RATE, DRIFT)
    first = search(one, added)
    search(evidence({"rate": 2.0, "clock_ratio": 3.0}, RATE, DRIFT), added)
    again = search(one, added)
    assert again.found.causes == first.found.causes
    assert np.array_equal(again.found.scores, first.found.scores)


def test_two_that_stand_against_each_other_are_never_held_together() -> None:
    """A rate that leads, and one that lags by less: one motion of one clock."""
    late = response("latency", {"acceleration": 2.0, "lag": 2.0})
    lead = response("?acceleration", {"acceleration": -2.0, "lag": -1.0})
    against = replace(lead.candidate, group=late.candidate.group)
    lead = Response(against, lead.mean, lead.spread)
    found = search(evidence({"acceleration": -12.0, "lag": -4.0}, late, lead), added).found
    assert found.names == ("?acceleration",)
