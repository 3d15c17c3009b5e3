"""Noise by differences of neighboring means of samples, in which the motion cancels."""

from dataclasses import dataclass

import numpy as np

from gyrodrift.diagnose.features.block_means import OUTLIER_LIMIT, block_means
from gyrodrift.diagnose.features.regimes import Regimes
from gyrodrift.diagnose.recording.order_statistics import median
from gyrodrift.values.arrays import Floats, Integers, Mask

REST_LENGTHS = (1, 4, 8, 32)
MOVING_LENGTHS = (1, 4)
"""Samples in a mean, at rest and in motion. Chosen: from one sample on, in motion only as long as the third difference
of a motion is almost 0."""

REST_ORDER, MOVING_ORDER = 2, 3
"""Orders of the differences. Chosen: the second difference of a constant rate or a ramp is 0. The third difference is
almost 0 if the acceleration changes."""

REST_GAIN, MOVING_GAIN = 6.0, 20.0
"""Variance of second and third differences of white noise, divided by its variance. Derived: 1 + 4 + 1, and 1 + 9 + 9 +
1."""

LEAST_SQUARE = 1e-12
"""Squared difference below which values count as equal; it also keeps the limit of outliers above zero. Chosen: 1e-6
deg/s, far below the step of a gyro."""


@dataclass(frozen=True, slots=True)
class DifferenceIndices:
    """Indices of the differences that lie within a regime.

    rest
        Differences of order REST_ORDER, one array for every length in REST_LENGTHS.
    slow, fast
        Differences of order MOVING_ORDER, one array for every length in MOVING_LENGTHS.
    turning
        Differences of single samples of order MOVING_ORDER, in slow or fast motion.
    """

    rest: tuple[Integers, ...]
    slow: tuple[Integers, ...]
    fast: tuple[Integers, ...]
    turning: Integers


@dataclass(frozen=True, slots=True)
class Spreads:
    """Variance of samples of white noise with the same differences of means; one entry per length of the means."""

    rest: tuple[float, ...]
    slow: tuple[float, ...]
    fast: tuple[float, ...]


def difference_indices_of(regimes: Regimes) -> DifferenceIndices:
    """Indices of the differences within the regimes of a motion."""
    return DifferenceIndices(
        rest=tuple(_within(regimes.at_rest, length, REST_ORDER) for length in REST_LENGTHS),
        slow=tuple(_within(regimes.is_slow, length, MOVING_ORDER) for length in MOVING_LENGTHS),
        fast=tuple(_within(regimes.is_fast, length, MOVING_ORDER) for length in MOVING_LENGTHS),
        turning=_within(regimes.is_turning, 1, MOVING_ORDER),
    )


def spreads_of(rate_dps: Floats, indices: DifferenceIndices) -> Spreads:
    """Spreads of a rate, (deg/s)²."""
    rest, slow, fast = [], [], []
    for index, length in enumerate(REST_LENGTHS):
        second = np.diff(block_means(rate_dps, length), REST_ORDER)
        rest.append(_mean_square(second[indices.rest[index]]) * length / REST_GAIN)
        if index < len(MOVING_LENGTHS):
            third = np.diff(second)
            slow.append(_mean_square(third[indices.slow[index]]) * length / MOVING_GAIN)
            fast.append(_mean_square(third[indices.fast[index]]) * length / MOVING_GAIN)
    return Spreads(tuple(rest), tuple(slow), tuple(fast))


def turning_spread(values: Floats, indices: DifferenceIndices) -> float:
    """Variance of white noise with the same third differences as the values in motion."""
    return _mean_square(np.diff(values, MOVING_ORDER)[indices.turning]) / MOVING_GAIN


def _within(allowed: Mask, length: int, order: int) -> Integers:
    """Indices of the differences of an order whose means all begin at an allowed sample.

    length
        Number of samples in a mean.
    """
    inside = allowed[: len(allowed) // length * length : length]
    kept = inside[order:] & inside[:-order]
    for offset in range(1, order):
        kept = kept & inside[offset : offset - order]
    return np.flatnonzero(kept)


def _mean_square(differences: Floats) -> float:
    """Mean square of differences, with outliers limited; 0 without differences."""
    if not len(differences):
        return 0.0
    squares = np.square(differences)
    limit = OUTLIER_LIMIT * _robust_median(squares) + LEAST_SQUARE
    return float(np.minimum(squares, limit).mean())


def _robust_median(squares: Floats) -> float:
    """Median of squares. If many squares are 0, at least the median that follows from the mean of the smaller ones.

    Without this bound the median jumps to 0 as soon as half of the squares are 0.
    """
    middle = median(squares)
    if np.count_nonzero(squares < LEAST_SQUARE) < 0.25 * len(squares):  # many zeros: a dead band or coarse steps
        return middle
    kept = max(1, round(0.9 * len(squares)))  # a tenth may be outliers
    trimmed = float(np.partition(squares, kept - 1)[:kept].mean())
    return max(middle, 0.73 * trimmed)  # ratio of both for normal numbers
