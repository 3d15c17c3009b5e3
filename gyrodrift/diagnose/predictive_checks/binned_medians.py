"""The shape of a cloud of points: medians of bins, and how much of its height follows it."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.recording.order_statistics import MAD_TO_SIGMA

LEAST = 5
"""Points in a bin; with fewer its median is chance."""

SHARE = 1.0 / 24.0
"""A bin with more than twice this share of all points is halved, down to FINEST of the range."""

FINEST = 1.0 / 64.0


class Medians(NamedTuple):
    """Shape (bins,) each; error is the standard error of a median."""

    x: Floats
    y: Floats
    error: Floats


def bins_of(x: Floats) -> list[slice]:
    """Of sorted values: narrow where there are many, wide where there are few, and none with fewer than LEAST."""
    if not len(x):
        return []
    low, high = float(x[0]), float(x[-1])
    enough = 2.0 * max(float(LEAST), SHARE * len(x))
    edges = [0, *_halved(x, low, high, enough, FINEST * (high - low)), len(x)]
    return [slice(start, end) for start, end in pairwise(edges) if end - start >= LEAST]


def _halved(x: Floats, low: float, high: float, enough: float, finest: float) -> list[int]:
    """Where bins within a range begin, but for the first."""
    start, end = np.searchsorted(x, [low, high])
    middle = 0.5 * (low + high)
    is_between = low < middle < high  # neighbouring floats have no middle
    if end - start < enough or high - low <= finest or not is_between:
        return []
    edge = int(np.searchsorted(x, middle))
    return [*_halved(x, low, middle, enough, finest), edge, *_halved(x, middle, high, enough, finest)]


def medians(x: Floats, y: Floats) -> Medians:
    """Of a cloud in the order of x."""
    rows = []
    for one in bins_of(x):
        middle = float(np.median(y[one]))
        spread = MAD_TO_SIGMA * float(np.median(np.abs(y[one] - middle)))
        # Standard error of a median over that of a mean.
        rows.append((float(np.median(x[one])), middle, 1.2533 * spread / np.sqrt(one.stop - one.start)))
    return Medians(*np.array(rows).reshape(-1, 3).T)


def shape_dps(x: Floats, y: Floats) -> float:
    """RMS of the part of y that follows x, beyond what as many bins of chance would show."""
    bins = bins_of(x)
    if len(bins) < 2:
        return 0.0
    middle = float(np.median(y))
    most = 6.0 * MAD_TO_SIGMA * float(np.median(np.abs(y - middle)))  # outliers are held at six standard deviations
    held = np.clip(y, middle - most, middle + most) if most > 0.0 else y
    counts = np.array([one.stop - one.start for one in bins])
    levels = np.array([held[one].mean() for one in bins])
    inside = float(sum(np.square(held[one] - held[one].mean()).sum() for one in bins)) / max(
        1, counts.sum() - len(bins)
    )
    between = float(counts @ np.square(levels - counts @ levels / counts.sum())) / counts.sum()
    return float(np.sqrt(max(0.0, between - inside * (len(bins) - 1) / counts.sum())))
