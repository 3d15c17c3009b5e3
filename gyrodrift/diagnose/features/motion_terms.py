"""What the regressors of a design are made of: rate, angle, temperature, time and history of a motion, by sample."""

from dataclasses import dataclass

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.within_second import smoothed
from gyrodrift.diagnose.recording.motion import ReplayedMotion

TURN_DPS = 1.0
"""A direction is one that was gone in faster than this."""


@dataclass(frozen=True, slots=True)
class MotionTerms:
    """Terms of a motion, shape (n,) each.

    speed_dps
        The rate, smoothed.
    warm_c
        Temperature about its mean.
    powered_s, share
        Time since power-on, s; and time from −0.5 at the first sample to 0.5 at the last.
    turn
        The angle, radians.
    direction, since_s
        +1 or −1 as it last went, 0 before it first did; and how long it has been so, s.
    acceleration_dpss, sharp_dpss
        Of the smoothed rate, and of a rate that is smoothed less, deg/s/s.
    """

    motion: ReplayedMotion
    speed_dps: Floats
    warm_c: Floats
    powered_s: Floats
    share: Floats
    turn: Floats
    direction: Floats
    since_s: Floats
    acceleration_dpss: Floats
    sharp_dpss: Floats

    @property
    def rate_dps(self) -> Floats:
        """True rate, deg/s."""
        return self.motion.rate_dps

    @property
    def period_s(self) -> float:
        """Distance of two samples, s."""
        return self.motion.period_s


def motion_terms_of(motion: ReplayedMotion, speed_dps: Floats) -> MotionTerms:
    """The terms of a motion, whose smoothed rate is `speed_dps`."""
    period_s = motion.period_s
    t_s: Floats = np.arange(len(motion.rate_dps), dtype=np.float64) * period_s
    direction = _last_direction(speed_dps)
    return MotionTerms(
        motion=motion,
        speed_dps=speed_dps,
        warm_c=motion.sensor_c - motion.sensor_c.mean(),
        powered_s=t_s + motion.powered_s,
        share=t_s / t_s[-1] - 0.5,
        turn=np.deg2rad(motion.angle_deg),
        direction=direction,
        since_s=_since_change_s(direction, period_s),
        acceleration_dpss=np.gradient(speed_dps, period_s),
        sharp_dpss=np.gradient(smoothed(motion.rate_dps, period_s), period_s),
    )


def _last_direction(speed_dps: Floats) -> Floats:
    goes = np.abs(speed_dps) > TURN_DPS
    place = np.maximum.accumulate(np.where(goes, np.arange(len(speed_dps)), -1))
    return np.where(place >= 0, np.sign(speed_dps[place]), 0.0)


def _since_change_s(direction: Floats, period_s: float) -> Floats:
    changed = np.concatenate([[True], np.diff(direction) != 0.0])
    place = np.arange(len(direction))
    since_s: Floats = (place - np.maximum.accumulate(np.where(changed, place, 0))).astype(np.float64) * period_s
    return since_s
