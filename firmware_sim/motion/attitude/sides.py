"""Board that is laid on each of its six sides, and turned on the table with each axis upright: a calibration."""

from dataclasses import replace
from functools import cached_property
from typing import Annotated, Literal, NamedTuple

import numpy as np
from pydantic import Field

from firmware_sim.effects.effect import Floats
from firmware_sim.motion.attitude.generated import Offset, lever
from firmware_sim.motion.attitude.kinematics import Kinematics, of_jets, quaternion_product
from firmware_sim.motion.attitude.rotations import RAD, X, Y, Z, rotated, yaw_pitch_roll
from firmware_sim.motion.attitude.track import StepTrack
from firmware_sim.yaml_file import Checked


class _Laying(NamedTuple):
    """Pitch and roll of a side, degrees, and whether the board makes turns there."""

    pitch_deg: float
    roll_deg: float
    has_turns: bool


SIDES = (
    _Laying(0.0, 0.0, has_turns=True),
    _Laying(0.0, 90.0, has_turns=True),
    _Laying(0.0, 180.0, has_turns=False),
    _Laying(0.0, 270.0, has_turns=False),
    _Laying(0.0, 360.0, has_turns=False),
    _Laying(-90.0, 360.0, has_turns=True),
    _Laying(90.0, 360.0, has_turns=False),
    _Laying(0.0, 360.0, has_turns=False),
)
"""Up: z, y, −z, −y, z, x, −x, z."""


class Sides(Checked):
    """Board on its sides, z up first.

    rest_s, move_s, turn_s
        Lengths of a rest, of the way to the next side, and of a turn.
    turns
        Whole turns counter-clockwise with x, y and z upright, each followed by the turns back; 0 for none.
    sensor_m
        Position of the sensor from the point about which the board turns, m.
    """

    kind: Literal["sides"]
    rest_s: Annotated[float, Field(gt=0.0, le=1000.0)] = 4.0
    move_s: Annotated[float, Field(gt=0.0, le=1000.0)] = 2.0
    turn_s: Annotated[float, Field(gt=0.0, le=1000.0)] = 6.0
    turns: Annotated[int, Field(ge=0, le=100)] = 1
    sensor_m: Offset = (0.03, 0.02, 0.01)

    @property
    def seconds(self) -> float:
        """Length of a pass, s."""
        return self._plan[1]

    @cached_property
    def _plan(self) -> tuple[tuple[StepTrack, StepTrack, StepTrack], float]:
        """Yaw, pitch and roll, and the length of the pass."""
        yaw, pitch, roll = StepTrack(), StepTrack(), StepTrack()
        now_s = self.rest_s
        for index, side in enumerate(SIDES):
            if index:
                pitch.move_to(side.pitch_deg, now_s, self.move_s)
                roll.move_to(side.roll_deg, now_s, self.move_s)
                now_s += self.move_s + self.rest_s
            for angle_deg in (360.0, 0.0) if side.has_turns and self.turns else ():
                yaw.move_to(angle_deg * self.turns, now_s, self.turn_s)
                now_s += self.turn_s + self.rest_s
        return (yaw, pitch, roll), now_s

    def kinematics_at(self, t_s: Floats) -> Kinematics:
        """True motion at times since the beginning; before 0 the board rests.

        The attitude is the product of three rotations: with z down its heading is still that of the turns.
        """
        within_s = np.mod(np.maximum(t_s, 0.0), self.seconds)
        yaw, pitch, roll = (track.values_at(within_s) for track in self._plan[0])
        rotation = yaw_pitch_roll(yaw, pitch, roll)
        arm = rotated(rotation, lever(self.sensor_m))
        halves = zip((Z, Y, X), (yaw[0], pitch[0], roll[0]), strict=True)
        first, second, third = (_quaternion(axis, angle_deg) for axis, angle_deg in halves)
        attitude = quaternion_product(quaternion_product(first, second), third)
        return replace(of_jets(rotation, arm[1], arm[2], yaw[0]), quaternion=attitude, heading_deg=yaw[0])


def _quaternion(axis: int, angle_deg: Floats) -> Floats:
    """Rotations about an axis (w, x, y, z), shape (n, 4)."""
    quaternion = np.zeros((len(angle_deg), 4))
    quaternion[:, 0] = np.cos(0.5 * RAD * angle_deg)
    quaternion[:, 1 + axis] = np.sin(0.5 * RAD * angle_deg)
    return quaternion
