"""Small operations on arrays that the parts of a description share."""

from math import inf
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from gyrodrift.arrays import Floats

Flags = NDArray[np.bool_]
Scalar = TypeVar("Scalar", bound=np.generic)


def only(values: Floats, is_kept: Flags) -> Floats:
    """What is kept; the values themselves where that is all of them, since copies are what takes time here."""
    return values if is_kept.all() else values[is_kept]


def blocks_of(values: NDArray[Scalar], size: int) -> NDArray[Scalar]:
    """The values in rows of `size`; what is left over at the end stays out."""
    return values[: len(values) // size * size].reshape(-1, size)


def smallest_step(values: Floats) -> float | None:
    """The smallest change between neighbours that is one; None where all are equal."""
    steps = np.abs(np.diff(values))
    smallest = float(steps.min(initial=inf, where=steps > 1e-9))
    return smallest if smallest < inf else None
