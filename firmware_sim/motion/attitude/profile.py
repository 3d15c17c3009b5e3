"""Motion profile with an attitude: a motion in space, how the sensor is mounted, and the air temperature."""

from functools import cached_property
from typing import Annotated

import numpy as np
from pydantic import Field, model_validator

from firmware_sim.effects.effect import Floats
from firmware_sim.effects.environment import sensor_temperature_c
from firmware_sim.motion.attitude.arm import Arm
from firmware_sim.motion.attitude.boat import Boat
from firmware_sim.motion.attitude.drone import Drone
from firmware_sim.motion.attitude.hand import Hand
from firmware_sim.motion.attitude.kinematics import Kinematics
from firmware_sim.motion.attitude.limb import Limb
from firmware_sim.motion.attitude.ramps import Ramps
from firmware_sim.motion.attitude.rotations import quaternions, yaw_pitch_roll
from firmware_sim.motion.attitude.sides import Sides
from firmware_sim.motion.attitude.table import LeaningTable
from firmware_sim.motion.turntable import Ambient, ambient_c_at, check_times
from firmware_sim.yaml_file import Checked

AnyAttitude = Annotated[LeaningTable | Ramps | Boat | Hand | Limb | Arm | Drone | Sides, Field(discriminator="kind")]
Angle = Annotated[float, Field(ge=-180.0, le=180.0)]

YAW_AXIS = 2
"""Axis of a gyro with one axis: z of the sensor."""


class SensorMount(Checked):
    """Attitude of the sensor on its device: turned by yaw, then pitch about its new y, then roll about its new x, deg.

    A mount that turns the z axis below the horizon works, but the heading of such a sensor has no simple meaning.
    """

    yaw_deg: Angle = 0.0
    pitch_deg: Angle = 0.0
    roll_deg: Angle = 0.0

    def quaternion(self) -> Floats:
        """Rotation from sensor to device (w, x, y, z), shape (4,)."""
        yaw, pitch, roll = (
            np.array([[value], [0.0], [0.0]]) for value in (self.yaw_deg, self.pitch_deg, self.roll_deg)
        )
        rotation: Floats = quaternions(yaw_pitch_roll(yaw, pitch, roll)[0])[0]
        return rotation


class AttitudeProfile(Checked):
    """Motion in space, with the air temperature.

    about
        Description.
    motion
        Motion, by its kind.
    mount
        Attitude of the sensor on its device; flat by default.
    powered_s
        Time since power-on at the beginning, s: 0 is a cold start.
    ambient
        Air temperature; 25 °C by default.
    """

    about: str
    motion: AnyAttitude
    mount: SensorMount = SensorMount()
    powered_s: Annotated[float, Field(ge=0.0, le=1e6)] = 0.0
    ambient: Annotated[tuple[Ambient, ...], Field(min_length=1, strict=False)] = (Ambient(at_s=0.0, temp_c=25.0),)

    @model_validator(mode="after")
    def _times_rise(self) -> "AttitudeProfile":
        check_times(self.ambient)
        return self

    @property
    def seconds(self) -> float:
        """Length of one pass, s."""
        return self.motion.seconds

    @cached_property
    def _mount(self) -> Floats | None:
        return None if self.mount == SensorMount() else self.mount.quaternion()

    @cached_property
    def _latest(self) -> list[tuple[Floats, Kinematics]]:
        """The last times, and the motion at them."""
        return []

    def kinematics_at(self, t_s: Floats) -> Kinematics:
        """True motion of the sensor at times since the beginning, shape (n,); the array must not change later."""
        # Rates, truth and acceleration of a block need the motion at the same times.
        if not (self._latest and self._latest[0][0] is t_s):
            motion = self.motion.kinematics_at(t_s)
            self._latest[:] = [(t_s, motion if self._mount is None else motion.mounted(self._mount))]
        return self._latest[0][1]

    def motion_at(self, t_s: Floats) -> tuple[Floats, Floats]:
        """True heading, degrees, and rate about the z axis of the sensor, deg/s, in the shape of `t_s`."""
        motion = self.kinematics_at(t_s)
        return motion.heading_deg, motion.rates_dps[:, YAW_AXIS]

    def sensor_c_at(self, t_s: Floats) -> Floats:
        """Temperature of the sensor at `t_s`, °C, in its shape."""
        within_s = np.mod(np.maximum(t_s, 0.0), self.seconds)
        return sensor_temperature_c(ambient_c_at(self.ambient, within_s), np.maximum(t_s, 0.0) + self.powered_s)
