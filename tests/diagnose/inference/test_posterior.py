"""The posterior over sets: probabilities, effects that may stand in for each other, and something unknown."""

import numpy as np
import pytest
from inference_support import Amounts, Simulated, scorer_of, simulated

from gyrodrift.diagnose.inference.posterior import POWER, Posterior, posterior_of
from gyrodrift.diagnose.inference.sets import find_sets

SCALE = simulated("scale_factor", {"rate": 2.0, "lag": 1.0})
SAME = simulated("latency", {"rate": 2.0, "lag": 1.0})
DRIFT = simulated("clock_drift", {"clock_ratio": 2.0, "stamp_wander": 1.0})
FORM = simulated("?moving", {"moving": 2.0, "direction": 1.0})


def posterior(difference: Amounts, *tried: Simulated, power: float = POWER) -> Posterior:
    scorer = scorer_of(difference, *tried)
    return posterior_of(scorer, find_sets(scorer), power)


def test_probabilities_of_all_hypotheses_add_up_to_1() -> None:
    result = posterior({"rate": 10.0, "lag": 5.0}, SCALE, DRIFT)
    assert result.weights.sum() == pytest.approx(1.0)
    assert len(result.hypotheses) == sum(2 * (1 + effects) for effects in (0, 1, 1, 2))
    assert 0.0 <= result.no_gap + result.unknown <= 1.0


def test_the_probable_sets_are_the_fewest_with_95_percent() -> None:
    """Each set of effects once with and once without something unknown."""
    sets = posterior({"rate": 10.0, "lag": 5.0}, SCALE, SAME, DRIFT).probable_sets()
    assert {sets[0].effects, sets[1].effects} == {("scale_factor",), ("latency",)}
    assert not sets[0].is_unknown
    assert sum(item.probability for item in sets[:-1]) < 0.95 <= sum(item.probability for item in sets) <= 1.0
    (only,) = posterior({"rate": 0.1}, SCALE).probable_sets()[:1]
    assert (only.effects, only.is_unknown) == ((), False)


def test_two_effects_that_do_the_same_are_tied() -> None:
    result = posterior({"rate": 10.0, "lag": 5.0, "clock_ratio": 10.0, "stamp_wander": 5.0}, SCALE, SAME, DRIFT)
    slots = {frozenset({slot.name, *slot.tied_with}): slot for slot in result.slots()}
    assert set(slots) == {frozenset({"scale_factor", "latency"}), frozenset({"clock_drift"})}
    tied = slots[frozenset({"scale_factor", "latency"})]
    assert tied.probability == pytest.approx(0.5, abs=0.1)
    assert tied.total > 0.8
    assert slots[frozenset({"clock_drift"})].probability == slots[frozenset({"clock_drift"})].total > 0.8


def test_two_effects_that_act_together_are_not_tied() -> None:
    result = posterior({"rate": 10.0, "lag": 5.0, "clock_ratio": 10.0, "stamp_wander": 5.0}, SCALE, DRIFT)
    assert [(slot.tied_with, slot.total > 0.8) for slot in result.slots()] == [((), True), ((), True)]


def test_a_form_that_no_effect_has_is_something_unknown() -> None:
    result = posterior({"moving": 10.0, "direction": 5.0}, FORM, SCALE)
    assert result.inclusion["?moving"] > 0.8
    assert result.unknown > 0.95
    assert result.slots() == []


def test_a_difference_in_other_proportions_is_something_that_resembles_the_effect() -> None:
    shares = [posterior({"rate": 14.0, "lag": lag}, SCALE).inclusion["scale_factor"] for lag in (7.0, 14.0)]
    assert shares[0] > 0.8
    assert shares[1] < 0.2


def test_a_lower_power_is_less_certain() -> None:
    """An effect that is there has a smaller probability."""
    difference = {"rate": 3.0, "lag": 1.5}
    shares = [posterior(difference, SCALE, power=power).inclusion["scale_factor"] for power in (0.4, 1.0)]
    assert shares[0] < shares[1]


def test_sets_are_listed_by_their_probability() -> None:
    result = posterior({"rate": 10.0, "lag": 5.0}, SCALE, DRIFT)
    listed = result.by_mass(0.01)
    assert listed[0].names == ("scale_factor",)
    masses = [
        sum(item.probability for item in result.hypotheses if item.effect_set is effect_set) for effect_set in listed
    ]
    assert masses == sorted(masses, reverse=True)
    assert min(masses) > 0.01
    assert np.count_nonzero(result.has("scale_factor")) == 2 + 4
