"""The motions of the hard cases: turns with rests, turns without, a constant spin, a drive with slow curves.

`Later` and `LaterInSpace` are motions that begin at another time of a profile.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from firmware_sim.effects.effect import Floats, Rng
from firmware_sim.motion.attitude.kinematics import Kinematics
from firmware_sim.motion.profile import AttitudeProfile, Profile, Segment
from firmware_sim.motion.segments import Drive, Hold, Ramp, Rest

RAMP_S = 1.0

STILL_S = 10.0
"""Rest at the beginning of the version `still`, s."""

BIAS_DPS = 0.5
"""Standard deviation of the power-on bias of low-cost parts after a coarse calibration."""

NOISE_DPS_RTHZ = (0.003, 0.01)
FLOOR_DPH = (4.0, 40.0)
"""Ranges of noise and bias instability in data sheets of low-cost parts."""

SLOWEST_DPS, FASTEST_DPS = 5.0, 180.0

STOP_EVERY = 15
"""Moves between two stops of a motion with few rests: a stop every 1.5 minutes."""

Motions = Callable[[Rng, float], tuple[Segment, ...]]
"""Gives segments of at least so many seconds in all; the first starts from rest."""


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


def either_sign(rng: Rng) -> float:
    """1 or −1 with equal probability."""
    return float(rng.choice([-1.0, 1.0]))


def _speed_dps(rng: Rng) -> float:
    """A log-uniform speed with a random sign, deg/s."""
    return either_sign(rng) * float(np.exp(rng.uniform(np.log(SLOWEST_DPS), np.log(FASTEST_DPS))))


def turns_with_rests(rng: Rng, seconds: float) -> tuple[Segment, ...]:
    """A turntable: turns and rests of some seconds."""
    segments: list[Segment] = []
    while sum(segment.seconds for segment in segments) < seconds:
        segments += [
            Ramp(kind="ramp", seconds=RAMP_S, to_dps=_speed_dps(rng)),
            Hold(kind="hold", seconds=float(rng.uniform(2.0, 6.0))),
            Ramp(kind="ramp", seconds=RAMP_S, to_dps=0.0),
            Rest(kind="rest", seconds=float(rng.uniform(3.0, 6.0))),
        ]
    return tuple(segments)


def turns_without_rests(rng: Rng, seconds: float) -> tuple[Segment, ...]:
    """Changing speeds with rare stops of two seconds."""
    segments: list[Segment] = []
    while sum(segment.seconds for segment in segments) < seconds:
        for _ in range(STOP_EVERY):
            segments += [
                Ramp(kind="ramp", seconds=RAMP_S, to_dps=_speed_dps(rng)),
                Hold(kind="hold", seconds=float(rng.uniform(2.0, 8.0))),
            ]
        segments += [Ramp(kind="ramp", seconds=RAMP_S, to_dps=0.0), Rest(kind="rest", seconds=2.0)]
    return tuple(segments)


def spin(rate_dps: float) -> Motions:
    """A constant speed in a random direction."""

    def motion(rng: Rng, seconds: float) -> tuple[Segment, ...]:
        to_dps = either_sign(rng) * rate_dps
        return (Ramp(kind="ramp", seconds=RAMP_S, to_dps=to_dps), Hold(kind="hold", seconds=seconds))

    return motion


def slow_curves(rng: Rng, seconds: float) -> tuple[Segment, ...]:
    """A vehicle whose curves last half a minute, with few stops."""
    minutes, seed = seconds / 60.0 + 1.0, int(rng.integers(2**31))
    return (Drive(kind="drive", minutes=minutes, rms_dps=4.0, curve_seconds=30.0, rest_share=0.03, seed=seed),)
