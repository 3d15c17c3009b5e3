"""Change points of the bias: steps in the unexplained rate error, by binary segmentation."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from gyrodrift.values.arrays import Floats, Integers, Mask
from gyrodrift.values.constants import NORMAL_MAD

LEAST_SECONDS = 10
"""Least distance of two change points, and length of the windows before and after a change point."""

CLEAR = 6.0
"""Least difference of the means on both sides of a split, in standard errors; chance reaches 4 in a long session."""

LEAST_DPS = 2e-3
"""Least step, deg/s. Smaller steps are negligible: it is the relevance threshold of a bias that depends on angle or
direction, `features/columns.py`."""

SUDDEN_SHARE, SUDDEN_CLEAR = 0.6, 5.0
"""Least share of the height of a change point that occurs within its two windows, beyond the drift, and its least size
in standard errors. A change that takes longer is a drift."""

OUTLIER_SIGMAS = 4.0
"""Standard deviations from the median of the neighbors beyond which a second is an outlier."""


class ChangePoint(NamedTuple):
    """The first second of a new level, and the step to it, deg/s."""

    second: int
    step_dps: float


def change_points_of(unexplained_dps: Floats, is_even: Mask) -> tuple[ChangePoint, ...]:
    """Change points of the unexplained rate error, from the seconds that rest or turn evenly.

    unexplained_dps, is_even
        (seconds,) unexplained rate error, and whether the device rests or turns evenly.
    """
    seconds = np.flatnonzero(is_even)
    if len(seconds) < 2 * LEAST_SECONDS:
        return ()
    level_dps = unexplained_dps[seconds]
    spread_dps = NORMAL_MAD * float(np.median(np.abs(np.diff(level_dps)))) / np.sqrt(2.0) + 1e-9
    level_dps = _without_outliers(level_dps, OUTLIER_SIGMAS * spread_dps)
    edges = [0, *sorted(_splits(level_dps, spread_dps)), len(seconds)]
    means = [float(level_dps[start:end].mean()) for start, end in pairwise(edges)]
    change_points = []
    for index, height_dps in zip(edges[1:-1], np.diff(means).tolist(), strict=True):
        step_dps, drift_dps = _sudden_step(seconds, level_dps, index)
        # The step beyond the drift has weights 3/2, 3/2, 1/2 and 1/2 of means of LEAST_SECONDS / 2 seconds.
        least_dps = max(SUDDEN_CLEAR * np.sqrt(10.0 / LEAST_SECONDS) * spread_dps, LEAST_DPS)
        beyond_dps = step_dps - drift_dps
        if beyond_dps / height_dps > SUDDEN_SHARE and abs(beyond_dps) > least_dps:
            change_points.append(ChangePoint(int(seconds[index]), step_dps))
    return tuple(change_points)


def _sudden_step(seconds: Integers, level_dps: Floats, index: int) -> tuple[float, float]:
    """Step at a split and the part of it that drift makes, deg/s; 0 and 0 next to an end or a gap.

    The step is the difference of the half windows next to the split. The drift is the mean change from half window to
    half window before and after it.
    """
    near = range(index - LEAST_SECONDS, index + LEAST_SECONDS)
    if near.start < 0 or near.stop > len(seconds) or seconds[near.stop - 1] - seconds[near.start] > 3 * LEAST_SECONDS:
        return 0.0, 0.0
    quarters = level_dps[near.start : near.stop].reshape(4, -1).mean(axis=1)
    drift_dps = (quarters[1] - quarters[0] + quarters[3] - quarters[2]) / 2.0
    return float(quarters[2] - quarters[1]), float(drift_dps)


def _without_outliers(values: Floats, most: float) -> Floats:
    """Values clipped to a distance from the median of five neighbors."""
    padded = np.pad(values, 2, mode="edge")
    around = np.median([padded[shift : shift + len(values)] for shift in range(5)], axis=0)
    clipped: Floats = around + np.clip(values - around, -most, most)
    return clipped


def _splits(values: Floats, spread: float) -> list[int]:
    """Indices of clear splits: the clearest first, then those of its parts, at most 30."""
    splits: list[int] = []
    parts = [(0, len(values))]
    while len(splits) < 30:
        best = max((_split(values[start:end], spread, start) for start, end in parts), key=lambda split: split[1])
        if best[1] < CLEAR:
            break
        splits.append(best[0])
        parts = list(pairwise([0, *sorted(splits), len(values)]))
    return splits


def _split(values: Floats, spread: float, start: int) -> tuple[int, float]:
    """Index of the clearest split of a part, and the difference of the means on its sides in standard errors.

    start
        Index of the first value of the part.
    """
    count = len(values)
    if count < LEAST_SECONDS:
        return start, 0.0
    before = np.arange(LEAST_SECONDS // 2, count - LEAST_SECONDS // 2 + 1)
    sums = np.cumsum(values - values.mean())[before - 1]
    errors = np.abs(sums) / (spread * np.sqrt(before * (count - before) / count))
    best = int(np.argmax(errors))
    return start + int(before[best]), float(errors[best])
