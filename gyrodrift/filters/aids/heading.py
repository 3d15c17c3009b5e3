"""A source of headings, whose zero may be another than that of yaw."""

from dataclasses import dataclass, field
from math import atan2, degrees, hypot, inf, isnan, sqrt
from typing import Any

from gyrodrift.filters.aids.errors import OwnErrors, ScaleError
from gyrodrift.filters.aids.motion import RecentMotion
from gyrodrift.filters.aids.reading import AidedFilter, AidMoments, AidReading
from gyrodrift.filters.aids.trust import Trust
from gyrodrift.values.aid import Aid

EVERY_S = 1.0
"""Shortest time between two measurements of a source that count as independent, s. Chosen: receivers and compasses
smooth over about a second."""

HEADING_DEG = 5.0
"""Standard deviation of a heading that states none, deg. Chosen: a compass in a building."""

COURSE_DEG, COURSE_MPS = 1.0, 0.1
"""Standard deviations of a course as a heading, deg, and of each component of its velocity, m/s. Chosen: vehicles slip,
and receivers average over up to a second. Cited: data sheets of u-blox receivers state 0.05 m/s at 50 %."""

LATE_S = 0.05
"""Error of the time of a measurement, s. Chosen: half a period at 10 Hz."""

SAME_ZERO_SIGMAS = 3.0
"""Distance of a first heading from yaw, in standard deviations, within which both have the same zero. Chosen."""


@dataclass(slots=True)
class HeadingSource:
    """A source of headings with its offset, None before the first, and the time of the last that counted."""

    trust: Trust = field(default_factory=Trust)
    offset: OwnErrors | None = None
    used_s: float = -inf

    def forget(self) -> None:
        """Forget an offset that was learned from the filter."""
        if self.offset is not None and self.offset.cov[0][0] > 0.0:
            self.offset = None

    def measure(self, aided: AidedFilter, c: Any, s: Any, aid: Aid, motion: RecentMotion, scale: ScaleError) -> None:
        """Let the filter take a heading."""
        if aid.t_s - self.used_s < EVERY_S:
            return
        self.used_s = aid.t_s
        if aided.add_scale_error is not None:
            scale.variance = c.scale_sigma * c.scale_sigma if isnan(scale.variance) else scale.variance
            aided.add_scale_error(c, s, scale.turn(motion.turn_deg))
        late_deg = LATE_S * (motion.rate_dps - s.bias_dps)
        value, variance = aid.value + motion.since(aid.t_s), sigma_deg(aid) ** 2 + late_deg * late_deg
        m = aided.moments(s)
        plain = AidReading(True, value, variance, period_deg=aid.period_deg)
        if self.offset is None:
            self.offset = first_offset(plain, m)
        own_var, shared_var = self.offset.cov[0][0], self.offset.shared_var
        self.offset.is_fixed = self.offset.is_fixed or m.yaw_var - shared_var > own_var
        reading = plain._replace(
            value=value - self.offset.mean[0],
            own_var=own_var,
            shared_var=shared_var,
            shared_covariance=self.offset.shared_covariance,
        )
        if self.trust.judge(reading, m, counts=True):
            right = aided.take(c, s, reading)
            self.offset.update((1.0,), reading, m, right)
            if aided.add_scale_error is not None:
                scale.update(reading, m, right)
        elif self.trust.log_odds == 0.0:  # its offset may be another one now
            self.offset = unknown_offset(plain, m)


def sigma_deg(aid: Aid) -> float:
    """Standard deviation of a heading, deg."""
    if isnan(aid.speed):
        return HEADING_DEG if isnan(aid.sigma) else aid.sigma
    return hypot(COURSE_DEG if isnan(aid.sigma) else aid.sigma, degrees(atan2(COURSE_MPS, abs(aid.speed))))


def first_offset(reading: AidReading, m: AidMoments) -> OwnErrors:
    """Offset of a source by its first heading: none if it is near yaw."""
    difference, variance = reading.innovation(m)
    if abs(difference) < SAME_ZERO_SIGMAS * sqrt(variance):
        return OwnErrors([0.0], [[0.0]])
    return unknown_offset(reading, m)


def unknown_offset(reading: AidReading, m: AidMoments) -> OwnErrors:
    """Offset of a source by a single heading, with the errors of the heading and of yaw."""
    return OwnErrors([reading.difference(m.yaw_deg)], [[reading.variance]], m.yaw_var, m.covariance)
