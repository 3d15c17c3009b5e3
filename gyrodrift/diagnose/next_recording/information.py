"""What a motion tells: the information between hypothesis and features, and the probability of the right answer.

Each realisation is judged by what the others show (leave one out), so that what a few realisations have in common by
chance is no knowledge. Features are not independent, as the likelihood takes them to be; the power to which it is
raised (the learning rate of a generalised Bayesian posterior, Grünwald and van Ommen 2017) is fitted to the same
realisations, so that what is stated is what comes true.

To compare motions that were simulated a few times only, the information is bounded by divergences between pairs of
hypotheses (Kolchinsky and Tracey, Estimating mixture entropy with pairwise distances, 2017): their means over
realisations that share random numbers scatter far less than posteriors do.
"""

from dataclasses import dataclass, field

import numpy as np
from scipy.special import logsumexp

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.inference.density import DEGREES_OF_FREEDOM
from gyrodrift.diagnose.inference.log_variances import scaled
from gyrodrift.diagnose.inference.scorer import USUAL
from gyrodrift.diagnose.next_recording.simulated_features import SimulatedFeatures

LEARNING_RATES = np.concatenate([[0.0], np.geomspace(0.01, 1.0, 17)])

SIZES = np.array([0.7, 0.84, 1.0, 1.19, 1.43])
"""A fitted size may be off by so much: a difference that a little more of a cause makes does not tell it from another.
"""

PRIOR_REALISATIONS = 4.0
"""The spread that all hypotheses share counts as so many realisations of each."""


@dataclass(frozen=True, slots=True)
class Told:
    """What features tell of the hypotheses.

    information
        Expected gain of knowledge on which hypothesis holds, bits.
    probability
        That the posterior gives to the hypothesis that holds, expected over all of them.
    learning_rate
        The power to which the likelihood is raised.
    """

    information: float
    probability: float
    learning_rate: float


@dataclass(frozen=True, slots=True, eq=False)
class FeatureModel:
    """What each hypothesis predicts.

    base
        (F,) features of the rig that all hypotheses share.
    means
        (SIZES, H, F) features under each hypothesis, with its cause at each of SIZES times the fitted size.
    variances
        (H, F) of one realisation, relevance thresholds included.
    """

    base: Floats = field(repr=False)
    means: Floats = field(repr=False)
    variances: Floats = field(repr=False)

    def log_likelihoods(self, values: Floats) -> Floats:
        """(n, H) of features, (n, F), under each hypothesis, averaged over its sizes."""
        there = values[:, None, None]
        changes = np.broadcast_to(self.means - self.base, (len(values), *self.means.shape))
        at_sizes = log_likelihood(there - self.means, self.variances + np.square(USUAL * changes))
        averaged: Floats = logsumexp(at_sizes, axis=1) - np.log(len(SIZES))
        return averaged


def log_likelihood(residual: Floats, variance: Floats) -> Floats:
    """(…,) sum over the last axis of the logarithm of a Student density."""
    nu = DEGREES_OF_FREEDOM
    each = -0.5 * (nu + 1.0) * np.log1p(np.square(residual) / (nu * variance)) - 0.5 * np.log(variance)
    total: Floats = each.sum(axis=-1)
    return total


def feature_model_of(simulated: SimulatedFeatures) -> FeatureModel:
    """From all realisations."""
    return _model(simulated, simulated.values.mean(axis=1))


def held_out_log_likelihoods(simulated: SimulatedFeatures) -> Floats:
    """(R, H, H) of each realisation of the hypothesis that holds, under each hypothesis as the others show it."""
    values = simulated.values
    totals, others = values.sum(axis=1), values.shape[1] - 1
    held_out = [_model(simulated, (totals - one) / others).log_likelihoods(one) for one in values.swapaxes(0, 1)]
    return np.array(held_out)


def _model(simulated: SimulatedFeatures, means: Floats) -> FeatureModel:
    """With means of given realisations, (H, F); what the sizes do is that of the first, which shares its noise."""
    change = simulated.values[:, 0] - simulated.base
    return FeatureModel(simulated.base, means + (scaled(change, SIZES) - change), _variances(simulated))


def told_by(log_likelihoods: Floats, weights: Floats) -> Told:
    """What is told by log-likelihoods, (R, holds, H), of hypotheses with given probabilities, (H,)."""
    rate = float(max(LEARNING_RATES, key=lambda one: _information(log_likelihoods, weights, one)))
    right = _right(posteriors(log_likelihoods, weights, rate))
    return Told(
        information=_information(log_likelihoods, weights, rate),
        probability=float(right.mean(axis=0) @ weights),
        learning_rate=rate,
    )


def information_bound(log_likelihoods: Floats, weights: Floats) -> float:
    """Bits that log-likelihoods, (R, holds, H), tell at least; normal ones of the same spread assumed.

    The divergence of Bhattacharyya is then a quarter of that of Kullback and Leibler.
    """
    ahead = _right(log_likelihoods)[..., None] - log_likelihoods
    divergence = 0.25 * np.maximum(ahead.mean(axis=0), 0.0)
    return float(-weights @ np.log2(np.exp(-divergence) @ weights))


def entropy(weights: Floats) -> float:
    """Of hypotheses with these probabilities, bits: what can be told at most."""
    return float(-weights @ np.log2(weights))


def posteriors(log_likelihoods: Floats, weights: Floats, learning_rate: float) -> Floats:
    """(…, H) probabilities of hypotheses."""
    logs = learning_rate * log_likelihoods + np.log(weights)
    powers = np.exp(logs - logs.max(axis=-1, keepdims=True))
    found: Floats = powers / powers.sum(axis=-1, keepdims=True)
    return found


def _information(log_likelihoods: Floats, weights: Floats, rate: float) -> float:
    right = _right(posteriors(log_likelihoods, weights, rate))
    gained = np.log2(np.maximum(right, np.finfo(float).tiny) / weights)
    return float(gained.mean(axis=0) @ weights)


def _right(found: Floats) -> Floats:
    """(R, H) what is given to the hypothesis that holds."""
    right: Floats = np.diagonal(found, axis1=1, axis2=2)
    return right


def _variances(simulated: SimulatedFeatures) -> Floats:
    """(H, F) spread over realisations, drawn towards that of all hypotheses, and relevance thresholds together."""
    values = simulated.values
    own = values.var(axis=1, ddof=1)
    degrees = values.shape[1] - 1
    spread = (degrees * own + PRIOR_REALISATIONS * own.mean(axis=0)) / (degrees + PRIOR_REALISATIONS)
    variances: Floats = spread + np.square(simulated.thresholds)
    variances[variances == 0.0] = 1.0  # of regressors that the motion has not
    return variances
