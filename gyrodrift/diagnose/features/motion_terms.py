"""Terms of the regressors at every sample: rate, angle, temperature, time and history of a motion."""

from collections.abc import Callable
from dataclasses import KW_ONLY, dataclass

import numpy as np

from gyrodrift.diagnose.features.feature import RMS_DPS, Feature, FeatureReading, ResponseLaw
from gyrodrift.diagnose.recording.motion import ReplayedMotion
from gyrodrift.values.arrays import Floats

RADIANS = np.pi / 180.0
"""Radians in a degree. By definition."""

TURN_DPS = 1.0
"""Rate above which the motion has a direction, deg/s. Chosen: between rest and slow motion, `features/regimes.py`."""


@dataclass(frozen=True, slots=True)
class MotionTerms:
    """Terms of a motion, shape (n,). Expensive terms are stored; all further ones are properties.

    speed_dps
        Smoothed rate.
    sine, cosine
        Sine and cosine of the angle.
    direction, since_s
        Last direction of motion, +1 or −1, or 0 before the first motion; and the time since it changed, s.
    """

    motion: ReplayedMotion
    speed_dps: Floats
    sine: Floats
    cosine: Floats
    direction: Floats
    since_s: Floats

    @property
    def rate_dps(self) -> Floats:
        """True rate, deg/s."""
        return self.motion.rate_dps

    @property
    def period_s(self) -> float:
        """Sample period, s."""
        return self.motion.period_s

    @property
    def warm_c(self) -> Floats:
        """Temperature less its mean, °C."""
        warm_c: Floats = self.motion.sensor_c - self.motion.sensor_c.mean()
        return warm_c

    @property
    def powered_s(self) -> Floats:
        """Time since power-on, s."""
        return self._t_s + self.motion.powered_s

    @property
    def share(self) -> Floats:
        """Time as a share of the session, from −0.5 at the first sample to 0.5 at the last."""
        t_s = self._t_s
        share: Floats = t_s / t_s[-1] - 0.5
        return share

    @property
    def _t_s(self) -> Floats:
        return np.arange(len(self.rate_dps), dtype=np.float64) * self.period_s


def motion_terms_of(motion: ReplayedMotion, speed_dps: Floats) -> MotionTerms:
    """Terms of a motion with a smoothed rate."""
    turn = motion.angle_deg * RADIANS
    direction = _last_direction(speed_dps)
    return MotionTerms(
        motion=motion,
        speed_dps=speed_dps,
        sine=np.sin(turn),
        cosine=np.cos(turn),
        direction=direction,
        since_s=_since_change_s(direction, motion.period_s),
    )


def _last_direction(speed_dps: Floats) -> Floats:
    """Sign of the last rate above TURN_DPS, or 0 before the first, shape (n,)."""
    moves = np.abs(speed_dps) > TURN_DPS
    last_moving = np.maximum.accumulate(np.where(moves, np.arange(len(speed_dps)), -1))
    return np.where(last_moving >= 0, np.sign(speed_dps[last_moving]), 0.0)


def _since_change_s(direction: Floats, period_s: float) -> Floats:
    """Time since the direction last changed, s, shape (n,)."""
    changed = np.concatenate([[True], np.diff(direction) != 0.0])
    index = np.arange(len(direction))
    since_s: Floats = (index - np.maximum.accumulate(np.where(changed, index, 0))).astype(np.float64) * period_s
    return since_s


@dataclass(frozen=True, slots=True)
class DesignColumn(Feature):
    """A regressor of the block residuals; the feature's value is its coefficient.

    is_slow
        Whether it resembles a bias that wanders by itself.
    in_catalogue
        Whether an effect of the catalog is proportional to it.
    compute
        Function from the terms of a motion to the regressor at every sample, shape (n,).
    """

    _: KW_ONLY
    reading: FeatureReading = RMS_DPS
    response: ResponseLaw = ResponseLaw.LINEAR
    is_slow: bool = False
    in_catalogue: bool = True
    compute: Callable[[MotionTerms], Floats]
