"""Rests of a recording: the encoder count is constant, and the gyro is at its level of nearby rests.

A count is also constant while a motion begins or ends, and during a creeping motion. Therefore the gyro decides. At the
ends of a rest, samples do not count as rest as long as the gyro cannot tell them from a slow motion.
"""

from itertools import pairwise

import numpy as np
from scipy.ndimage import minimum_filter1d, uniform_filter1d

from gyrodrift.diagnose.recording.order_statistics import median, median_of_five
from gyrodrift.facts.arrays import samples_in, true_runs
from gyrodrift.io.compile import compiled_once
from gyrodrift.values.arrays import Floats, Integers, Mask

RESTS_S = 1.0
"""Least time for which the count of a rest is constant, s. Chosen: REST_MEAN_S, over which the gyro is averaged."""

REST_DPS, REST_SIGMAS, REST_MEAN_S, REST_EDGE_S = 0.014, 4.0, 1.0, 0.2
"""Tolerance of the gyro at rest, deg/s, to which so many standard deviations of a mean over REST_MEAN_S are added; and
the window over which all samples must be at rest. Chosen: a creep of more than a hundredth of a degree per second is no
rest."""

OUTLIER_SIGMAS = 10.0
"""Difference from the median of five samples, in standard deviations, at which a sample is an outlier and ends no rest.

It is replaced by this median if it moves the mean over REST_MEAN_S by at least REST_DPS. Chosen: that of an outlier of
the rate.
"""

LEVEL_S, CREEP_DPS, LONGEST_SHARE = 2.0, 0.1, 0.8
"""Least time of a constant count that shows the level of the gyro at rest: so many seconds, and longer than a motion at
this rate takes through a count. Shorter counts are taken if they last this share of the longest. Chosen: a faster
motion leaves its count sooner."""

OPEN_COUNTS = 0.1
"""Turn at the edge of a rest, in counts, that a motion may make before it is noticed. Chosen: it changes no result."""

STANDS_MOST_S = 30.0
"""Longest time for which a count is a single measurement, and shows a single level. Chosen: the bias may wander
meanwhile."""

LEVEL_RUNS = 2
"""Number of runs on either side whose median is the level. Chosen: a median of five ignores two runs that are no
rest."""


def rest_mask(rate_dps: Floats, stands_s: Floats, sigma_dps: float, period_s: float, count_deg: float) -> Mask:
    """(n,) whether a sample is at rest.

    rate_dps
        (n,) rates of the gyro.
    stands_s
        (n,) time for which the count of the sample is constant.
    sigma_dps, count_deg
        White noise of a sample of the gyro, and step of the encoder.
    """
    length = samples_in(REST_MEAN_S, period_s)
    rate_dps = _without_outliers(rate_dps, max(OUTLIER_SIGMAS * sigma_dps, REST_DPS * length))
    slow_dps = uniform_filter1d(rate_dps, length)
    level_dps = _level_dps(slow_dps, stands_s, period_s, count_deg)
    near = np.abs(slow_dps - level_dps) < REST_DPS + REST_SIGMAS * sigma_dps / np.sqrt(length)
    still = (stands_s > RESTS_S) & near
    resting: Mask = minimum_filter1d(still.astype(np.uint8), samples_in(REST_EDGE_S, period_s) | 1) > 0
    least_deg = OPEN_COUNTS * count_deg
    # A motion that accelerates at 0.1 deg/s² needs this time for OPEN_COUNTS.
    slow_start = samples_in(float(np.sqrt(2.0 * least_deg / 0.1)), period_s)
    for first, end in true_runs(resting):
        away_dps = rate_dps[first:end] - median(slow_dps[first:end])
        least = min(slow_start, round(0.1 * (end - first)))  # at most a tenth of a short rest
        begins, ends = (
            max(least, _moving_samples(edge_dps[: samples_in(5.0, period_s)], sigma_dps, least_deg / period_s))
            for edge_dps in (away_dps, away_dps[::-1])
        )
        resting[first : first + begins * (first > 0)] = resting[end - ends * (end < len(resting)) : end] = False
    return resting


def _without_outliers(rate_dps: Floats, least_dps: float) -> Floats:
    """(n,) rates with outliers replaced by the median of five samples. The median follows a step of the rate."""
    near_dps = median_of_five(rate_dps)
    calm_dps: Floats = np.where(np.abs(rate_dps - near_dps) > least_dps, near_dps, rate_dps)
    return calm_dps


def _moving_samples(away_dps: Floats, sigma_dps: float, least_dps: float) -> int:
    """Number of samples from the edge of a rest during which the gyro turns.

    The turn ends where the sum of the rates exceeds its threshold most. The threshold is three standard deviations of
    noise, and at least `least_dps`.
    """
    chance_dps = 3.0 * sigma_dps * np.sqrt(np.arange(1, len(away_dps) + 1))
    over_dps = np.abs(np.cumsum(away_dps)) - np.maximum(chance_dps, least_dps)
    furthest = int(np.argmax(over_dps))
    return furthest + 1 if over_dps[furthest] > 0.0 else 0


def _level_dps(slow_dps: Floats, stands_s: Floats, period_s: float, count_deg: float) -> Floats:
    """(n,) rate of the gyro at rest: medians over long constant counts, interpolated between them.

    slow_dps
        (n,) rates averaged over REST_MEAN_S. A median of single samples would be one of their steps.
    """
    least_s = min(max(LEVEL_S, count_deg / CREEP_DPS), LONGEST_SHARE * float(stands_s.max()))
    pieces = true_runs(stands_s > least_s)
    if not pieces:
        return np.full(len(slow_dps), float(np.median(slow_dps)))
    pieces = _divided(pieces, samples_in(STANDS_MOST_S, period_s))
    middles = np.array([0.5 * (first + end) for first, end in pieces])
    levels = _medians(slow_dps, np.array(pieces))
    wide = np.pad(levels, LEVEL_RUNS, mode="edge")
    medians = np.median([wide[shift : shift + len(levels)] for shift in range(2 * LEVEL_RUNS + 1)], axis=0)
    level: Floats = np.interp(np.arange(len(slow_dps)), middles, medians)
    return level


@compiled_once()
def _medians(values: Floats, pieces: Integers) -> Floats:
    """(p,) median of every piece; `pieces`, (p, 2), are their first and end samples."""
    medians = np.empty(len(pieces))
    for index in range(len(pieces)):
        medians[index] = np.median(values[pieces[index, 0] : pieces[index, 1]])
    return medians


def _divided(pieces: tuple[tuple[int, int], ...], most: int) -> tuple[tuple[int, int], ...]:
    """Pieces divided into equal parts of at most so many samples. A short remainder would not show a level."""
    parts: list[tuple[int, int]] = []
    for first, end in pieces:
        if end - first <= most:
            parts.append((first, end))
            continue
        cuts = np.linspace(first, end, -(-(end - first) // most) + 1).astype(int).tolist()
        parts += pairwise(cuts)
    return tuple(parts)
