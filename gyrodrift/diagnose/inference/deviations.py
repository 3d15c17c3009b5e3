"""Which features deviate, before anything is added and after: standard normal deviates pooled over sessions."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.vector import FEATURES

WORST_Z = 20.0
"""No feature counts for more than this: a z of hundreds says no more than one of twenty."""


@dataclass(frozen=True, slots=True)
class Deviation:
    """A feature that deviates; z pooled over all sessions, and its share of all that deviates."""

    stage: str
    feature: str
    regime: str
    says: str
    z: float
    share: float = 0.0


def deviations(z: Floats, threshold: float, least: int = 0) -> tuple[Deviation, ...]:
    """Features whose pooled z, (F,), is beyond a threshold, the worst first; the worst few in any case."""
    order = np.argsort(-np.abs(z)).tolist()
    return listed([number for rank, number in enumerate(order) if abs(z[number]) > threshold or rank < least], z)


def listed(numbers: Sequence[int], z: Floats) -> tuple[Deviation, ...]:
    """Some features in this order, with the share that each has in the squares of all of them."""
    rows = [FEATURES[number] for number in numbers]
    found = [
        Deviation(one.stage, one.name, one.regime, one.says, float(z[number]))
        for number, one in zip(numbers, rows, strict=True)
    ]
    return shared(found)


def shared(every: Sequence[Deviation]) -> tuple[Deviation, ...]:
    """With the share that each has in the squares of all of them."""
    squares = [min(abs(one.z), WORST_Z) ** 2 for one in every]
    total = sum(squares) or 1.0
    return tuple(replace(one, share=square / total) for one, square in zip(every, squares, strict=True))
