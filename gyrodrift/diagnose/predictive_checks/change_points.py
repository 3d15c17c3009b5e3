"""Change points of the bias: steps of what is unexplained of the rate error, by binary segmentation."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from gyrodrift.arrays import Floats, Integers, Mask
from gyrodrift.diagnose.recording.order_statistics import MAD_TO_SIGMA

LEAST_SECONDS = 10
"""Between two change points, and on both sides of one."""

CLEAR = 6.0
"""Standard errors by which the means on both sides of a split differ; chance reaches 4 in a long session."""

LEAST_DPS = 2e-3
"""Smaller ones are practically negligible: what is relevant of a bias that depends on angle or direction,
`features/columns.py`."""

AT_ONCE, AT_ONCE_CLEAR = 0.6, 5.0
"""A change point has this share of its height, and so many standard errors, within LEAST_SECONDS before and after it,
beyond what the drift there makes; what takes longer is a drift."""

HELD = 4.0
"""Standard deviations from the median of its neighbours beyond which a second is an outlier."""


class ChangePoint(NamedTuple):
    """The second from which on the level is another one, and by how much, deg/s."""

    second: int
    step_dps: float


def change_points_of(left_dps: Floats, is_even: Mask) -> tuple[ChangePoint, ...]:
    """Of what is left in the seconds that rest or turn evenly; shape (seconds,) each."""
    seconds = np.flatnonzero(is_even)
    if len(seconds) < 2 * LEAST_SECONDS:
        return ()
    level_dps = left_dps[seconds]
    spread_dps = MAD_TO_SIGMA * float(np.median(np.abs(np.diff(level_dps)))) / np.sqrt(2.0) + 1e-9
    level_dps = _without_outliers(level_dps, HELD * spread_dps)
    edges = [0, *sorted(_splits(level_dps, spread_dps)), len(seconds)]
    means = [float(level_dps[start:end].mean()) for start, end in pairwise(edges)]
    found = []
    for at, height_dps in zip(edges[1:-1], np.diff(means).tolist(), strict=True):
        step_dps, drift_dps = _at_once(seconds, level_dps, at)
        least_dps = max(AT_ONCE_CLEAR * np.sqrt(10.0 / LEAST_SECONDS) * spread_dps, LEAST_DPS)
        beyond_dps = step_dps - drift_dps
        if beyond_dps / height_dps > AT_ONCE and abs(beyond_dps) > least_dps:
            found.append(ChangePoint(int(seconds[at]), step_dps))
    return tuple(found)


def _at_once(seconds: Integers, level_dps: Floats, at: int) -> tuple[float, float]:
    """Height of a step between the seconds next to it, and what the drift on both sides makes of that; 0 in a gap."""
    near = range(at - LEAST_SECONDS, at + LEAST_SECONDS)
    if near.start < 0 or near.stop > len(seconds) or seconds[near.stop - 1] - seconds[near.start] > 3 * LEAST_SECONDS:
        return 0.0, 0.0
    quarters = level_dps[near.start : near.stop].reshape(4, -1).mean(axis=1)
    drift_dps = (quarters[1] - quarters[0] + quarters[3] - quarters[2]) / 2.0
    return float(quarters[2] - quarters[1]), float(drift_dps)


def _without_outliers(values: Floats, most: float) -> Floats:
    """Held near the median of their neighbours."""
    padded = np.pad(values, 2, mode="edge")
    around = np.median([padded[shift : shift + len(values)] for shift in range(5)], axis=0)
    held: Floats = around + np.clip(values - around, -most, most)
    return held


def _splits(values: Floats, spread: float) -> list[int]:
    """The clearest split first, then those of its parts, until none is clear or there are too many."""
    found: list[int] = []
    parts = [(0, len(values))]
    while len(found) < 30:
        best = max((_split(values[start:end], spread, start) for start, end in parts), key=lambda split: split[1])
        if best[1] < CLEAR:
            break
        found.append(best[0])
        parts = list(pairwise([0, *sorted(found), len(values)]))
    return found


def _split(values: Floats, spread: float, start: int) -> tuple[int, float]:
    """Where two levels say most, and by how many standard errors they differ."""
    count = len(values)
    if count < LEAST_SECONDS:
        return start, 0.0
    before = np.arange(LEAST_SECONDS // 2, count - LEAST_SECONDS // 2 + 1)
    sums = np.cumsum(values - values.mean())[before - 1]
    errors = np.abs(sums) / (spread * np.sqrt(before * (count - before) / count))
    best = int(np.argmax(errors))
    return start + int(before[best]), float(errors[best])
