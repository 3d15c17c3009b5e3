"""Where a bias jumps: change points of what is left of the rate error, by binary segmentation."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from gyrodrift.diagnose.recording import Integers, Mask
from gyrodrift.session.session import Floats

LEAST_SECONDS = 10
CLEAR = 6.0
"""Standard errors by which the means on both sides of a jump differ; chance reaches 4 in a long session."""

JUMPS_MOST = 30
LEAST_DPS = 2e-3
"""Smaller jumps are nobody's trouble."""

AT_ONCE, AT_ONCE_CLEAR = 0.6, 4.0
"""Of a jump at least this share, and so many standard errors, are seen within LEAST_SECONDS before and after it; what
takes longer is a drift."""

HELD = 4.0


class Jump(NamedTuple):
    """The second from which on the level is another one, and by how much, deg/s."""

    second: int
    step_dps: float


def jumps_of(left_dps: Floats, is_even: Mask) -> tuple[Jump, ...]:
    """Of what is left in the seconds that rest or turn evenly; shape (seconds,) each."""
    seconds = np.flatnonzero(is_even)
    if len(seconds) < 2 * LEAST_SECONDS:
        return ()
    level_dps = left_dps[seconds] - np.median(left_dps[seconds])
    spread_dps = 1.4826 * float(np.median(np.abs(np.diff(level_dps)))) / np.sqrt(2.0) + 1e-9
    smooth_dps = _without_wild(level_dps, HELD * spread_dps)
    edges = [0, *sorted(_splits(smooth_dps, spread_dps)), len(seconds)]
    means = [float(smooth_dps[start:end].mean()) for start, end in pairwise(edges)]
    steps = [Jump(edge, step) for edge, step in zip(edges[1:-1], np.diff(means).tolist(), strict=True)]
    return tuple(
        Jump(int(seconds[at]), step) for at, step in steps if _is_jump(seconds, smooth_dps, at, step, spread_dps)
    )


def _is_jump(seconds: Integers, level_dps: Floats, at: int, step_dps: float, spread_dps: float) -> bool:
    near = np.abs(seconds - seconds[at]) <= LEAST_SECONDS
    before, after = level_dps[:at][near[:at]], level_dps[at:][near[at:]]
    if abs(step_dps) < LEAST_DPS or not len(before):
        return False
    at_once_dps = float(np.median(after) - np.median(before))
    error_dps = spread_dps * np.sqrt(1.0 / len(before) + 1.0 / len(after))
    return at_once_dps / step_dps > AT_ONCE and abs(at_once_dps) > AT_ONCE_CLEAR * error_dps


def _without_wild(values: Floats, most: float) -> Floats:
    """Held near the median of their neighbours."""
    padded = np.pad(values, 2, mode="edge")
    around = np.median([padded[shift : shift + len(values)] for shift in range(5)], axis=0)
    held: Floats = around + np.clip(values - around, -most, most)
    return held


def _splits(values: Floats, spread: float) -> list[int]:
    """The clearest split first, then those of its parts, until none is clear or there are too many."""
    found: list[int] = []
    parts = [(0, len(values))]
    while parts and len(found) <= JUMPS_MOST:
        best = max((_split(values[start:end], spread, start) for start, end in parts), key=lambda split: split[1])
        if best[1] < CLEAR:
            break
        found.append(best[0])
        edges = [0, *sorted(found), len(values)]
        parts = list(pairwise(edges))
    return found


def _split(values: Floats, spread: float, start: int) -> tuple[int, float]:
    """Where two levels say most, and by how many standard errors they differ."""
    count = len(values)
    if count < 2 * LEAST_SECONDS:
        return start, 0.0
    before = np.arange(LEAST_SECONDS, count - LEAST_SECONDS + 1)
    sums = np.cumsum(values - values.mean())[before - 1]
    errors = np.abs(sums) / (spread * np.sqrt(before * (count - before) / count))
    best = int(np.argmax(errors))
    return start + int(before[best]), float(errors[best])
