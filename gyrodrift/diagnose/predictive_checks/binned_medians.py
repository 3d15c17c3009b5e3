"""Trend of scattered points: medians in bins of x, and the RMS of the part of y that follows x."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from gyrodrift.values.arrays import Floats
from gyrodrift.values.constants import NORMAL_MAD

LEAST = 5
"""Least points in a bin. Chosen: the median of fewer is chance."""

SHARE = 1.0 / 24.0
"""Share of all points; a bin with more than twice this share is halved. Chosen: enough bins to show a curve."""

FINEST = 1.0 / 64.0
"""Smallest width of a bin as a share of the range of x. Chosen: about the width of a dot in a chart."""


class Medians(NamedTuple):
    """(bins,) medians of x and of y, and the standard error of the median of y."""

    x: Floats
    y: Floats
    error: Floats


def bins_of(x: Floats) -> list[slice]:
    """Bins of sorted values: narrow where values are dense. Bins with fewer than LEAST values are left out."""
    if not len(x):
        return []
    low, high = float(x[0]), float(x[-1])
    enough = 2.0 * max(float(LEAST), SHARE * len(x))
    edges = [0, *_halved(x, low, high, enough, FINEST * (high - low)), len(x)]
    return [slice(start, end) for start, end in pairwise(edges) if end - start >= LEAST]


def _halved(x: Floats, low: float, high: float, enough: float, finest: float) -> list[int]:
    """Indices at which the bins of a range begin, without the first bin."""
    start, end = np.searchsorted(x, [low, high])
    middle = 0.5 * (low + high)
    is_between = low < middle < high  # neighboring floats have no middle
    if end - start < enough or high - low <= finest or not is_between:
        return []
    edge = int(np.searchsorted(x, middle))
    return [*_halved(x, low, middle, enough, finest), edge, *_halved(x, middle, high, enough, finest)]


def medians(x: Floats, y: Floats) -> Medians:
    """Medians in bins of x; x is sorted."""
    rows = []
    for part in bins_of(x):
        middle = float(np.median(y[part]))
        spread = NORMAL_MAD * float(np.median(np.abs(y[part] - middle)))
        # The standard error of a median of normal values is √(π/2) = 1.2533 times that of their mean.
        rows.append((float(np.median(x[part])), middle, 1.2533 * spread / np.sqrt(part.stop - part.start)))
    return Medians(*np.array(rows).reshape(-1, 3).T)


def trend_rms_dps(x: Floats, y: Floats) -> float:
    """RMS of the part of y that follows x, deg/s, without the part that chance adds to means in bins; x is sorted."""
    bins = bins_of(x)
    if len(bins) < 2:
        return 0.0
    middle = float(np.median(y))
    most = 6.0 * NORMAL_MAD * float(np.median(np.abs(y - middle)))
    clipped = np.clip(y, middle - most, middle + most) if most > 0.0 else y  # at six standard deviations
    counts = np.array([part.stop - part.start for part in bins])
    levels = np.array([clipped[part].mean() for part in bins])
    inside = float(sum(np.square(clipped[part] - clipped[part].mean()).sum() for part in bins)) / max(
        1, counts.sum() - len(bins)
    )
    between = float(counts @ np.square(levels - counts @ levels / counts.sum())) / counts.sum()
    return float(np.sqrt(max(0.0, between - inside * (len(bins) - 1) / counts.sum())))
