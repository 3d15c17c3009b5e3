"""Deviating features: standard normal deviates, pooled over sessions."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.vector import FEATURES

WORST_Z = 20.0
"""Limit of a z in sums: a z of hundreds says no more than a z of twenty."""


@dataclass(frozen=True, slots=True)
class Deviation:
    """A feature that deviates more than others; z is pooled over all sessions.

    share
        Its share of the sum of squares.
    is_beyond_chance
        Whether it deviates by itself, beyond the threshold.
    """

    stage: str
    feature: str
    regime: str
    says: str
    z: float
    share: float = 0.0
    is_beyond_chance: bool = True


def deviations(z: Floats, threshold: float, least: int = 0) -> tuple[Deviation, ...]:
    """Features with a pooled z, (F,), beyond a threshold, the worst first; `least` of them in any case."""
    order = np.argsort(-np.abs(z)).tolist()
    numbers = [number for rank, number in enumerate(order) if abs(z[number]) > threshold or rank < least]
    return listed(numbers, z, threshold)


def listed(numbers: Sequence[int], z: Floats, threshold: float = 0.0) -> tuple[Deviation, ...]:
    """Deviations of some features in this order; see `shared`."""
    return shared([_deviation(number, float(z[number]), threshold) for number in numbers])


def _deviation(number: int, z: float, threshold: float) -> Deviation:
    feature = FEATURES[number]
    return Deviation(feature.stage, feature.name, feature.regime, feature.says, z, is_beyond_chance=abs(z) > threshold)


def shared(every: Sequence[Deviation]) -> tuple[Deviation, ...]:
    """Deviations with their shares of the sum of squares."""
    squares = [min(abs(deviation.z), WORST_Z) ** 2 for deviation in every]
    total = sum(squares) or 1.0
    return tuple(replace(deviation, share=square / total) for deviation, square in zip(every, squares, strict=True))
