"""Information that a motion gives about the hypotheses, and the expected probability of the right answer.

Each realization is judged by a model of the other realizations (leave one out). Otherwise a coincidence of a few
realizations would count as knowledge.

The likelihood treats features as independent, and they are not. So it is raised to a power, the learning rate of a
generalized Bayesian posterior (Grünwald and van Ommen 2017). The learning rate is fitted to the same realizations, so
that stated probabilities are right on average.

Screening simulates a motion a few times only. It uses a lower bound of the information, from the divergences between
pairs of hypotheses (Kolchinsky and Tracey, Estimating mixture entropy with pairwise distances, 2017). Hypotheses share
random numbers, so mean divergences scatter far less than posteriors.
"""

from dataclasses import dataclass, field

import numpy as np
from scipy.special import logsumexp

from gyrodrift.diagnose.inference.density import DEGREES_OF_FREEDOM
from gyrodrift.diagnose.inference.log_variances import scaled
from gyrodrift.diagnose.inference.scorer import USUAL
from gyrodrift.diagnose.next_recording.simulated_features import SimulatedFeatures
from gyrodrift.values.arrays import Floats

LEARNING_RATES = np.concatenate([[0.0], np.geomspace(0.01, 1.0, 17)])
"""Learning rates among which the best is chosen; 0 ignores the features."""

SIZES = np.array([0.7, 0.84, 1.0, 1.19, 1.43])
"""Factors of the fitted size of a cause, equally probable: the fit may be off by as much. A difference that another
size of the cause explains does not separate it from another cause."""

PRIOR_REALISATIONS = 4.0
"""Degrees of freedom of the prior variance, which is the mean of the variances under all hypotheses. Chosen: more than
the few realizations of a motion weigh."""


@dataclass(frozen=True, slots=True)
class Discrimination:
    """How well features separate the hypotheses.

    information
        Expected information gain, bits.
    probability
        Expected posterior probability of the true hypothesis.
    learning_rate
        Power of the likelihood.
    """

    information: float
    probability: float
    learning_rate: float


@dataclass(frozen=True, slots=True, eq=False)
class FeatureModel:
    """Prediction of F features by each of H hypotheses.

    base
        (F,) features of the rig that all hypotheses share.
    means
        (sizes, H, F) mean features under each hypothesis, with its cause at each of SIZES times the fitted size.
    variances
        (H, F) variance of a single realization plus the square of the relevance threshold.
    """

    base: Floats = field(repr=False)
    means: Floats = field(repr=False)
    variances: Floats = field(repr=False)

    def log_likelihoods(self, values: Floats) -> Floats:
        """(n, H) log-likelihoods of features (n, F) under each hypothesis; the likelihood is averaged over SIZES."""
        measured = values[:, None, None]
        changes = np.broadcast_to(self.means - self.base, (len(values), *self.means.shape))
        at_sizes = log_likelihood(measured - self.means, self.variances + np.square(USUAL * changes))
        averaged: Floats = logsumexp(at_sizes, axis=1) - np.log(len(SIZES))
        return averaged


def log_likelihood(residual: Floats, variance: Floats) -> Floats:
    """(…,) logarithm of a Student density but for a constant, summed over features, the last axis."""
    nu = DEGREES_OF_FREEDOM
    terms = -0.5 * (nu + 1.0) * np.log1p(np.square(residual) / (nu * variance)) - 0.5 * np.log(variance)
    total: Floats = terms.sum(axis=-1)
    return total


def held_out_log_likelihoods(simulated: SimulatedFeatures) -> Floats:
    """(R, H, H) log-likelihoods [realization, true hypothesis, assumed hypothesis].

    The model that judges a realization has the means of the other realizations.
    """
    values = simulated.values
    totals, remaining = values.sum(axis=1), values.shape[1] - 1
    held_out = [
        feature_model(simulated, (totals - realization) / remaining).log_likelihoods(realization)
        for realization in values.swapaxes(0, 1)
    ]
    return np.array(held_out)


def feature_model(simulated: SimulatedFeatures, means: Floats) -> FeatureModel:
    """Model with given mean features (H, F).

    The effect of the size comes from the first realization: it has the random numbers of `base`, so their difference
    has little noise.
    """
    change = simulated.values[:, 0] - simulated.base
    return FeatureModel(simulated.base, means + (scaled(change, SIZES) - change), _variances(simulated))


def discrimination_of(log_likelihoods: Floats, weights: Floats) -> Discrimination:
    """Discrimination by held-out log-likelihoods (R, H, H), at the learning rate with the most information.

    weights
        (H,) prior probabilities of the hypotheses.
    """
    rate = float(max(LEARNING_RATES, key=lambda candidate: _information(log_likelihoods, weights, candidate)))
    right = _of_true_hypothesis(posteriors(log_likelihoods, weights, rate))
    return Discrimination(
        information=_information(log_likelihoods, weights, rate),
        probability=float(right.mean(axis=0) @ weights),
        learning_rate=rate,
    )


def information_bound(log_likelihoods: Floats, weights: Floats) -> float:
    """Lower bound of the information of held-out log-likelihoods (R, H, H), bits.

    The bound has the Bhattacharyya divergence of each pair of hypotheses. It is a quarter of the Kullback-Leibler
    divergence, the mean log-likelihood ratio, if the features are normal with equal variances.
    """
    ahead = _of_true_hypothesis(log_likelihoods)[..., None] - log_likelihoods
    divergence = 0.25 * np.maximum(ahead.mean(axis=0), 0.0)
    return float(-weights @ np.log2(np.exp(-divergence) @ weights))


def entropy(weights: Floats) -> float:
    """Entropy of hypotheses with probabilities (H,), bits: the most information that features can give."""
    return float(-weights @ np.log2(weights))


def posteriors(log_likelihoods: Floats, weights: Floats, learning_rate: float) -> Floats:
    """(…, H) posterior probabilities of the hypotheses."""
    logs = learning_rate * log_likelihoods + np.log(weights)
    powers = np.exp(logs - logs.max(axis=-1, keepdims=True))
    normalized: Floats = powers / powers.sum(axis=-1, keepdims=True)
    return normalized


def _information(log_likelihoods: Floats, weights: Floats, rate: float) -> float:
    """Expected information gain at a learning rate, bits."""
    right = _of_true_hypothesis(posteriors(log_likelihoods, weights, rate))
    gained = np.log2(np.maximum(right, np.finfo(float).tiny) / weights)
    return float(gained.mean(axis=0) @ weights)


def _of_true_hypothesis(values: Floats) -> Floats:
    """(R, H) values (R, H, H) of the true hypothesis: those in which true and assumed hypothesis agree."""
    diagonal: Floats = np.diagonal(values, axis1=1, axis2=2)
    return diagonal


def _variances(simulated: SimulatedFeatures) -> Floats:
    """(H, F) variances over realizations, shrunk towards their mean over the hypotheses, plus squared thresholds."""
    values = simulated.values
    own = values.var(axis=1, ddof=1)
    degrees = values.shape[1] - 1
    spread = (degrees * own + PRIOR_REALISATIONS * own.mean(axis=0)) / (degrees + PRIOR_REALISATIONS)
    variances: Floats = spread + np.square(simulated.thresholds)
    variances[variances == 0.0] = 1.0  # a regressor that the motion does not excite
    return variances
