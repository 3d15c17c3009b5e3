"""Where a recording rests: the count stands, and the gyro is at its level of other rests near by.

A count stands, too, while a motion begins or ends, and while it creeps through one: what the gyro says decides, and at
the ends of a rest the motion is left open as far as no gyro tells it from rest.
"""

from itertools import pairwise

import numpy as np
from scipy.ndimage import median_filter, minimum_filter1d, uniform_filter1d

from gyrodrift.arrays import Floats, Integers, Mask
from gyrodrift.compile import compiled_once

RESTS_S = 1.0
"""A count that stands so long, while the gyro says no more than REST_DPS, is a rest."""

REST_DPS, REST_SIGMAS, REST_MEAN_S, REST_EDGE_S = 0.014, 4.0, 1.0, 0.2
WILD_SIGMAS = 10.0
"""A sample this far off the median of the five about it is no motion, and ends no rest; where it moves the mean over
REST_MEAN_S by REST_DPS and more, that median stands in its place."""

LEVEL_S, CREEP_DPS, LONGEST_SHARE = 2.0, 0.1, 0.8
"""Counts that stand so long, and longer than it takes to creep through one at this rate, show the gyro's level at rest;
where none does, those that stand for this share of the longest."""

OPEN_COUNTS = 0.1
"""Of a count: a motion that turned less than this before it was noticed bends nothing."""

STANDS_MOST_S = 30.0
"""A count that stands longer is measured again, and shows another level: a bias may wander meanwhile."""

LEVEL_RUNS = 2
"""Of such runs on either side whose median is the level."""


def rests(rate_dps: Floats, stands_s: Floats, sigma_dps: float, period_s: float, count_deg: float) -> Mask:
    """Shape (n,): which samples rest.

    rate_dps, stands_s
        What the gyro says, and how long the count of each sample stands.
    sigma_dps, count_deg
        White noise of a sample of the gyro, step of the encoder.
    """
    points = points_of(REST_MEAN_S, period_s)
    rate_dps = _without_wild(rate_dps, max(WILD_SIGMAS * sigma_dps, REST_DPS * points))
    slow_dps = uniform_filter1d(rate_dps, points)
    level_dps = _level_dps(slow_dps, stands_s, period_s, count_deg)
    near = np.abs(slow_dps - level_dps) < REST_DPS + REST_SIGMAS * sigma_dps / np.sqrt(points)
    still = (stands_s > RESTS_S) & near
    resting: Mask = minimum_filter1d(still.astype(np.uint8), points_of(REST_EDGE_S, period_s) | 1) > 0
    least_deg = OPEN_COUNTS * count_deg
    # A motion that begins so gently is left open for as long as it needs for OPEN_COUNTS.
    gentle = points_of(float(np.sqrt(2.0 * least_deg / 0.1)), period_s)
    for first, end in stretches(resting):
        away_dps = rate_dps[first:end] - np.median(slow_dps[first:end])
        least = min(gentle, round(0.1 * (end - first)))  # no more than a tenth of a short rest
        begins, ends = (
            max(least, _slide(one[: points_of(5.0, period_s)], sigma_dps, least_deg / period_s))
            for one in (away_dps, away_dps[::-1])
        )
        resting[first : first + begins * (first > 0)] = resting[end - ends * (end < len(resting)) : end] = False
    return resting


def _without_wild(rate_dps: Floats, least_dps: float) -> Floats:
    """A step from one rate to another is none of them: the median follows it."""
    near_dps = median_filter(rate_dps, 5)
    calm_dps: Floats = np.where(np.abs(rate_dps - near_dps) > least_dps, near_dps, rate_dps)
    return calm_dps


def _slide(away_dps: Floats, sigma_dps: float, least_dps: float) -> int:
    """So many samples from the edge of a rest on, the gyro turns: where its sum is furthest beyond chance."""
    # Beyond chance by three standard deviations.
    chance_dps = 3.0 * sigma_dps * np.sqrt(np.arange(1, len(away_dps) + 1))
    over_dps = np.abs(np.cumsum(away_dps)) - np.maximum(chance_dps, least_dps)
    furthest = int(np.argmax(over_dps))
    return furthest + 1 if over_dps[furthest] > 0.0 else 0


def _level_dps(slow_dps: Floats, stands_s: Floats, period_s: float, count_deg: float) -> Floats:
    """What the gyro says at rest, at each sample: medians over counts that stand long, and between them.

    slow_dps
        Means: a median of single samples would be one of the steps that they come in.
    """
    least_s = min(max(LEVEL_S, count_deg / CREEP_DPS), LONGEST_SHARE * float(stands_s.max()))
    pieces = stretches(stands_s > least_s)
    if not pieces:
        return np.full(len(slow_dps), float(np.median(slow_dps)))
    pieces = _divided(pieces, points_of(STANDS_MOST_S, period_s))
    middles = np.array([0.5 * (first + end) for first, end in pieces])
    levels = _medians(slow_dps, np.array(pieces))
    wide = np.pad(levels, LEVEL_RUNS, mode="edge")
    held = np.median([wide[shift : shift + len(levels)] for shift in range(2 * LEVEL_RUNS + 1)], axis=0)
    level: Floats = np.interp(np.arange(len(slow_dps)), middles, held)
    return level


@compiled_once()
def _medians(values: Floats, pieces: Integers) -> Floats:
    """(p,) median of each piece; `pieces` holds first sample and the one after the last, (p, 2)."""
    medians = np.empty(len(pieces))
    for index in range(len(pieces)):
        medians[index] = np.median(values[pieces[index, 0] : pieces[index, 1]])
    return medians


def _divided(pieces: tuple[tuple[int, int], ...], most: int) -> tuple[tuple[int, int], ...]:
    """Each in equal parts of so many samples at most: what is left over would be too short for a level."""
    found: list[tuple[int, int]] = []
    for first, end in pieces:
        if end - first <= most:
            found.append((first, end))
            continue
        cuts = np.linspace(first, end, -(-(end - first) // most) + 1).astype(int).tolist()
        found += pairwise(cuts)
    return tuple(found)


def stretches(inside: Mask) -> tuple[tuple[int, int], ...]:
    """First sample, and the one after the last, of each stretch."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], inside.astype(np.int8), [0]])))
    return tuple(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))


def points_of(seconds: float, period_s: float) -> int:
    """So many samples, one at least."""
    return max(1, round(seconds / period_s))
