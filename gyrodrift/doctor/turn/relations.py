"""Relations between the columns of a turn: copies of a quantity, an angle and its rate, axes of a sensor."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from gyrodrift.doctor.turn.motion import ColumnMotion
from gyrodrift.doctor.turn.scale import ANGLE_TOLERANCE, HAND, QUARTER_DEG, scale_of
from gyrodrift.link.text.behavior import GRAVITIES
from gyrodrift.values.arrays import Floats

SIMILAR_SHARE = 0.35
"""Share of the clearest motion from which another column is a further axis that turns, too."""

COPY = 0.99
"""Correlation of two columns that print the same quantity."""

AS_NOISY = 3.0
"""Largest ratio of noises that count as equal: two axes of a sensor, measured in a short rest."""

AS_ANGLE = 0.98
"""Correlation of an angle with the integral of its rate."""

NORM = 0.05
"""Largest relative error of the length of three accelerations (gravity) or of a quaternion (1) at rest."""


def turns_as(rate: ColumnMotion, angle: ColumnMotion) -> bool:
    """Whether the angle is proportional to the integral of the rate."""
    if rate.t_s is None or rate.deviation is None or angle.t_s is None or angle.deviation is None:
        return False
    steps = 0.5 * (rate.deviation[1:] + rate.deviation[:-1]) * np.diff(rate.t_s)
    summed = np.concatenate([[0.0], np.cumsum(steps)])
    return abs(_correlation(rate.t_s, summed, angle.t_s, angle.deviation)) > AS_ANGLE


def share(motion: ColumnMotion, clearest: ColumnMotion) -> float:
    """Clearness of a motion relative to the clearest one; with equal noise, the ratio of their sizes."""
    if 1.0 / AS_NOISY < motion.noise / clearest.noise < AS_NOISY:
        return motion.clearness * motion.noise / (clearest.clearness * clearest.noise)
    return motion.clearness / clearest.clearness


def is_copy(first: ColumnMotion, second: ColumnMotion) -> bool:
    """Whether both columns print the same quantity: by their labels, or in two units that exist."""
    if first.t_s is None or second.t_s is None or first.deviation is None or second.deviation is None:
        return False
    if abs(_correlation(first.t_s, first.deviation, second.t_s, second.deviation)) < COPY or not second.integral:
        return False
    ratio = abs(first.integral / second.integral)
    if 1.0 / SIMILAR_SHARE > ratio > SIMILAR_SHARE:  # two axes of a tilted device, unless both labels say rate
        return first.series.kind == second.series.kind == "rate" and abs(ratio - 1.0) < ANGLE_TOLERANCE
    return all(scale_of(motion.integral, QUARTER_DEG, HAND) is not None for motion in (first, second))


def _correlation(t_s: Floats, values: Floats, second_t_s: Floats, second: Floats) -> float:
    matched = np.interp(t_s, second_t_s, second)
    spreads = float(np.std(values)) * float(np.std(matched))
    return float(np.mean((values - values.mean()) * (matched - matched.mean()))) / spreads if spreads > 0.0 else 0.0


def of_gravity(motions: Sequence[ColumnMotion]) -> list[ColumnMotion]:
    """Three adjacent columns whose length at rest is gravity; empty without."""
    for three in zip(motions, motions[1:], motions[2:], strict=False):
        length = float(np.linalg.norm([motion.level for motion in three]))
        if _are_adjacent(three) and any(abs(length - gravity) <= NORM * gravity for gravity in GRAVITIES):
            return list(three)
    return []


def of_unit_length(motions: Sequence[ColumnMotion]) -> list[ColumnMotion]:
    """Four adjacent columns whose length is 1 before and after the turn (a quaternion); empty without."""
    for four in zip(motions, motions[1:], motions[2:], motions[3:], strict=False):
        lengths = [
            float(np.linalg.norm([motion.level + share * motion.change for motion in four])) for share in (0.0, 1.0)
        ]
        if _are_adjacent(four) and all(abs(length - 1.0) < NORM for length in lengths):
            return list(four)
    return []


def _are_adjacent(motions: Sequence[ColumnMotion]) -> bool:
    return all(b.series.key.index == a.series.key.index + 1 or a.series.key.label for a, b in pairwise(motions))
