"""How columns of one turn belong together: copies of a quantity, an angle and its rate, axes of one sensor."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.doctor.turn.motion import ColumnMotion
from gyrodrift.doctor.turn.scale import BESIDE_ANGLE, HAND, QUARTER_DEG, scale_of
from gyrodrift.link.text.behaviour import GRAVITIES

RIVAL = 0.35
"""A column that moves as clearly as this share of the clearest one, in another way, is another axis that turns too."""

COPY = 0.99
"""Correlation of two columns that print the same quantity."""

AS_NOISY = 3.0
"""The noise of a short rest is known to no better: two axes of a sensor have the same."""

AS_ANGLE = 0.98
"""Correlation of an angle with what its rate adds up to."""

NORM = 0.05
"""Relative: how near to gravity, or to 1, the length of three accelerations, or of a quaternion, is at rest."""


def turns_as(rate: ColumnMotion, angle: ColumnMotion) -> bool:
    """Whether the angle is what the rate adds up to, at any scale."""
    if rate.t_s is None or rate.deviation is None or angle.t_s is None or angle.deviation is None:
        return False
    steps = 0.5 * (rate.deviation[1:] + rate.deviation[:-1]) * np.diff(rate.t_s)
    summed = np.concatenate([[0.0], np.cumsum(steps)])
    return abs(_correlation(rate.t_s, summed, angle.t_s, angle.deviation)) > AS_ANGLE


def share(motion: ColumnMotion, clearest: ColumnMotion) -> float:
    """How clearly a column moved beside another: by the noise, or by size where it is nearly the same."""
    if 1.0 / AS_NOISY < motion.noise / clearest.noise < AS_NOISY:
        return motion.clearness * motion.noise / (clearest.clearness * clearest.noise)
    return motion.clearness / clearest.clearness


def is_copy(one: ColumnMotion, other: ColumnMotion) -> bool:
    """Whether both print one quantity: by their labels, or in two units that exist."""
    if one.t_s is None or other.t_s is None or one.deviation is None or other.deviation is None:
        return False
    if abs(_correlation(one.t_s, one.deviation, other.t_s, other.deviation)) < COPY or not other.integral:
        return False
    ratio = abs(one.integral / other.integral)
    if 1.0 / RIVAL > ratio > RIVAL:  # of one size: two axes of a device that is tilted, unless both are called the rate
        return one.series.kind == other.series.kind == "rate" and abs(ratio - 1.0) < BESIDE_ANGLE
    return all(scale_of(each.integral, QUARTER_DEG, HAND) is not None for each in (one, other))


def _correlation(t_s: Floats, values: Floats, other_t_s: Floats, others: Floats) -> float:
    matched = np.interp(t_s, other_t_s, others)
    spreads = float(np.std(values)) * float(np.std(matched))
    return float(np.mean((values - values.mean()) * (matched - matched.mean()))) / spreads if spreads > 0.0 else 0.0


def of_gravity(motions: Sequence[ColumnMotion]) -> list[ColumnMotion]:
    """Three columns beside each other whose length at rest is that of gravity."""
    for three in zip(motions, motions[1:], motions[2:], strict=False):
        length = float(np.linalg.norm([each.level for each in three]))
        if _are_beside(three) and any(abs(length - known) <= NORM * known for known in GRAVITIES):
            return list(three)
    return []


def of_unit_length(motions: Sequence[ColumnMotion]) -> list[ColumnMotion]:
    """Four columns beside each other whose length is 1 before and after the turn: a quaternion."""
    for four in zip(motions, motions[1:], motions[2:], motions[3:], strict=False):
        lengths = [float(np.linalg.norm([each.level + share * each.change for each in four])) for share in (0.0, 1.0)]
        if _are_beside(four) and all(abs(length - 1.0) < NORM for length in lengths):
            return list(four)
    return []


def _are_beside(motions: Sequence[ColumnMotion]) -> bool:
    return all(b.series.key.place == a.series.key.place + 1 or a.series.key.label for a, b in pairwise(motions))
