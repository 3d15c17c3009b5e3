"""Motions that begin at another time of a profile."""

from dataclasses import dataclass

import numpy as np

from firmware_sim.effects.effect import Floats
from firmware_sim.motion.attitude.kinematics import Kinematics
from firmware_sim.motion.profile import AttitudeProfile, Profile


@dataclass(frozen=True, slots=True)
class Later:
    """A profile from `start_s` on, with a device that is switched on at that moment."""

    profile: Profile
    start_s: float

    @property
    def powered_s(self) -> float:
        """Time since power-on at the start, s."""
        return self.profile.powered_s

    def motion_at(self, t_s: Floats) -> tuple[Floats, Floats]:
        """Angle in deg, 0 at the start, and rate in deg/s."""
        angle_deg, rate_dps = self.profile.motion_at(t_s + self.start_s)
        return angle_deg - self.profile.motion_at(np.array([self.start_s]))[0], rate_dps

    def sensor_c_at(self, t_s: Floats) -> Floats:
        """Temperature of the sensor, °C."""
        return self.profile.sensor_c_at(t_s)


@dataclass(frozen=True, slots=True)
class LaterInSpace:
    """An attitude profile from `start_s` on; a negative one adds a rest before it."""

    profile: AttitudeProfile
    start_s: float

    @property
    def powered_s(self) -> float:
        """Time since power-on at the start, s."""
        return self.profile.powered_s

    def kinematics_at(self, t_s: Floats) -> Kinematics:
        """True motion of the sensor; its heading is 0 at the start."""
        motion = self.profile.kinematics_at(t_s + self.start_s)
        start_deg = self.profile.kinematics_at(np.array([self.start_s])).heading_deg
        return motion.with_yaw(np.repeat(-start_deg, len(t_s)))

    def motion_at(self, t_s: Floats) -> tuple[Floats, Floats]:
        """Heading in deg, 0 at the start, and rate about the z axis of the sensor in deg/s."""
        motion = self.kinematics_at(t_s)
        return motion.heading_deg, motion.rates_dps[:, 2]

    def sensor_c_at(self, t_s: Floats) -> Floats:
        """Temperature of the sensor, °C."""
        return self.profile.sensor_c_at(t_s)
