"""Base of effects on all axes of a sensor at once: rates and specific force as vectors.

They belong to the block `three_axes` of a rig. Effects of the other catalogue act on each gyro axis by itself.
"""

from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum
from typing import Annotated, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from firmware_sim.effects.effect import Effect, Floats, Rng

Percent = Annotated[float, Field(ge=-20.0, le=20.0)]
SmallAngle = Annotated[float, Field(ge=-20.0, le=20.0)]


class TriaxialSlot(IntEnum):
    """Slot of an effect.

    - MOTION: true rates and force as the sensor feels them, before noise, on the fine grid
    - OUTPUT: sampled rates and force with noise, before rounding to counts
    """

    MOTION = 0
    OUTPUT = 1


class Sensed(NamedTuple):
    """Rates, deg/s, and specific force, m/s², in the sensor frame; both have the shape (n, 3)."""

    rates_dps: Floats
    force_mps2: Floats


@dataclass(frozen=True, slots=True)
class TriaxialMoments:
    """Times of a block, s, whether the sensor is at rest, and the step of the times, s; arrays of shape (n,)."""

    t_s: Floats
    is_still: NDArray[np.bool_]
    step_s: float


TriaxialAct = Callable[[Sensed, TriaxialMoments], Sensed]


class TriaxialEffect(Effect):
    """Base of effects on vectors."""

    stage: ClassVar[str] = "sensor"
    triaxial_slot: ClassVar[TriaxialSlot] = TriaxialSlot.MOTION
    small: ClassVar[dict[str, float]] = {}

    def begin_triaxial(self, rng: Rng) -> TriaxialAct:
        """Act of this effect for a session."""
        raise TypeError(f"{type(self).__name__} does not define begin_triaxial")
