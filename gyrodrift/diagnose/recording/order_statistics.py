"""Medians and quantiles of numbers without NaN, to the last bit those of numpy and scipy, in less time.

A diagnosis takes some ten thousand of them; numpy's own look for NaN, and partition once more for it.
"""

from collections.abc import Sequence

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.compile import compiled_once

MEDIAN_TO_SIGMA = 0.6745
"""Median of the absolute values of normal numbers, in standard deviations."""


def median(values: Floats) -> float:
    """As `np.median`; shape (n,), n at least 1."""
    middle = len(values) // 2
    parted = np.partition(values, middle)
    upper = float(parted[middle])
    return upper if len(values) % 2 else (float(parted[:middle].max()) + upper) / 2.0


def row_medians(rows: Floats) -> Floats:
    """As `np.median` along the second axis; shape (rows,)."""
    count = rows.shape[1]
    middle = count // 2
    parted = np.partition(rows, middle, axis=1)
    upper: Floats = parted[:, middle]
    return upper if count % 2 else (parted[:, :middle].max(axis=1) + upper) / 2.0


def row_quantiles(rows: Floats, share: float) -> Floats:
    """As `np.quantile` along the second axis, with straight lines between neighbours; shape (rows,)."""
    place = (rows.shape[1] - 1) * share
    below = int(place)
    if below == rows.shape[1] - 1:
        top: Floats = rows.max(axis=1)
        return top
    parted = np.partition(rows, below + 1, axis=1)
    low, high = parted[:, : below + 1].max(axis=1), parted[:, below + 1]
    part = place - below
    found: Floats = low + (high - low) * part if part < 0.5 else high - (high - low) * (1.0 - part)
    return found


def quantiles(values: Floats, shares: Sequence[float]) -> tuple[float, ...]:
    """As `np.quantile`, with straight lines between neighbours; values of shape (n,), n at least 1."""
    row = np.sort(values)
    place = (len(row) - 1) * np.asarray(shares)
    below = np.minimum(place.astype(np.int64), max(len(row) - 2, 0))
    low, high, part = row[below], row[np.minimum(below + 1, len(row) - 1)], place - below
    # The nearer of the two is gone out from.
    found = np.where(part < 0.5, low + (high - low) * part, high - (high - low) * (1.0 - part))
    return tuple(found.tolist())


def different(values: Floats) -> int:
    """How many different values there are."""
    row = np.sort(values)
    return int(np.count_nonzero(row[1:] != row[:-1])) + 1 if len(row) else 0


def running_median_5(values: Floats) -> Floats:
    """As `scipy.ndimage.median_filter` over 5 samples, mirrored at the ends; shape (n,)."""
    medians = np.empty(len(values))
    _medians_5(np.pad(values, 2, mode="symmetric"), medians)
    return medians


def running_median_9(values: Floats) -> Floats:
    """As `scipy.ndimage.median_filter` over 9 samples, mirrored at the ends; shape (n,)."""
    medians = np.empty(len(values))
    _medians_9(np.pad(values, 4, mode="symmetric"), medians)
    return medians


@compiled_once()
def _medians_5(padded: Floats, medians: Floats) -> None:
    """Of four, the lowest and the highest are not the median of five."""
    for n in range(len(medians)):
        a, b, c, d, e = padded[n], padded[n + 1], padded[n + 2], padded[n + 3], padded[n + 4]
        low, high = max(min(a, b), min(d, e)), min(max(a, b), max(d, e))
        below, above = min(low, c), max(low, c)
        medians[n] = max(below, min(above, high))


@compiled_once()
def _medians_9(padded: Floats, medians: Floats) -> None:
    """Of three sorted triples it is the median of the highest low, the median middle and the lowest high."""
    count = len(padded) - 2
    lows, middles, highs = np.empty(count), np.empty(count), np.empty(count)
    for n in range(count):
        a, b, c = padded[n], padded[n + 1], padded[n + 2]
        below, above = min(a, b), max(a, b)
        lows[n], middles[n], highs[n] = min(below, c), max(below, min(above, c)), max(above, c)
    for n in range(len(medians)):
        highest_low = max(lows[n], lows[n + 3], lows[n + 6])
        lowest_high = min(highs[n], highs[n + 3], highs[n + 6])
        a, b, c = middles[n], middles[n + 3], middles[n + 6]
        middle = max(min(a, b), min(max(a, b), c))
        below, above = min(highest_low, middle), max(highest_low, middle)
        medians[n] = max(below, min(above, lowest_high))
