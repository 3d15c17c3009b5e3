"""The posterior of a size: how often its interval holds the true size, and its quantiles."""

import numpy as np
import pytest
from inference_support import SESSIONS, row, scorer_of, simulated, with_difference
from scipy.stats import norm

from gyrodrift.diagnose.features.vector import FEATURES
from gyrodrift.diagnose.inference.conclusion import (
    CREDIBLE,
    SizePosterior,
    open_ends,
    probable_range,
    quantiles,
    size_posterior,
    with_form_error,
)
from gyrodrift.diagnose.inference.posterior import POWER
from gyrodrift.diagnose.inference.scorer import CLOSE_TO_IT, USUAL, EffectSet, Placed, Scorer
from gyrodrift.diagnose.inference.sets import fitted
from gyrodrift.values.arrays import Floats

CASES = 240
PER_SIZE = {"rate": 2.0, "lag": 1.0, "moving": 0.7}
SIZES = np.geomspace(1.0, 40.0, 40)


def size_of(scorer: Scorer) -> SizePosterior:
    """Posterior of the size of a scale error."""
    begun = EffectSet((Placed(scorer.templates["scale_factor"], 0),), 0.0, 0.0)
    return size_posterior(scorer, fitted(scorer, begun), "scale_factor", POWER)


def drawn(rng: np.random.Generator, size: float) -> Floats:
    """Differences by a scale error whose form is not exact, half of that in all sessions alike, and by chance."""
    form_error = rng.choice([CLOSE_TO_IT, USUAL])
    common, own = rng.standard_normal((1, len(FEATURES))), rng.standard_normal((SESSIONS, len(FEATURES)))
    form = 1.0 + form_error * np.sqrt(0.5) * (common + own)
    differences: Floats = size * row(PER_SIZE) * form + rng.standard_normal((SESSIONS, len(FEATURES)))
    return differences


def test_an_interval_holds_the_true_size_in_19_of_20_cases() -> None:
    """True sizes are equally probable on a logarithmic scale.

    With independent features, the power of the likelihood makes intervals wider than nominal.
    """
    rng = np.random.default_rng(0)
    scorer = scorer_of({}, simulated("scale_factor", PER_SIZE, SIZES))
    true = np.exp(rng.uniform(np.log(2.0), np.log(30.0), CASES))
    results = [size_of(with_difference(scorer, drawn(rng, float(size)))) for size in true]
    low, median, high = (np.array([getattr(result, end) for result in results]) for end in ("low", "median", "high"))
    assert 0.92 <= np.mean((low <= true) & (true <= high)) <= 0.995
    assert np.mean(true < low) < 0.05
    assert np.mean(true > high) < 0.05
    assert np.median(median / true) == pytest.approx(1.0, abs=0.02)


def test_an_interval_is_narrower_the_more_a_size_changes() -> None:
    widths = []
    for per_size in (0.5, 5.0):
        tried = simulated("scale_factor", {"rate": per_size}, SIZES)
        result = size_of(scorer_of({"rate": 10.0 * per_size}, tried))
        assert result.low < 10.0 < result.high
        assert result.response.candidate.name == "scale_factor"
        widths.append(result.high / result.low)
    assert widths[0] > 1.3 * widths[1] > 1.3


def test_an_interval_that_ends_with_the_tried_sizes_is_open() -> None:
    """The true size lies beyond the largest tried one."""
    tried = simulated("scale_factor", {"rate": 2.0}, np.arange(1.0, 9.0))
    assert size_of(scorer_of({"rate": 17.0}, tried)).is_high_open
    inside = size_of(scorer_of({"rate": 9.0}, tried))
    assert (inside.is_low_open, inside.is_high_open) == (False, False)


@pytest.mark.parametrize(
    ("low", "high", "is_open"), [(1.2, 5.0, (True, False)), (2.0, 7.9, (False, True)), (3.0, 5.0, (False, False))]
)
def test_an_end_within_half_a_step_of_the_last_size_is_open(
    low: float, high: float, is_open: tuple[bool, bool]
) -> None:
    assert open_ends(np.arange(1.0, 9.0), low, high) == is_open
    assert open_ends(np.array([3.0]), 3.0, 3.0) == (False, False)


def test_quantiles_are_those_of_the_weights() -> None:
    """A normal density on a fine grid, in any order, and with each size twice."""
    sizes = np.linspace(0.0, 10.0, 401)
    log_weights = -0.5 * np.square((sizes - 4.0) / 0.8)
    expected = 4.0 + 0.8 * norm.ppf(CREDIBLE)
    assert quantiles(sizes, log_weights, CREDIBLE) == pytest.approx(expected, abs=0.01)
    order = np.random.default_rng(1).permutation(401)
    assert quantiles(sizes[order], log_weights[order], CREDIBLE) == pytest.approx(expected, abs=0.01)
    twice = quantiles(np.tile(sizes, 2), np.tile(log_weights, 2), CREDIBLE)
    assert twice == pytest.approx(expected, abs=0.01)


def test_a_single_size_is_all_quantiles() -> None:
    assert quantiles(np.array([3.0, 3.0]), np.array([-900.0, -901.0]), CREDIBLE) == [3.0, 3.0, 3.0]


@pytest.mark.parametrize(
    ("value", "tried", "ends"),
    [
        (100.0, [(60.0, 0.01), (100.0, 0.98), (160.0, 0.01)], (80.0, 130.0)),
        (100.0, [(60.0, 0.3), (100.0, 0.6), (160.0, 0.1)], (60.0, 160.0)),
        (2, [(1, 0.1), (2, 0.9)], (1.0, 2.0)),
        (2, [(1, 0.01), (2, 0.99)], (2.0, 2.0)),
        (20.0, [(20.0, 1.0)], (20.0, 20.0)),
    ],
)
def test_a_second_parameter_is_known_up_to_halfway_to_the_next_tried_value(
    value: float, tried: list[tuple[float, float]], ends: tuple[float, float]
) -> None:
    """Improbable values do not widen the interval, and a number of poles has nothing in between."""
    assert probable_range(value, tried) == ends


def test_an_interval_of_a_phase_goes_the_shorter_way() -> None:
    assert probable_range(0.0, [(0.0, 0.9), (330.0, 0.08), (30.0, 0.02)], 360.0) == (-30.0, 15.0)


def test_an_interval_includes_half_of_the_form_error() -> None:
    """Half of 5 % of 100 is a standard deviation of 2.5, so 4.9 are added to 3 and 4 in quadrature."""
    assert with_form_error(97.0, 100.0, 104.0, 0.05) == pytest.approx((100.0 - 5.745, 100.0 + 6.326), abs=2e-3)
    assert with_form_error(-104.0, -100.0, -97.0, 0.0) == pytest.approx((-104.0, -97.0))
