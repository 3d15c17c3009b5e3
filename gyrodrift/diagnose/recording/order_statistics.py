"""Medians and quantiles of numbers without NaN, to the last bit those of numpy and scipy, in less time.

A diagnosis takes some ten thousand of them; numpy's own look for NaN, and partition once more for it.
"""

import numpy as np

from gyrodrift.arrays import Floats


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


def running_median_5(values: Floats) -> Floats:
    """As `scipy.ndimage.median_filter` over 5 samples, mirrored at the ends; shape (n,)."""
    padded = np.pad(values, 2, mode="symmetric")
    count = len(values)
    a, b, c, d, e = (padded[first : first + count] for first in range(5))
    low, high = np.minimum(a, b), np.maximum(a, b)
    other_low, other_high = np.minimum(d, e), np.maximum(d, e)
    # Of four, the lowest and the highest are not the median of five.
    return _median_3(np.maximum(low, other_low), c, np.minimum(high, other_high))


def running_median_9(values: Floats) -> Floats:
    """As `scipy.ndimage.median_filter` over 9 samples, mirrored at the ends; shape (n,).

    Of three sorted triples it is the median of the highest low, the median middle and the lowest high.
    """
    padded = np.pad(values, 4, mode="symmetric")
    a, b, c = padded[:-2], padded[1:-1], padded[2:]
    below, above = np.minimum(a, b), np.maximum(a, b)
    low, high = np.minimum(below, c), np.maximum(above, c)
    middle = np.maximum(below, np.minimum(above, c))
    highest_low = np.maximum(np.maximum(low[:-6], low[3:-3]), low[6:])
    lowest_high = np.minimum(np.minimum(high[:-6], high[3:-3]), high[6:])
    return _median_3(highest_low, _median_3(middle[:-6], middle[3:-3], middle[6:]), lowest_high)


def _median_3(a: Floats, b: Floats, c: Floats) -> Floats:
    below, above = np.minimum(a, b), np.maximum(a, b)
    middle: Floats = np.maximum(below, np.minimum(above, c))
    return middle
