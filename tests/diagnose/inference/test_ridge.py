"""Two effects that change one feature against each other are found together, with sizes as wide as their ridge."""

import numpy as np
import pytest
from inference_support import Amounts, Simulated, concluded, scorer_of, simulated
from signed_support import simulated_either_way

from gyrodrift.diagnose.inference.conclusion import SizePosterior, size_posterior
from gyrodrift.diagnose.inference.posterior import POWER
from gyrodrift.diagnose.inference.ridge import pair_in, placed_together
from gyrodrift.diagnose.inference.scorer import EffectSet, Placed, Scorer
from gyrodrift.diagnose.inference.sets import fitted

SCALE = simulated_either_way("scale_factor", {"rate": 40.0})
TILT_SIZES = np.arange(0.5, 8.01, 0.5)
TILT = simulated("misalignment", {"rate": -40.0, "turn_across": 3.0, "gravity_across": 1.0}, TILT_SIZES)
TILT_AND_SCALE: Amounts = {"rate": 40.0 * (3.0 - 5.0), "turn_across": 15.0, "gravity_across": 5.0}
"""A scale error of 3 beside a tilt of 5: the rate is too low, by 2."""


def at_the_ends(scorer: Scorer) -> list[Placed]:
    """Both effects as far from their sizes as their grids go."""
    scale, tilt = scorer.templates["scale_factor"], scorer.templates["misalignment"]
    return [Placed(scale, 0), Placed(tilt, len(tilt.size) - 1)]


def test_a_tilt_and_what_acts_like_it_are_a_pair() -> None:
    assert pair_in(["latency", "scale_factor", "misalignment"]) == ("misalignment", "scale_factor")
    assert pair_in(["misalignment", "latency"]) is None
    assert pair_in(["?moving", "scale_factor"]) is None


def test_a_pair_is_placed_where_both_fit() -> None:
    scorer = scorer_of(TILT_AND_SCALE, SCALE, TILT)
    scale, tilt = placed_together(scorer, at_the_ends(scorer))
    assert (scale.size, tilt.size) == pytest.approx((3.0, 5.0), abs=0.15)


def test_other_sets_stay_as_they_are() -> None:
    """A single effect of the pair, too."""
    scorer = scorer_of(TILT_AND_SCALE, SCALE, TILT)
    alone = at_the_ends(scorer)[:1]
    assert placed_together(scorer, alone) == alone


def test_both_are_named_with_their_sizes() -> None:
    """The rate alone shows their sum, and x and y of the gyro the tilt."""
    verdict = concluded(TILT_AND_SCALE, SCALE, TILT).verdict
    sizes = {cause.effect.name: cause.parameters[0].value for cause in verdict.causes}
    assert sizes == pytest.approx({"scale_factor": 3.0, "misalignment": 5.0}, abs=0.3)
    assert [cause.tied_with for cause in verdict.causes] == [(), ()]


@pytest.mark.parametrize(
    ("difference", "names"),
    [
        ({"rate": -80.0}, {"scale_factor"}),
        ({"rate": -80.0, "turn_across": 6.0, "gravity_across": 2.0}, {"misalignment"}),
    ],
)
def test_a_single_effect_is_told_from_the_other(difference: Amounts, names: set[str]) -> None:
    """The axes x and y decide."""
    causes = concluded(difference, SCALE, TILT).verdict.causes
    assert {cause.effect.name for cause in causes} == names
    assert [cause.tied_with for cause in causes] == [()]


def size_of(name: str, *tried: Simulated) -> SizePosterior:
    scorer = scorer_of(TILT_AND_SCALE, *tried)
    return size_posterior(scorer, fitted(scorer, EffectSet(tuple(at_the_ends(scorer)), 0.0, 0.0)), name, POWER)


def test_an_interval_is_as_wide_as_the_ridge() -> None:
    """The tilt is known by x and y: to 1/sqrt(3² + 1²) of a unit in four sessions, not to 1/40 by the rate."""
    tilt = size_of("misalignment", SCALE, TILT)
    assert tilt.low < 5.0 < tilt.high
    assert 0.3 < tilt.high - tilt.low < 1.2
