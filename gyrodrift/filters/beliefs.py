"""Beliefs of the filters of one axis and of three about parts, rests and turns before they have seen any.

A rest lasts longer than t with probability 1/√(1 + (t/12 s)²), a constant turn with this probability to the power 1.5.
"""

from math import sqrt

PARTS = ((0.25, 0.01), (0.25, 0.1), (0.48, 1.0), (0.02, 8.0))
"""Kinds of parts: their share, and the sigma of their turn-on bias over `turn_on_dps`. The first two subtract their own
bias; the last is raw (data sheet of the MPU-6050: up to 20 deg/s)."""

RAMP_PROBABILITY = 0.3
"""Prior probability that the bias has followed a ramp since the last rest, and not a random walk. Chosen: a prior
learned by hypothesis was no better (docs/blind-alleys.md)."""

MAX_RAMP_S = 20.0
"""Longest ramp of a bias since the last rest, s. Chosen."""

SPINS_PER_DPS = 0.03
"""Probability density of the rates of constant turns, 1/(deg/s). Chosen: uniform up to about 15 deg/s in both
directions."""

LEVEL_S = 12.0
"""Time scale of rests and turns, s: the median rest lasts 20 s, the median turn 15 s. Chosen."""

MAX_HYPOTHESES = 6
"""Largest number of hypotheses after pruning. Each of them can branch into two at a segment. Chosen: eight gained at
most 1 % (docs/blind-alleys.md)."""

TAIL = 0.045
"""Probability that is subtracted from each hypothesis for the variances. Two sigmas should hold in 19 of 20 cases, so
less probable hypotheses do not count. Derived: the share of a normal distribution beyond two sigmas."""

SAME_YAW_DEG = 0.01
"""Difference of two yaws that are the same whatever their variances, deg. In a long rest from the start, yaw has no
variance. Chosen: below the noise of any part over a second."""

MAJORITY = 0.5
"""Probability above which the device counts as at rest, and its bias as known. By definition."""


def drift_var(seconds: float, walk_var: float, ramp_per_s: float, turn_on_var: float) -> float:
    """Variance that a bias has gained over a gap of some seconds, by a random walk or a ramp.

    `walk_var` is the growth of the variance per second, `ramp_per_s` the fastest drift, and `turn_on_var` the most that
    a walk gains, all in one unit.
    """
    ramp = ramp_per_s * min(seconds, MAX_RAMP_S)
    return min(walk_var * seconds, turn_on_var) + RAMP_PROBABILITY * ramp * ramp


def duration_odds(seconds: float) -> float:
    """Odds of a rest against a turn by the time for which they have lasted, s."""
    return sqrt(sqrt(1.0 + seconds * seconds / (LEVEL_S * LEVEL_S)))
