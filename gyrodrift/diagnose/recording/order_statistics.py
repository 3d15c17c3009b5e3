"""Medians and quantiles of numbers without NaN, to the last bit those of numpy and scipy, in less time.

A diagnosis takes some ten thousand of them; numpy's own look for NaN, and partition once more for it.
"""

from collections.abc import Sequence
from typing import TypeVar

import numpy as np

from gyrodrift.arrays import Floats, Integers
from gyrodrift.compile import compiled_once

FloatOrFloats = TypeVar("FloatOrFloats", float, Floats)

MEDIAN_TO_SIGMA = 0.6745
"""Median of the absolute values of normal numbers, in standard deviations."""

MAD_TO_SIGMA = 1.4826
"""The standard deviation of normal numbers over their median absolute deviation."""

BINS, FEW = 1024, 32
"""Into so many even bins values are counted, until no more than FEW are left to be sorted."""

SPREADS_BITS = -7046029254386353131
"""Whose products differ in their highest bits: 2⁶⁴ over the golden ratio, as a signed number (D. E. Knuth, The art of
computer programming 3, 6.4)."""


def median(values: Floats) -> float:
    """As `np.median`; shape (n,), n at least 1."""
    below, middle = _neighbours_at(values, len(values) // 2)
    return middle if len(values) % 2 else (below + middle) / 2.0


def row_medians(rows: Floats) -> Floats:
    """As `np.median` along the second axis; shape (rows,)."""
    return np.array([median(row) for row in rows])


def quantile(values: Floats, share: float) -> float:
    """As `np.quantile`, with straight lines between neighbours; shape (n,), n at least 1."""
    place = (len(values) - 1) * share
    below = int(place)
    if below == len(values) - 1:
        return float(values.max())
    return float(_between(*_neighbours_at(values, below + 1), place - below))


def row_quantiles(rows: Floats, share: float) -> Floats:
    """The same along the second axis, of rows of a hundred or so; shape (rows,)."""
    place = (rows.shape[1] - 1) * share
    below = int(place)
    if below == rows.shape[1] - 1:
        top: Floats = rows.max(axis=1)
        return top
    parted = np.partition(rows, below + 1, axis=1)
    return np.asarray(_between(parted[:, : below + 1].max(axis=1), parted[:, below + 1], place - below))


def quantiles(values: Floats, shares: Sequence[float]) -> tuple[float, ...]:
    """As `np.quantile`, with straight lines between neighbours; values of shape (n,), n at least 1."""
    row = np.sort(values)
    place = (len(row) - 1) * np.asarray(shares)
    below = np.minimum(place.astype(np.int64), max(len(row) - 2, 0))
    low, high, part = row[below], row[np.minimum(below + 1, len(row) - 1)], place - below
    return tuple(_between(*each) for each in zip(low.tolist(), high.tolist(), part.tolist(), strict=True))


def different(values: Floats) -> int:
    """How many different values there are."""
    row = np.sort(values)
    return int(np.count_nonzero(row[1:] != row[:-1])) + 1 if len(row) else 0


def distinct(values: Floats, decimals: int) -> Floats:
    """As `np.unique` of the finite values, rounded to so many decimals; shape (n,).

    Samples of a sensor take few values: these are looked up, and only they are sorted.
    """
    rounded = np.round(values, decimals) + 0.0  # of the two zeros, the one
    found = rounded[_first_of_each(rounded, rounded.view(np.int64), (2 * len(rounded)).bit_length())]
    found.sort()
    return found


def _between(low: FloatOrFloats, high: FloatOrFloats, part: float) -> FloatOrFloats:
    """The nearer of the two is gone out from."""
    return low + (high - low) * part if part < 0.5 else high - (high - low) * (1.0 - part)


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
def _sorted_few(values: Floats) -> Floats:
    """By insertion, for numbers that are few or equal: numpy's own sort takes seconds to compile."""
    few = np.empty(len(values))
    for n in range(len(values)):
        slot = n
        while slot > 0 and few[slot - 1] > values[n]:
            few[slot] = few[slot - 1]
            slot -= 1
        few[slot] = values[n]
    return few


@compiled_once()
def _neighbours_at(values: Floats, place: int) -> tuple[float, float]:
    """The values that would be before a place and at it, were all in order; -inf before the first.

    They are counted into even bins, and what shares a bin with the place is looked at again, until few are left.
    """
    kept, rank, below = values, place, -np.inf
    while len(kept) > FEW:
        least, most = kept[0], kept[0]
        for n in range(len(kept)):
            least, most = min(least, kept[n]), max(most, kept[n])
        scale = (BINS - 1) / (most - least)
        if not np.isfinite(scale):  # they are equal, or as good as
            break
        bins, at = np.zeros(BINS, np.int64), np.empty(len(kept), np.int16)
        for n in range(len(kept)):
            at[n] = int((kept[n] - least) * scale)
            bins[at[n]] += 1
        chosen = 0
        while rank >= bins[chosen]:
            rank -= bins[chosen]
            chosen += 1
        if rank == 0 and chosen > 0:
            below = -np.inf
            for n in range(len(kept)):
                below = max(below, kept[n] if at[n] < chosen else -np.inf)
        inside, count = np.empty(bins[chosen] + 1), 0
        for n in range(len(kept)):
            inside[count] = kept[n]
            count += at[n] == chosen
        kept = inside[:count]
    few = _sorted_few(kept)
    return few[rank - 1] if rank > 0 else below, few[rank]


@compiled_once()
def _first_of_each(values: Floats, bits: Integers, power: int) -> Integers:
    """Places of the finite values that no earlier one equals, by a hash table of this power of two."""
    places, last = np.full(1 << power, -1), (1 << power) - 1
    found, count = np.empty(len(values), np.int64), 0
    for n in range(len(values)):
        if not np.isfinite(values[n]) or (n > 0 and bits[n] == bits[n - 1]):
            continue
        slot = (bits[n] * SPREADS_BITS >> 64 - power) & last
        while places[slot] >= 0 and bits[places[slot]] != bits[n]:
            slot = (slot + 1) & last
        if places[slot] < 0:
            places[slot] = n
            found[count] = n
            count += 1
    return found[:count]


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
