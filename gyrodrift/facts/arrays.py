"""Array operations that several facts use."""

from math import inf, sqrt
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from gyrodrift.values.arrays import Floats, Mask
from gyrodrift.values.constants import NORMAL_MAD

Scalar = TypeVar("Scalar", bound=np.generic)


def only(values: Floats, is_kept: Mask) -> Floats:
    """Select values; without a copy if all are kept, because copies take most of the time here."""
    return values if is_kept.all() else values[is_kept]


def blocks_of(values: NDArray[Scalar], size: int) -> NDArray[Scalar]:
    """Arrange the values in rows of `size`; an incomplete last row is dropped."""
    return values[: len(values) // size * size].reshape(-1, size)


def samples_in(seconds: float, period_s: float) -> int:
    """Number of samples in a time, at least 1."""
    return max(1, round(min(seconds / period_s, 1e9)))


def true_runs(inside: Mask) -> tuple[tuple[int, int], ...]:
    """First and end sample of every run of true values."""
    edges = np.flatnonzero(np.diff(inside, prepend=False, append=False))
    return tuple(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))


def smallest_step(values: Floats) -> float | None:
    """Smallest change between neighbors above 1e-9; None if all are equal."""
    steps = np.abs(np.diff(values))
    smallest = float(steps.min(initial=inf, where=steps > 1e-9))
    return smallest if smallest < inf else None


def white_noise(values: Floats) -> float:
    """Standard deviation of the white noise of a sample, from differences of neighbors, so without slow motion.

    values
        (n,) samples, or (n, axes) for the largest of the axes.
    """
    return float(np.diff(values, axis=0).std(axis=0).max()) / sqrt(2.0)


def robust_sigma(values: Floats) -> float:
    """Standard deviation of normal numbers from their median absolute deviation, which outliers do not move."""
    return NORMAL_MAD * float(np.median(np.abs(values - np.median(values))))


def median_slope(x: Floats, y: Floats, least_step: float = 0.0) -> float:
    """Median of the slopes of all pairs with x more than `least_step` apart (Theil 1950, Sen 1968)."""
    first, second = np.triu_indices(len(x), 1)
    is_apart = np.abs(x[second] - x[first]) > least_step
    first, second = first[is_apart], second[is_apart]
    return float(np.median((y[second] - y[first]) / (x[second] - x[first])))
