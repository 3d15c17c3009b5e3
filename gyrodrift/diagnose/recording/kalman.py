"""Forward filter and backward sampler of a motion, compiled: angle, rate, acceleration, and the bias of the gyro.

A Kalman filter whose measurements are scalars and come one after the other, and the backward pass of S. Frühwirth-
Schnatter, Data augmentation and dynamic linear models (1994), which draws a path from the posterior of all states; with
no noise in it, the pass is the smoother of H. E. Rauch, F. Tung and C. T. Striebel (1965).
"""

import numpy as np
import numpy.typing as npt

from gyrodrift.arrays import Floats
from gyrodrift.compile import compiled_once

STATES = 4
"""Angle, degrees; rate, deg/s; acceleration, deg/s²; bias, deg/s."""

NOT_MEASURED = 0.0
"""A variance of this says that there is no such measurement at a sample."""

LEAST_RANK = 1e-16
"""Pivots below it are rounding."""

LEAST_VARIANCE = 1e-14
"""Of any state: keeps a covariance from losing its positive diagonal to rounding."""


Array = npt.NDArray[np.float64]
Passed = tuple[Floats, Floats, Floats, Floats]
"""What a filter leaves for the way back: means (n, 4) and covariances (n, 4, 4) after each sample, and the drives. What
was predicted for a sample follows from these; to keep it takes longer than to work it out again."""


@compiled_once(nogil=False, inline="always")
def _copy(mean: Array, covariance: Array, to_mean: Array, to_covariance: Array) -> None:
    """A state by its numbers: what numba makes of slices takes it seconds to compile."""
    for i in range(4):
        to_mean[i] = mean[i]
        for j in range(4):
            to_covariance[i, j] = covariance[i, j]


@compiled_once(nogil=False, inline="always")
def _measure(mean: Array, covariance: Array, weights: Array, value: float, variance: float, gain: Array) -> None:
    """Take a scalar measurement into a state, in place."""
    spread, away = variance, value
    for i in range(4):
        gain[i] = 0.0
        for j in range(4):
            gain[i] += covariance[i, j] * weights[j]
        spread += weights[i] * gain[i]
        away -= weights[i] * mean[i]
    for i in range(4):
        share = gain[i] / spread
        mean[i] += share * away
        for j in range(i + 1):
            less = covariance[i, j] - share * gain[j]
            covariance[i, j] = less
            covariance[j, i] = less
        covariance[i, i] = max(covariance[i, i], LEAST_VARIANCE)


@compiled_once(nogil=False, inline="always")
def _predict(mean: Array, covariance: Array, t: float, jerk: float, walk: float) -> None:
    """Take a state to the next sample, in place: first its rows and then its columns go through the same step."""
    half = 0.5 * t * t
    mean[0] += t * mean[1] + half * mean[2]
    mean[1] += t * mean[2]
    for j in range(4):
        covariance[0, j] += t * covariance[1, j] + half * covariance[2, j]
        covariance[1, j] += t * covariance[2, j]
    for i in range(4):
        covariance[i, 0] += t * covariance[i, 1] + half * covariance[i, 2]
        covariance[i, 1] += t * covariance[i, 2]
    q1 = jerk * t
    q2 = 0.5 * q1 * t
    q3 = q2 * t / 1.5
    covariance[0, 0] += q3 * t * t * 0.15
    covariance[0, 1] += q3 * t * 0.375
    covariance[0, 2] += q3 * 0.5
    covariance[1, 1] += q3
    covariance[1, 2] += q2
    covariance[2, 2] += q1
    covariance[3, 3] += walk * t
    for i in range(4):
        for j in range(i):
            covariance[i, j] = covariance[j, i]


@compiled_once(nogil=False, inline="always")
def _cholesky(matrix: Array, lower: Array, inverse: Array) -> None:
    """Lower triangle of a matrix that may lack rank, and of each pivot the inverse, 0 where it lacks it."""
    for i in range(4):
        for j in range(i):
            rest = matrix[i, j]
            for k in range(j):
                rest -= lower[i, k] * lower[j, k]
            lower[i, j] = rest * inverse[j]
        rest = matrix[i, i]
        for k in range(i):
            rest -= lower[i, k] * lower[i, k]
        lower[i, i] = np.sqrt(rest) if rest > LEAST_RANK else 0.0
        inverse[i] = 1.0 / lower[i, i] if rest > LEAST_RANK else 0.0


@compiled_once(nogil=False)
def filtered(
    period_s: float,
    angles: tuple[Floats, Floats],
    edges: tuple[Floats, Floats],
    rates: tuple[Floats, Floats],
    rest_variance: Floats,
    drives: tuple[Floats, Floats],
) -> Passed:
    """Take all that was measured into a state, from the first sample to the last.

    angles
        Angle at each sample, degrees, and its variance.
    edges
        Angle half a sample before, where the encoder counted, and its variance.
    rates
        Rate of the gyro, deg/s, bias in it, and its variance.
    rest_variance
        Of a rate that is 0, where the device rests.
    drives
        Intensities of the white noises that drive acceleration, deg²/s⁵, and bias, deg²/s³.
    """
    count = len(rest_variance)
    means, covariances = np.empty((count, 4)), np.empty((count, 4, 4))
    mean, gain, covariance = np.zeros(4), np.zeros(4), np.zeros((4, 4))
    mean[0] = angles[0][0]
    covariance[0, 0], covariance[1, 1], covariance[2, 2], covariance[3, 3] = 1.0, 1e4, 1e6, 1.0
    of_angle, of_edge = np.array([1.0, 0.0, 0.0, 0.0]), np.array([1.0, -0.5 * period_s, 0.0, 0.0])
    of_gyro, of_rate = np.array([0.0, 1.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0, 0.0])
    for k in range(count):
        if k > 0:
            _predict(mean, covariance, period_s, drives[0][k], drives[1][k])
        if angles[1][k] > 0.0:
            _measure(mean, covariance, of_angle, angles[0][k], angles[1][k], gain)
        if edges[1][k] > 0.0:
            _measure(mean, covariance, of_edge, edges[0][k], edges[1][k], gain)
        if rates[1][k] > 0.0:
            _measure(mean, covariance, of_gyro, rates[0][k], rates[1][k], gain)
        if rest_variance[k] > 0.0:
            _measure(mean, covariance, of_rate, 0.0, rest_variance[k], gain)
        _copy(mean, covariance, means[k], covariances[k])
    return means, covariances, drives[0], drives[1]


@compiled_once(nogil=False)
def smoothed_back(  # noqa: C901, PLR0912 - one compiled pass
    period_s: float,
    passed: Passed,
    noise: Floats,
    is_drawn: bool,  # noqa: FBT001 - numba takes no keywords
) -> Floats:
    """Angle and rate at each sample, (n, 2): a path drawn by standard normal numbers, (n, 4), or the mean of all."""
    means, covariances, jerk, walk = passed
    count, t = len(means), period_s
    half = 0.5 * t * t
    lower, gain, ahead, rest = np.zeros((4, 4)), np.zeros((4, 4)), np.zeros((4, 4)), np.zeros((4, 4))
    predicted_mean, predicted = np.zeros(4), np.zeros((4, 4))
    d, state, last, inverse = np.zeros(4), np.zeros(4), np.zeros(4), np.zeros(4)
    path = np.empty((count, 2))
    for k in range(count - 1, -1, -1):
        if k < count - 1:
            _copy(means[k], covariances[k], predicted_mean, predicted)
            _predict(predicted_mean, predicted, t, jerk[k + 1], walk[k + 1])
            for i in range(4):
                last[i] = state[i] - predicted_mean[i]
                ahead[i, 0] = covariances[k, i, 0] + t * covariances[k, i, 1] + half * covariances[k, i, 2]
                ahead[i, 1] = covariances[k, i, 1] + t * covariances[k, i, 2]
                ahead[i, 2], ahead[i, 3] = covariances[k, i, 2], covariances[k, i, 3]
            _cholesky(predicted, lower, inverse)
            for r in range(4):
                for i in range(4):
                    left = ahead[r, i]
                    for j in range(i):
                        left -= lower[i, j] * d[j]
                    d[i] = left * inverse[i]
                for i in range(3, -1, -1):
                    left = d[i]
                    for j in range(i + 1, 4):
                        left -= lower[j, i] * gain[r, j]
                    gain[r, i] = left * inverse[i]
        for i in range(4):
            state[i] = means[k, i]
            for j in range(4):
                state[i] += gain[i, j] * last[j]
        if is_drawn:
            for i in range(4):
                for j in range(i + 1):
                    left = covariances[k, i, j]
                    for r in range(4):
                        left -= gain[i, r] * ahead[j, r]
                    rest[i, j] = left
            _cholesky(rest, lower, inverse)
            for i in range(4):
                for j in range(i + 1):
                    state[i] += lower[i, j] * noise[k, j]
        path[k, 0], path[k, 1] = state[0], state[1]
    return path
