"""How small an effect would have been named."""

from dataclasses import replace

import numpy as np
import pytest
from inference_support import (
    SESSIONS,
    SIZES,
    Amounts,
    Simulated,
    candidate,
    concluded,
    row,
    rows,
    simulated,
    simulated_at_random,
    with_difference,
)

from firmware_sim.effects.catalogue import CATALOGUE
from firmware_sim.effects.effect import Effect
from gyrodrift.diagnose.features.vector import FEATURES
from gyrodrift.diagnose.inference.detectable import Detectable, detectable, odds
from gyrodrift.diagnose.inference.explanation import Explanation
from gyrodrift.diagnose.inference.posterior import posterior_of
from gyrodrift.diagnose.inference.sets import find_sets
from gyrodrift.diagnose.simulate.candidate import Candidate
from gyrodrift.values.arrays import Floats

CASES = 200
FINE = np.geomspace(0.5, 20.0, 30)


def explained(*tried: Simulated) -> Explanation:
    """Sessions in which nothing deviates."""
    return concluded({}, *tried).explanation


def of(*tried: Simulated) -> tuple[Detectable, ...]:
    result = explained(*tried)
    return detectable(result.scorer, result.evidence.effects())


def value_of(*tried: Simulated) -> float:
    (result,) = of(*tried)
    assert result.value is not None
    return result.value


def named_share(explanation: Explanation, changes: Floats) -> float:
    """Share of the cases, (cases, S, F) changes by a scale error beside chance, in which it is the likelier."""
    rng = np.random.default_rng(0)
    named = 0
    for change in changes:
        drawn = change + rng.standard_normal(change.shape)
        scorer = with_difference(explanation.scorer, drawn)
        named += posterior_of(scorer, find_sets(scorer)).inclusion["scale_factor"] > 0.5
    return named / len(changes)


@pytest.mark.parametrize(
    "per_size",
    [
        {"rate": 1.0, "reach": 0.7, "lag": 0.5},
        pytest.param({"rate": 1.0}, marks=pytest.mark.evaluation),
        pytest.param(dict.fromkeys(("rate", "lag", "moving"), 0.3), marks=pytest.mark.evaluation),
    ],
)
def test_a_detectable_size_is_named_in_nine_of_ten_tables(per_size: Amounts) -> None:
    tried = simulated("scale_factor", per_size, FINE)
    explanation, value = explained(tried), value_of(tried)
    whole = np.tile(value * rows(per_size), (CASES, 1, 1))
    assert named_share(explanation, whole) > 0.8
    assert named_share(explanation, 0.5 * whole) < 0.4
    assert named_share(explanation, 0.0 * whole) < 0.01  # a false alarm in 200 tables is left to chance


@pytest.mark.parametrize(
    "features", [("rate", "lag", "moving", "temperature"), pytest.param(("rate",), marks=pytest.mark.evaluation)]
)
@pytest.mark.parametrize("is_common", [False, True])
def test_a_detectable_size_of_a_random_effect_is_named_in_most_tables(
    features: tuple[str, ...],
    is_common: bool,  # noqa: FBT001 - parametrized
) -> None:
    def drawn(count: int, seed: int) -> Floats:
        shape = (SESSIONS, count, 1 if is_common else len(FEATURES))
        changes: Floats = row(dict.fromkeys(features, 1.0)) * np.random.default_rng(seed).standard_normal(shape)
        return changes

    tried = simulated_at_random("scale_factor", drawn(64, 1), np.geomspace(0.5, 20.0, 14))
    value = value_of(tried)
    shown = drawn(CASES // 2, 2).transpose(1, 0, 2)
    whole, half = (named_share(explained(tried), factor * value * shown) for factor in (1.0, 0.5))
    assert whole > 0.7
    assert half < whole - 0.1


def test_odds_are_those_that_nine_of_ten_recordings_reach() -> None:
    result = explained(simulated("scale_factor", {"rate": 2.0}))
    template = result.scorer.templates["scale_factor"]
    gain = 0.5 * SESSIONS * np.square(2.0 * SIZES)
    expected = 0.8 * (gain - 1.2816 * np.sqrt(2.0 * gain) - np.log(len(SIZES)) + 1.0) + np.log(0.7 * 0.03 / 0.97)
    assert odds(result.scorer, template) == pytest.approx(expected)
    (item,) = detectable(result.scorer, result.evidence.effects())
    assert (item.effect, item.parameter, item.unit, item.stage) == ("scale_factor", "error_percent", "%", "sensor")
    assert item.value == SIZES[expected > 0.0].min()


def variant(number: int, per_size: float, phase_deg: float | None = None) -> Simulated:
    """One of several variants of a scale error."""
    made = simulated("scale_factor", {"rate": per_size})
    return made._replace(candidate=replace(made.candidate, variant=str(number), phase_deg=phase_deg))


@pytest.mark.parametrize("per_size", [(0.5, 1.0), (1.0, 0.5), (0.01, 1.0)])
def test_of_variants_the_one_that_shows_first_counts(per_size: tuple[float, ...]) -> None:
    assert value_of(*(variant(number, item) for number, item in enumerate(per_size))) == 3.0


def jumps_of(step_deg: float) -> Candidate:
    def make(per_hour: float) -> Effect:
        return CATALOGUE["encoder_slip"].model_validate(
            {"name": "encoder_slip", "per_hour": per_hour, "step_deg": step_deg}
        )

    return replace(candidate("encoder_slip", SIZES), parameter="per_hour", make=make, variant=f"{step_deg}")


def test_what_else_is_fixed_is_said() -> None:
    low, high = (
        simulated("encoder_slip", {"rate": item})._replace(candidate=jumps_of(height))
        for item, height in ((0.5, 0.1), (1.0, 0.4))
    )
    (result,) = of(low, high)
    assert (result.value, result.other_parameters) == (3.0, {"step_deg": 0.4})


def test_an_effect_that_no_size_of_would_be_named_has_no_value() -> None:
    """A form that no effect has is not listed."""
    result = of(simulated("scale_factor", {"rate": 0.01}), simulated("?moving", {"moving": 2.0}))
    assert [(item.effect, item.value) for item in result] == [("scale_factor", None)]


def test_a_size_below_zero_counts_by_its_amount() -> None:
    """A scale that is 4 % too small is as large as one that is too large."""
    below = simulated("scale_factor", {"rate": 1.0}, -SIZES[::-1])
    assert value_of(below) == value_of(simulated("scale_factor", {"rate": 1.0}))
