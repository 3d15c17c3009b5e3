"""Sides on which a board lies: the axis that points up."""

from collections.abc import Iterable
from typing import Literal, NamedTuple, get_args

import numpy as np

from gyrodrift.values.arrays import Floats

AXES = "xyz"
Side = Literal["+x", "-x", "+y", "-y", "+z", "-z"]
SIDES: tuple[Side, ...] = get_args(Side)

TILT_MAX_DEG = 30.0
"""Largest angle between the axis of a side and the vertical, deg: halfway to the next side is 45°. Chosen."""


class SideUp(NamedTuple):
    """Side, and the angle between its axis and the measured acceleration, deg."""

    side: Side
    tilt_deg: float

    @property
    def axis(self) -> int:
        """Index of the axis."""
        return AXES.index(self.side[1])


def side_up(accel_mps2: Floats) -> SideUp:
    """Side whose axis is nearest to an acceleration at rest, shape (3,)."""
    axis = int(np.abs(accel_mps2).argmax())
    share = abs(float(accel_mps2[axis])) / float(np.linalg.norm(accel_mps2))
    side = SIDES[2 * axis + (1 if accel_mps2[axis] < 0.0 else 0)]
    return SideUp(side, float(np.rad2deg(np.arccos(min(1.0, share)))))


def missing_sides(measured: Iterable[Side]) -> list[Side]:
    """Sides that are not among the measured ones."""
    present = set(measured)
    return [side for side in SIDES if side not in present]
