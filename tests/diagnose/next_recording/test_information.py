"""Information of features in cases that are worked out by hand."""

import numpy as np
import pytest

from gyrodrift.diagnose.features.vector import FEATURES, NUMBER
from gyrodrift.diagnose.next_recording.information import (
    discrimination_of,
    entropy,
    feature_model,
    held_out_log_likelihoods,
    information_bound,
    posteriors,
)
from gyrodrift.diagnose.next_recording.simulated_features import SimulatedFeatures
from gyrodrift.values.arrays import Floats

EVEN = np.array([0.5, 0.5])


def simulated(*changes: dict[str, float], noise: float = 0.1, realisations: int = 6) -> SimulatedFeatures:
    """Hypotheses that change features by so much, in units of their relevance thresholds, with common noise."""
    count = len(FEATURES)
    common = noise * np.random.default_rng(5).standard_normal((realisations, count))
    values = np.repeat(common[None], len(changes), axis=0)
    for number, change in enumerate(changes):
        for name, amount in change.items():
            values[number, :, NUMBER[name]] += amount
    return SimulatedFeatures(values, np.ones(count), common[0])


def report(*changes: dict[str, float], weights: Floats = EVEN) -> float:
    return discrimination_of(held_out_log_likelihoods(simulated(*changes)), weights).probability


def test_posteriors_are_those_of_bayes() -> None:
    """Likelihoods of 3 and 1 on odds of 1 to 4 are odds of 3 to 4; at a learning rate of 0 nothing is learned."""
    logs, weights = np.log([3.0, 1.0]), np.array([0.2, 0.8])
    assert posteriors(logs, weights, 1.0) == pytest.approx([3.0 / 7.0, 4.0 / 7.0])
    assert posteriors(logs, weights, 0.0) == pytest.approx(weights)


def test_information_is_bounded_by_divergences() -> None:
    """Two even hypotheses of divergence d tell 1 − log2(1 + exp(−d/4)) bits; all of them where d is large."""
    for divergence in (0.0, 2.0, 400.0):
        logs = -divergence * (1.0 - np.eye(2))[None]
        assert information_bound(logs, EVEN) == pytest.approx(1.0 - np.log2(1.0 + np.exp(-0.25 * divergence)))


def test_entropy_is_what_can_be_told() -> None:
    assert entropy(EVEN) == 1.0
    assert entropy(np.array([0.25, 0.25, 0.5])) == 1.5
    assert entropy(np.array([0.9, 0.1])) == pytest.approx(0.469, abs=1e-3)


def test_what_changes_the_same_is_not_told_apart() -> None:
    same = {"rate": 20.0}
    assert report(same, same) == pytest.approx(0.5)
    assert report(same, same, weights=np.array([0.7, 0.3])) == pytest.approx(0.58)


def test_different_features_tell_apart() -> None:
    names = ("rate", "abs_rate", "temperature", "noise_rest_32")
    first, second = (dict.fromkeys(names[index::2], 20.0) for index in range(2))
    assert report(first, second) > 0.99


def test_a_little_more_of_the_same_is_no_other_cause() -> None:
    """Sizes are fitted, and may be off by a fifth; by twice they are not."""
    item = {"rate": 10.0, "abs_rate": 10.0, "temperature": 10.0, "rate_cubed": 10.0}
    assert report(item, {name: 1.19 * change for name, change in item.items()}) < 0.65
    assert report(item, {name: 3.0 * change for name, change in item.items()}) > 0.95


def test_fewer_than_the_threshold_matter_little() -> None:
    """A change of a fifth of what matters is told by nothing, however little it scatters."""
    assert report({}, {"rate": 0.2}) < 0.55


def test_new_features_are_judged_by_the_model() -> None:
    features = simulated({}, {"rate": 15.0, "temperature": -15.0})
    model = feature_model(features, features.values.mean(axis=1))
    logs = model.log_likelihoods(model.means[2])
    assert logs.shape == (2, 2)
    assert (logs.argmax(axis=1) == [0, 1]).all()
