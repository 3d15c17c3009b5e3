"""Mounting of the sensor: an axis of the gyro that is not parallel to the axis of the turn."""

from math import cos, radians, sin
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from firmware_sim.effects.effect import Act, Effect, EffectSlot, Floats, Rng
from firmware_sim.effects.triaxial.effect import Sensed, TriaxialAct


class Misalignment(Effect):
    """The sensor is tilted on its table, about a level axis: the rate reads cos(tilt) of the turn.

    Typical: 1 to 10° (a board fixed by hand). `about_deg` is the direction of that axis in the sensor, from x to y.
    A rig with three axes turns gyro and accelerometer together: x and y of the gyro read sin(tilt) of the turn, and
    gravity leans by the tilt.
    """

    name: Literal["misalignment"] = "misalignment"
    tilt_deg: Annotated[float, Field(ge=0.0, le=80.0)]
    about_deg: Annotated[float, Field(ge=-360.0, le=360.0)] = 0.0
    stage: ClassVar[str] = "sensor"
    slot: ClassVar[EffectSlot] = EffectSlot.ANALOG
    typical: ClassVar[dict[str, float]] = {"tilt_deg": 10.0, "about_deg": 0.0}
    small: ClassVar[dict[str, float]] = {"tilt_deg": 4.0, "about_deg": 0.0}

    def begin(self, rng: Rng, sample_rate_hz: float) -> Act:
        """Gain of the only axis."""
        gain = cos(radians(self.tilt_deg))
        return lambda rate, _: rate * gain

    def begin_triaxial(self, rng: Rng) -> TriaxialAct:
        """Rotation of rates and force."""
        matrix = self.matrix().T
        return lambda sensed, _: Sensed(sensed.rates_dps @ matrix, sensed.force_mps2 @ matrix)

    def matrix(self) -> Floats:
        """Values along the axes of the sensor for a vector in the frame of the table, shape (3, 3)."""
        tilt, about = radians(self.tilt_deg), radians(self.about_deg)
        along, across, lean, kept = cos(about), sin(about), sin(tilt), cos(tilt)
        rest = 1.0 - kept  # Rodrigues, about the level axis (along, across, 0)
        return np.array(
            [
                [kept + rest * along**2, rest * along * across, -lean * across],
                [rest * along * across, kept + rest * across**2, lean * along],
                [lean * across, -lean * along, kept],
            ]
        )
