"""A tilt that a single axis cannot tell from a scale error: the two share a posterior, and no motion is proposed."""

import pytest
from inference_support import Amounts, simulated, simulator, tables
from signed_support import simulated_either_way

from gyrodrift.diagnose.inference.conclusion import ODDS, Conclusion, conclude, with_unseparated

TRIED = (
    simulated_either_way("scale_factor", {"rate": 2.0, "lag": 1.0}),
    simulated("clock_drift", {"clock_ratio": 2.0, "stamp_wander": 1.0}),
)
LOW: Amounts = {"rate": -10.0, "lag": -5.0}
HIGH: Amounts = {"rate": 10.0, "lag": 5.0}
DRIFT: Amounts = {"clock_ratio": 10.0, "stamp_wander": 5.0}


def concluded(difference: Amounts, *unseparated: str) -> Conclusion:
    return conclude(tables(difference, *TRIED), [item.candidate for item in TRIED], simulator(*TRIED), unseparated)


def test_a_rate_that_is_too_low_may_be_a_tilt() -> None:
    """The tie lists it; the scale error is first by its prior, keeps its size and goes into the rig."""
    (cause,) = concluded(LOW, "misalignment").verdict.causes
    assert (cause.effect.name, cause.tied_with) == ("scale_factor", ("misalignment",))
    assert cause.parameters[0].value == pytest.approx(-5.0, abs=0.3)
    assert cause.is_adopted
    (alone,) = concluded(LOW).verdict.causes
    assert cause.parameters == alone.parameters
    assert cause.group_probability == pytest.approx(alone.probability)
    assert cause.probability == pytest.approx(alone.probability / (1.0 + ODDS))


def test_a_rate_that_is_too_high_is_no_tilt() -> None:
    """A cosine takes from the rate only: not a bit of the posterior changes."""
    with_tilt, without = concluded(HIGH, "misalignment"), concluded(HIGH)
    assert with_tilt.verdict == without.verdict
    assert with_tilt.verdict.causes[0].tied_with == ()


def test_another_cause_has_no_tie_with_a_tilt() -> None:
    causes = concluded({**LOW, **DRIFT}, "misalignment").verdict.causes
    assert {cause.effect.name: cause.tied_with for cause in causes} == {
        "scale_factor": ("misalignment",),
        "clock_drift": (),
    }


def test_the_probability_is_divided_and_none_is_lost() -> None:
    posterior = concluded(LOW).explanation.posterior
    divided = with_unseparated(posterior, ["misalignment"])
    assert divided.weights.sum() == pytest.approx(1.0)
    assert divided.unknown == pytest.approx(posterior.unknown)
    assert divided.no_gap == posterior.no_gap
    assert with_unseparated(posterior, []) is posterior


def test_a_tilt_that_was_not_simulated_has_no_place_in_a_set() -> None:
    explanation = concluded(LOW, "misalignment").explanation
    assert explanation.posterior.inclusion["misalignment"] > 0.1
    assert explanation.where_best("misalignment") is None
    assert explanation.where_best("scale_factor") is not None
