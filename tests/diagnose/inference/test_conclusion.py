"""The posterior on tables made by hand: nothing, one effect, two, and what no effect does."""

from functools import cache

import numpy as np
import pytest
from inference_support import SESSIONS, rows, simulated
from inference_support import concluded as concluded_of

from gyrodrift.diagnose.features.vector import FEATURES
from gyrodrift.diagnose.inference.conclusion import Conclusion
from gyrodrift.diagnose.inference.verdict import Kind

SCALE = {"rate": 1.0, "direction": 0.3}
CLOCK = {"clock_ratio": 1.0, "stamp_wander": 0.3}
TRIED = (simulated("scale_factor", SCALE), simulated("clock_drift", CLOCK))


@cache
def concluded(**amounts: float) -> Conclusion:
    """Of sessions that differ from the rig by some amounts, and by half a standard deviation of chance."""
    chance = 0.5 * np.random.default_rng(1).standard_normal((SESSIONS, len(FEATURES)))
    return concluded_of(rows(amounts) + chance, *TRIED)


def times(size: float, per_size: dict[str, float]) -> dict[str, float]:
    return {name: size * value for name, value in per_size.items()}


def test_chance_alone_is_no_gap() -> None:
    conclusion = concluded()
    assert conclusion.verdict.kind is Kind.NONE
    assert conclusion.explanation.posterior.no_gap > 0.8


def test_an_effect_is_named_with_its_size() -> None:
    """The true size of 6 lies within the interval, and the interval is no wider than the form error and chance."""
    conclusion = concluded(**times(6.0, SCALE))
    (cause,) = conclusion.verdict.causes
    assert (conclusion.verdict.kind, cause.effect.name) == (Kind.EFFECT, "scale_factor")
    assert cause.probability > 0.8
    assert cause.parameters[0].low < 6.0 < cause.parameters[0].high
    assert cause.parameters[0].value == pytest.approx(6.0, rel=0.15)


def test_two_effects_are_named_together() -> None:
    conclusion = concluded(**times(6.0, SCALE), **times(5.0, CLOCK))
    assert {cause.effect.name for cause in conclusion.verdict.causes} == {"scale_factor", "clock_drift"}


def test_a_gap_that_no_effect_makes_is_unknown() -> None:
    """Large deviations in other features than those of the effects, and no effect is named for them."""
    conclusion = concluded(temperature=12.0, wander_20s=-9.0)
    assert (conclusion.verdict.kind, conclusion.verdict.causes) == (Kind.UNKNOWN, ())
    assert conclusion.explanation.posterior.unknown > 0.9


def test_probabilities_of_all_hypotheses_add_up_to_1() -> None:
    posterior = concluded(**times(6.0, SCALE)).explanation.posterior
    assert posterior.weights.sum() == pytest.approx(1.0)
    assert posterior.no_gap + posterior.unknown < 1.0
