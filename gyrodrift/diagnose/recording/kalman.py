"""Forward filter and backward sampler of a motion, compiled. States are angle, rate, acceleration and gyro bias.

The forward pass is a Kalman filter with sequential scalar measurements. The backward pass draws a path from the joint
posterior of all states (S. Frühwirth-Schnatter, Data augmentation and dynamic linear models, 1994). Without random
numbers it is the smoother of H. E. Rauch, F. Tung and C. T. Striebel (1965).
"""

import numpy as np
import numpy.typing as npt

from gyrodrift.io.compile import compiled_once
from gyrodrift.values.arrays import Floats

STATES = 4
"""Angle, degrees; rate, deg/s; acceleration, deg/s²; bias, deg/s. By definition of the model."""

NOT_MEASURED = 0.0
"""Variance that marks a sample without the measurement. By definition: no measurement is exact."""

LEAST_RANK = 1e-16
"""Cholesky pivots up to this value are rounding errors, and count as 0. Chosen: the relative rounding error of a
double."""

LEAST_VARIANCE = 1e-14
"""Lower bound of the variance of a state. Rounding could make it negative. Chosen: 1e-7 of each unit, far below counts
and noise."""


Array = npt.NDArray[np.float64]
FilteredStates = tuple[Floats, Floats, Floats, Floats]
"""Input of the backward pass: means, (n, 4), and covariances, (n, 4, 4), after each sample, and the intensities of jerk
and bias walk, (n,).

Predictions are not stored: to compute them again is faster.
"""


@compiled_once(nogil=False, inline="always")
def _copy(mean: Array, covariance: Array, to_mean: Array, to_covariance: Array) -> None:
    """Copy a state element by element: numba needs seconds to compile slices."""
    for i in range(4):
        to_mean[i] = mean[i]
        for j in range(4):
            to_covariance[i, j] = covariance[i, j]


@compiled_once(nogil=False, inline="always")
def _measure(mean: Array, covariance: Array, weights: Array, value: float, variance: float, gain: Array) -> None:
    """Update a state with a scalar measurement, in place.

    weights
        (4,) derivatives of the measured value with respect to the state.
    gain
        (4,) working memory.
    """
    innovation_variance, innovation = variance, value
    for i in range(4):
        gain[i] = 0.0
        for j in range(4):
            gain[i] += covariance[i, j] * weights[j]
        innovation_variance += weights[i] * gain[i]
        innovation -= weights[i] * mean[i]
    for i in range(4):
        share = gain[i] / innovation_variance
        mean[i] += share * innovation
        for j in range(i + 1):
            updated = covariance[i, j] - share * gain[j]
            covariance[i, j] = updated
            covariance[j, i] = updated
        covariance[i, i] = max(covariance[i, i], LEAST_VARIANCE)


@compiled_once(nogil=False, inline="always")
def _predict(mean: Array, covariance: Array, t: float, jerk: float, walk: float) -> None:
    """Predict the state of the next sample, in place.

    The covariance is multiplied by the transition matrix from the left, row by row, then from the right.

    t
        Sample period, s.
    jerk, walk
        Intensities of the white noises that drive acceleration, deg²/s⁵, and bias, deg²/s³.
    """
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
    """Write the Cholesky factor of a matrix, and the inverse of each pivot.

    A matrix may lack rank: both are 0 for a pivot of at most LEAST_RANK.
    """
    for i in range(4):
        for j in range(i):
            remainder = matrix[i, j]
            for k in range(j):
                remainder -= lower[i, k] * lower[j, k]
            lower[i, j] = remainder * inverse[j]
        remainder = matrix[i, i]
        for k in range(i):
            remainder -= lower[i, k] * lower[i, k]
        lower[i, i] = np.sqrt(remainder) if remainder > LEAST_RANK else 0.0
        inverse[i] = 1.0 / lower[i, i] if remainder > LEAST_RANK else 0.0


@compiled_once(nogil=False)
def filter_forward(
    period_s: float,
    angles: tuple[Floats, Floats],
    edges: tuple[Floats, Floats],
    rates: tuple[Floats, Floats],
    rest_variance: Floats,
    drives: tuple[Floats, Floats],
) -> FilteredStates:
    """Filter all measurements from the first sample to the last.

    Arrays have the shape (n,). A variance of NOT_MEASURED marks a sample without the measurement.

    angles
        Angle at a sample, degrees, and its variance.
    edges
        Angle half a sample before, at an edge between two encoder counts, and its variance.
    rates
        Rate of the gyro with its bias, deg/s, and its variance.
    rest_variance
        Variance of the rate of a device at rest.
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
def sample_backward(  # noqa: C901, PLR0912 - one compiled pass
    period_s: float,
    filtered: FilteredStates,
    noise: Floats,
    is_drawn: bool,  # noqa: FBT001 - numba takes no keywords
) -> Floats:
    """Angle and rate at each sample, (n, 2): a path from the posterior, or the posterior mean.

    noise
        (n, 4) standard normal numbers of a drawn path.
    is_drawn
        Whether a path is drawn; `noise` is ignored otherwise.
    """
    means, covariances, jerk, walk = filtered
    count, t = len(means), period_s
    half = 0.5 * t * t
    # `ahead` is the covariance of a state and its successor, `conditional` that of a state given its successor.
    lower, gain, ahead, conditional = np.zeros((4, 4)), np.zeros((4, 4)), np.zeros((4, 4)), np.zeros((4, 4))
    predicted_mean, predicted = np.zeros(4), np.zeros((4, 4))
    # `last` is the deviation of the successor from its prediction.
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
                    remainder = ahead[r, i]
                    for j in range(i):
                        remainder -= lower[i, j] * d[j]
                    d[i] = remainder * inverse[i]
                for i in range(3, -1, -1):
                    remainder = d[i]
                    for j in range(i + 1, 4):
                        remainder -= lower[j, i] * gain[r, j]
                    gain[r, i] = remainder * inverse[i]
        for i in range(4):
            state[i] = means[k, i]
            for j in range(4):
                state[i] += gain[i, j] * last[j]
        if is_drawn:
            for i in range(4):
                for j in range(i + 1):
                    remainder = covariances[k, i, j]
                    for r in range(4):
                        remainder -= gain[i, r] * ahead[j, r]
                    conditional[i, j] = remainder
            _cholesky(conditional, lower, inverse)
            for i in range(4):
                for j in range(i + 1):
                    state[i] += lower[i, j] * noise[k, j]
        path[k, 0], path[k, 1] = state[0], state[1]
    return path
