"""A source of turn rates: a sensor with a scale of its own, or two wheels with an unknown track.

A mean over a second is compared with the gyro. While the device goes nearly straight, the difference is a bias of the
gyro; in a turn it only shows the scale of the source, because slips last as long as a turn.
"""

from dataclasses import dataclass, field
from math import hypot, inf, isnan, nan, sqrt
from typing import Any

from gyrodrift.filters.aids.errors import OwnErrors
from gyrodrift.filters.aids.heading import EVERY_S, LATE_S
from gyrodrift.filters.aids.motion import RecentMotion
from gyrodrift.filters.aids.reading import WRONG_SHARE, AidedFilter, AidReading
from gyrodrift.filters.aids.trust import Trust
from gyrodrift.values.aid import Aid

RATE_DPS = 0.5
"""Standard deviation of the mean turn rate of a source that states none, deg/s. Chosen: wheels over a second."""

SCALE_SIGMA, RATIO_SIGMA, RATIO_WALK = 0.05, 0.001, 0.00002
"""Standard deviations of the scale of a turn rate and of the ratio of two wheels, as shares, and random walk of both,
1/√s. Chosen: tracks of robots under a motion capture were 2.5 % off, and their ratios moved by 0.1 %."""

TRACK_DPS = 150.0
"""Standard deviation of the turn rate for a difference of 1 between two wheels of unknown track, deg/s. Derived: in m/s
180/(π·0.13 m) is within three of them; in other units it is less, and the first turn shows it."""

SLIP = 0.05
"""Standard deviation of a turn rate that changes from turn to turn, as a share. Chosen: as for the scale."""

TURNING_DPS = 5.0
"""Rate from which on the device turns, deg/s. Chosen: a wrong scale or sign shows in turns alone."""

SIGN_SIGMAS = 3.0
"""Distance of a scale from 0, in standard deviations, that shows its sign. Chosen."""

BACKWARDS = "it turns the other way: left and right are swapped"


@dataclass(slots=True)
class RateSource:
    """A source of turn rates with the errors of its scale and ratio; the sums of the present second."""

    is_wheels: bool
    trust: Trust = field(default_factory=Trust)
    errors: OwnErrors = field(init=False)
    t_s: float = -inf
    from_s: float = -inf
    value: float = nan
    speed: float = nan
    difference: float = 0.0
    distance: float = 0.0

    def __post_init__(self) -> None:
        self.forget()

    def forget(self) -> None:
        """Forget scale and ratio, which were learned from the filter."""
        scale_sigma = TRACK_DPS if self.is_wheels else SCALE_SIGMA
        cov = [[scale_sigma * scale_sigma, 0.0], [0.0, RATIO_SIGMA * RATIO_SIGMA]]
        self.errors = OwnErrors([0.0, 0.0], cov)

    def measure(self, aided: AidedFilter, c: Any, s: Any, aid: Aid, motion: RecentMotion) -> None:
        """Add a rate to the mean of its second, and compare the mean with the gyro at its end."""
        step_s, before = aid.t_s - self.t_s, self.value
        self._add(aid)
        length_s = self.t_s - self.from_s
        if length_s < EVERY_S:
            return
        rate, speed, from_s = self.difference / length_s, self.distance / length_s, self.from_s
        self.from_s, self.difference, self.distance = self.t_s, 0.0, 0.0
        if from_s < max(motion.broken_s, motion.from_s):
            return
        measured_dps, m = motion.angle_deg(from_s, aid.t_s) / length_s, aided.moments(s)
        errors, scale, scale_sigma = self.errors, 1.0, 0.0
        if self.is_wheels:
            scale, scale_sigma = errors.mean[0], sqrt(errors.cov[0][0])
        errors.wander(length_s, RATIO_WALK * RATIO_WALK)
        sigma = aid.sigma * scale if aid.sigma > 0.0 else RATE_DPS
        late_dps = LATE_S * scale * (aid.value - before) / step_s
        variance = sigma * sigma + (SLIP * scale * rate) ** 2 + late_dps * late_dps
        shape = (rate, hypot(scale, scale_sigma) * speed if self.is_wheels else 0.0)
        own_dps = shape[0] * errors.mean[0] + shape[1] * errors.mean[1] + (0.0 if self.is_wheels else rate)
        reading = AidReading(
            is_heading=False, value=measured_dps - own_dps, variance=variance, own_var=errors.own_var(shape)
        )
        beyond_dps = abs(measured_dps - m.bias_dps) - SIGN_SIGMAS * sqrt(m.bias_var)
        is_known = scale > 2.0 * scale_sigma
        is_turning = is_known and max(abs(scale * rate), beyond_dps) > TURNING_DPS
        if self.is_wheels and scale < -SIGN_SIGMAS * scale_sigma:
            self.trust.leave_out(BACKWARDS)
        elif self.trust.judge(reading, m, counts=is_turning):
            is_straight = is_known and abs(scale * rate) < TURNING_DPS
            right = aided.take(c, s, reading) if is_straight else 1.0 - WRONG_SHARE / reading.odds(m)
            errors.update(shape, reading, m, right)

    def _add(self, aid: Aid) -> None:
        """Add to the integrals of this second by trapezoids; a pause begins another one."""
        speed, seconds = 0.0 if isnan(aid.speed) else aid.speed, aid.t_s - self.t_s
        if 0.0 < seconds <= EVERY_S:
            self.difference += 0.5 * (self.value + aid.value) * seconds
            self.distance += 0.5 * (self.speed + speed) * seconds
        else:
            self.from_s, self.difference, self.distance = aid.t_s, 0.0, 0.0
        self.t_s, self.value, self.speed = aid.t_s, aid.value, speed
