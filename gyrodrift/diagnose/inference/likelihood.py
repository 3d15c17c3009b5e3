"""The likelihood of features under a predicted change: a Student density that knows its model to be inexact.

A candidate is never the exact form of a real effect: what it changes may be off by a share of the change, and what it
does to one regressor leaks to the others. This is the model discrepancy of M. C. Kennedy and A. O'Hagan, Bayesian
calibration of computer models (2001). Without its variance, what a large true cause leaves unexplained would be
explained by a crowd of small wrong ones.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.vector import IS_LOG, STATIC

DEGREES_OF_FREEDOM = 4.0
"""Of the Student density: few, so that no single feature decides."""

DISCREPANCY, CROSS_TALK, EXACT_CROSS_TALK = 0.1, 0.04, 0.01
"""Shares of its own change by which a candidate may be off, in the same feature and in other regressors; and in these
where a device can follow no other form: what a strong one of these leaves there is another effect."""

LOG_RANGE, LEAST_VARIANCE = 20.0, 1e-6
"""Bounds of logarithms of variances that are added as variances, so that nothing overflows or becomes 0."""


LOGARITHMS = np.flatnonzero(IS_LOG)


def combined(change: Floats, more: Floats) -> Floats:
    """Two changes at once, (…, F): logarithms of variances add as variances, all else as it is."""
    added: Floats = change + more
    one, other = (np.take(each, LOGARITHMS, axis=-1) for each in (change, more))
    powers = np.exp(np.clip(one, -LOG_RANGE, LOG_RANGE)) + np.exp(np.clip(other, -LOG_RANGE, LOG_RANGE))
    both = np.log(np.maximum(powers - 1.0, LEAST_VARIANCE))
    added[..., LOGARITHMS] = np.where((one > 0.0) & (other > 0.0), both, one + other)
    return added


def discrepancy_variance(mean: Floats, difference: Floats, cross_talk: float = CROSS_TALK) -> Floats:
    """Variance for not being the exact form: a share of the change itself, and of all that goes to the regressors.

    But no more than of what there is to explain, or far too large a cause would excuse everything.

    mean
        (…, F) what a candidate changes.
    difference
        (sessions, F) what there is to explain.
    cross_talk
        Share that goes to other regressors.
    """
    variance: Floats = np.square(DISCREPANCY * np.minimum(np.abs(mean), np.abs(difference)))
    leaks = cross_talk * np.minimum(_static(mean), _static(difference))
    variance[..., :STATIC] += leaks**2
    return variance


def _static(change: Floats) -> Floats:
    """(…, 1) length of what goes to the regressors."""
    length: Floats = np.linalg.norm(change[..., :STATIC], axis=-1, keepdims=True)
    return length


class Scatter(NamedTuple):
    """Of features about a prediction, where few realisations may change them much.

    variance, usual
        With what these do, and without.
    shift
        By which the middle of those without is beside the prediction.
    """

    variance: Floats
    usual: Floats
    shift: Floats

    def beside(self, other: "Scatter") -> "Scatter":
        """Of both at once."""
        return Scatter(self.variance + other.variance, self.usual + other.usual, self.shift + other.shift)

    def widened(self, variance: Floats | float) -> "Scatter":
        """With a variance more that is always there."""
        return Scatter(variance + self.variance, variance + self.usual, self.shift)

    def through(self, total: Callable[[Floats], Floats]) -> "Scatter":
        """With all else that scatters, as a function of either variance."""
        return Scatter(total(self.variance), total(self.usual), self.shift)


def log_likelihood_of_events(residual: Floats, scatter: Scatter, discrepancy: Floats) -> Floats:
    """The same where a session has what happens in few of them, or has not: either is as likely as the other.

    By the spread alone, what happens to one session in four would cost all others as much as it gains that one.
    """
    with_it = log_likelihood(residual, scatter.variance, discrepancy)
    if not (scatter.usual < scatter.variance).any():
        return with_it
    without_it = log_likelihood(residual - scatter.shift, scatter.usual, discrepancy)
    total: Floats = np.logaddexp(with_it, without_it) - np.log(2.0)
    return total


def log_likelihood(residual: Floats, variance: Floats, discrepancy: Floats) -> Floats:
    """Sum over features of the logarithm of a Student density; model discrepancy is no spread, and costs nothing."""
    squares = np.square(residual) / (DEGREES_OF_FREEDOM * (variance + discrepancy))
    away, wide = np.log1p(squares).sum(axis=-1), np.log(variance).sum(axis=-1)
    total: Floats = -0.5 * (DEGREES_OF_FREEDOM + 1.0) * away - 0.5 * wide
    return total
