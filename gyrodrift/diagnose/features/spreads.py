"""How means of samples scatter about their neighbours, whatever the motion: squares of their differences."""

from dataclasses import dataclass

import numpy as np

from gyrodrift.arrays import Floats, Integers, Mask
from gyrodrift.diagnose.features.block_means import OUTLIER_LIMIT, block_means
from gyrodrift.diagnose.features.regimes import Regimes

REST_POINTS = (1, 2, 4, 8, 16, 32)
MOVING_POINTS = (1, 2, 4)
"""Samples in each of the means whose scatter is looked at, at rest and in motion."""

REST_ORDER, MOVING_ORDER = 2, 3
"""Of the differences: a steady rate and ramp leave no second one, and a changing acceleration hardly a third."""

REST_GAIN, MOVING_GAIN = 6.0, 20.0
"""Variances of the second and third difference of white noise over its own: 1 + 4 + 1, and 1 + 9 + 9 + 1."""

LEAST_SQUARE = 1e-12
"""Of a difference; keeps the limit of equal values above zero."""


@dataclass(frozen=True, slots=True)
class DifferenceIndices:
    """Which differences lie within a regime, by their first mean: one array for each number of points.

    rest
        For each of REST_POINTS, of order REST_ORDER.
    slow, fast
        For each of MOVING_POINTS, of order MOVING_ORDER.
    turning
        Of single samples, slow or fast, of order MOVING_ORDER.
    """

    rest: tuple[Integers, ...]
    slow: tuple[Integers, ...]
    fast: tuple[Integers, ...]
    turning: Integers


@dataclass(frozen=True, slots=True)
class Spreads:
    """Variances of the white noise that would scatter as much, of single samples: one for each number of points."""

    rest: tuple[float, ...]
    slow: tuple[float, ...]
    fast: tuple[float, ...]


def difference_indices_of(regimes: Regimes) -> DifferenceIndices:
    """The places of a motion's regimes."""
    return DifferenceIndices(
        rest=tuple(_within(regimes.at_rest, points, REST_ORDER) for points in REST_POINTS),
        slow=tuple(_within(regimes.is_slow, points, MOVING_ORDER) for points in MOVING_POINTS),
        fast=tuple(_within(regimes.is_fast, points, MOVING_ORDER) for points in MOVING_POINTS),
        turning=_within(regimes.is_turning, 1, MOVING_ORDER),
    )


def spreads_of(rate_dps: Floats, places: DifferenceIndices) -> Spreads:
    """Of a rate, in (deg/s)²."""
    rest, slow, fast = [], [], []
    for number, points in enumerate(REST_POINTS):
        second = np.diff(block_means(rate_dps, points), REST_ORDER)
        rest.append(_mean_square(second[places.rest[number]]) * points / REST_GAIN)
        if number < len(MOVING_POINTS):
            third = np.diff(second)
            slow.append(_mean_square(third[places.slow[number]]) * points / MOVING_GAIN)
            fast.append(_mean_square(third[places.fast[number]]) * points / MOVING_GAIN)
    return Spreads(tuple(rest), tuple(slow), tuple(fast))


def turning_spread(values: Floats, places: DifferenceIndices) -> float:
    """Variance of the white noise that would scatter as much as values by sample do in motion."""
    return _mean_square(np.diff(values, MOVING_ORDER)[places.turning]) / MOVING_GAIN


def _within(allowed: Mask, points: int, order: int) -> Integers:
    """Of differences of an order between neighbouring means, the first of those that lie within allowed samples."""
    inside = allowed[: len(allowed) // points * points : points]
    kept = inside[order:] & inside[:-order]
    for between in range(1, order):
        kept = kept & inside[between : between - order]
    return np.flatnonzero(kept)


def _mean_square(differences: Floats) -> float:
    """Outliers held back; 0 of none."""
    if not len(differences):
        return 0.0
    squares = np.square(differences)
    limit = OUTLIER_LIMIT * _usual(squares) + LEAST_SQUARE
    return float(np.minimum(squares, limit).mean())


def _usual(squares: Floats) -> float:
    """Their median; of which many are 0, rather what it would be by the mean of the smaller ones, or it would jump."""
    middle = np.median(squares)
    if np.count_nonzero(squares < LEAST_SQUARE) < 0.25 * len(squares):  # a dead band or coarse steps hide most
        return middle
    kept = max(1, round(0.9 * len(squares)))  # nine tenths are no outliers
    trimmed = float(np.partition(squares, kept - 1)[:kept].mean())
    return max(middle, 0.73 * trimmed)  # median of normal numbers' squares over the mean of the smaller nine tenths
