"""Array operations that several parts of a description use."""

from math import inf
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from gyrodrift.values.arrays import Floats

Flags = NDArray[np.bool_]
Scalar = TypeVar("Scalar", bound=np.generic)


def only(values: Floats, is_kept: Flags) -> Floats:
    """Select values; without a copy if all are kept, because copies take most of the time here."""
    return values if is_kept.all() else values[is_kept]


def blocks_of(values: NDArray[Scalar], size: int) -> NDArray[Scalar]:
    """Arrange the values in rows of `size`; an incomplete last row is dropped."""
    return values[: len(values) // size * size].reshape(-1, size)


def smallest_step(values: Floats) -> float | None:
    """Smallest change between neighbors above 1e-9; None if all are equal."""
    steps = np.abs(np.diff(values))
    smallest = float(steps.min(initial=inf, where=steps > 1e-9))
    return smallest if smallest < inf else None
