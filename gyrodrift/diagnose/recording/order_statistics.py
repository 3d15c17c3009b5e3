"""Medians and quantiles, and distinct values.

Medians and quantiles are those of numpy and scipy, to the bit, for values without NaN. They take a tenth of the time:
numpy and scipy also look for NaN, or sort every window.
"""

from collections.abc import Sequence

import numpy as np

from gyrodrift.diagnose.recording.smoothing import mirrored
from gyrodrift.io.compile import compiled_once
from gyrodrift.values.arrays import Floats

DECIMALS = 9
"""Decimals to which values of a level are equal. Chosen: parsing and unwrapping add less than a unit of the last."""


def distinct(values: Floats) -> Floats:
    """Distinct finite values, rounded to DECIMALS, rising."""
    return np.unique(np.round(values[np.isfinite(values)], DECIMALS) + 0.0)  # the sum turns -0.0 into 0.0


def median(values: Floats) -> float:
    """Median of all values; NaN without values."""
    if not values.size:
        return float("nan")
    middle = values.size // 2
    ordered = np.partition(values, middle, axis=None)
    if values.size % 2:
        return float(ordered[middle])
    return float(0.5 * (ordered[:middle].max() + ordered[middle]))


def medians(rows: Floats) -> Floats:
    """Medians along the last axis."""
    ordered, count = np.sort(rows, axis=-1), rows.shape[-1]
    middle: Floats = 0.5 * (ordered[..., (count - 1) // 2] + ordered[..., count // 2])
    return middle


def quantiles(values: Floats, shares: float | Sequence[float]) -> Floats:
    """Quantiles along the last axis, by linear interpolation; an axis of several shares comes last."""
    ordered = np.sort(values, axis=-1)
    position = np.asarray(shares, dtype=np.float64) * (values.shape[-1] - 1)
    below = np.floor(position).astype(np.int64)
    part = position - below
    lower, upper = ordered[..., below], ordered[..., np.minimum(below + 1, values.shape[-1] - 1)]
    step = upper - lower
    # From the nearer value, as numpy does.
    between: Floats = np.where(part >= 0.5, upper - step * (1.0 - part), lower + step * part)
    return between


def median_of_five(values: Floats) -> Floats:
    """(n,) running median of five values, mirrored at the ends."""
    medians = np.empty(len(values))
    _median_of_five(mirrored(values, 2, 2), medians)
    return medians


def median_of_nine(values: Floats) -> Floats:
    """(n,) running median of nine values, mirrored at the ends."""
    medians = np.empty(len(values))
    _median_of_nine(mirrored(values, 4, 4), medians)
    return medians


def running_maximum(values: Floats, length: int) -> Floats:
    """(n,) running maximum of `length` values, mirrored at the ends.

    M. van Herk, A fast algorithm for local minimum and maximum filters on rectangular and octagonal kernels (1992).
    """
    before = length // 2
    padded = mirrored(np.asarray(values, dtype=np.float64), before, length - 1 - before)
    largest = np.empty(len(values))
    _running_maximum(padded, length, largest)
    return largest


@compiled_once(inline="always")
def _middle(a: float, b: float, c: float) -> float:
    """Median of three numbers."""
    return max(min(a, b), min(max(a, b), c))


@compiled_once()
def _median_of_five(padded: Floats, medians: Floats) -> None:
    """Write the median of each five successive values: that of the middle one and the inner two of the others."""
    for n in range(len(medians)):
        a, b, c, d, e = padded[n], padded[n + 1], padded[n + 2], padded[n + 3], padded[n + 4]
        medians[n] = _middle(c, max(min(a, b), min(d, e)), min(max(a, b), max(d, e)))


@compiled_once()
def _median_of_nine(padded: Floats, medians: Floats) -> None:
    """Write the median of each nine successive values, from their three sorted triples."""
    for n in range(len(medians)):
        a, b, c = padded[n], padded[n + 1], padded[n + 2]
        d, e, f = padded[n + 3], padded[n + 4], padded[n + 5]
        g, h, i = padded[n + 6], padded[n + 7], padded[n + 8]
        low = max(min(a, b, c), min(d, e, f), min(g, h, i))
        high = min(max(a, b, c), max(d, e, f), max(g, h, i))
        first, second, third = _middle(a, b, c), _middle(d, e, f), _middle(g, h, i)
        medians[n] = _middle(low, _middle(first, second, third), high)


@compiled_once()
def _running_maximum(padded: Floats, length: int, largest: Floats) -> None:
    """Write the maximum of each `length` successive values, from maxima that begin or end at whole blocks."""
    count = len(padded)
    onward = np.empty(count)
    top = -np.inf
    for n in range(count - 1, -1, -1):
        top = padded[n] if n % length == length - 1 else max(padded[n], top)
        onward[n] = top
    top = -np.inf
    for n in range(count):
        top = padded[n] if n % length == 0 else max(top, padded[n])
        if n >= length - 1:
            largest[n - length + 1] = max(onward[n - length + 1], top)
