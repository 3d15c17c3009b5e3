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
    """A deviating feature; z is pooled over all sessions, share is that of the sum of squares."""

    stage: str
    feature: str
    regime: str
    says: str
    z: float
    share: float = 0.0


def deviations(z: Floats, threshold: float, least: int = 0) -> tuple[Deviation, ...]:
    """Features with a pooled z, (F,), beyond a threshold, the worst first; `least` of them in any case."""
    order = np.argsort(-np.abs(z)).tolist()
    return listed([number for rank, number in enumerate(order) if abs(z[number]) > threshold or rank < least], z)


def listed(numbers: Sequence[int], z: Floats) -> tuple[Deviation, ...]:
    """Deviations of some features in this order; see `shared`."""
    rows = [FEATURES[number] for number in numbers]
    rows_found = [
        Deviation(feature.stage, feature.name, feature.regime, feature.says, float(z[number]))
        for number, feature in zip(numbers, rows, strict=True)
    ]
    return shared(rows_found)


def shared(every: Sequence[Deviation]) -> tuple[Deviation, ...]:
    """Deviations with their shares of the sum of squares."""
    squares = [min(abs(deviation.z), WORST_Z) ** 2 for deviation in every]
    total = sum(squares) or 1.0
    return tuple(replace(deviation, share=square / total) for deviation, square in zip(every, squares, strict=True))
