"""Turntable whose axis may lean, with the sensor at some distance from the axis."""

from functools import cached_property
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from firmware_sim.effects.effect import Floats
from firmware_sim.motion.attitude.kinematics import Kinematics, of_jets
from firmware_sim.motion.attitude.rotations import Y, Z, about, chained, rotated
from firmware_sim.motion.turntable import Profile, Segment
from firmware_sim.yaml_file import Checked

HALF_STEP_S = 1e-4
"""Half step of the difference of rates: exact for straight lines, 1e-7 of a sine of 1 Hz."""


class LeaningTable(Checked):
    """Turntable with an attitude.

    segments
        Turns, as in a profile without an attitude.
    lean_deg
        Angle between the axis of the table and the vertical.
    radius_m
        Distance of the sensor from the axis, along its x axis.
    """

    kind: Literal["table"]
    segments: Annotated[tuple[Segment, ...], Field(min_length=1, strict=False)]
    lean_deg: Annotated[float, Field(ge=0.0, le=80.0)] = 0.0
    radius_m: Annotated[float, Field(ge=0.0, le=10.0)] = 0.0

    @cached_property
    def _turns(self) -> Profile:
        return Profile(about="turns of a table", segments=self.segments)

    @property
    def seconds(self) -> float:
        """Length of a pass, s."""
        return self._turns.seconds

    def kinematics_at(self, t_s: Floats) -> Kinematics:
        """True motion at times since the beginning; before 0 the table rests."""
        angle_deg, rate_dps = self._turns.motion_at(t_s)
        before, after = (self._turns.motion_at(t_s + step_s)[1] for step_s in (-HALF_STEP_S, HALF_STEP_S))
        turn = np.stack([angle_deg, rate_dps, (after - before) / (2.0 * HALF_STEP_S)])
        lean = np.zeros_like(turn)
        lean[0] = self.lean_deg
        rotation = chained(about(Y, lean), about(Z, turn))
        position = rotated(rotation, np.array([self.radius_m, 0.0, 0.0]))
        return of_jets(rotation, position[1], position[2], angle_deg)
