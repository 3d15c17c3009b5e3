"""A measurement of yaw or of the bias, as a filter takes it, and how the filter knows both at that time."""

from collections.abc import Callable
from dataclasses import dataclass
from math import exp, pi, sqrt
from typing import Any, NamedTuple

WRONG_SHARE = 0.1
"""Share of measurements that are wrong: reflections, slips, other markers. Chosen: one in ten."""

WRONG_DPS = 400.0
"""Range of turn rates that are wrong, deg/s. Chosen: wheels that slip show any rate of a robot."""


class AidMoments(NamedTuple):
    """Bias, deg/s, and yaw, deg, of a filter at the end of a block, and their covariance matrix."""

    bias_dps: float
    yaw_deg: float
    bias_var: float
    covariance: float
    yaw_var: float


class AidReading(NamedTuple):
    """A measurement with errors of two kinds: chance, and those of its source, which are the same next time.

    is_heading
        Whether it measures yaw, deg; else the bias, deg/s.
    value, variance
        Measured value, and variance of its chance error.
    own_var
        Variance of the error of its source. No number of measurements makes the filter more certain than that.
    shared_var, shared_covariance
        Variance of yaw, and its covariance with the bias, that the source shares: its zero was learned from yaw.
    period_deg
        Period of a heading, deg; 0 for a bias.
    """

    is_heading: bool
    value: float
    variance: float
    own_var: float = 0.0
    shared_var: float = 0.0
    shared_covariance: float = 0.0
    period_deg: float = 0.0

    def difference(self, expected: float) -> float:
        """The value minus an expected one, within half a period of 0."""
        difference = self.value - expected
        period = self.period_deg
        return difference - period * round(difference / period) if period > 0.0 else difference

    def innovation(self, m: AidMoments) -> tuple[float, float]:
        """Difference to the filter, and its variance."""
        expected, variance = (m.yaw_deg, m.yaw_var) if self.is_heading else (m.bias_dps, m.bias_var)
        return self.difference(expected), max(0.0, variance - self.shared_var) + self.own_var + self.variance

    def odds(self, m: AidMoments) -> float:
        """Density of the value for a source that is right most times, over that of chance values."""
        return (1.0 - WRONG_SHARE) * normal_pdf(*self.innovation(m)) * self.range + WRONG_SHARE

    @property
    def range(self) -> float:
        """Range of wrong values."""
        return self.period_deg or WRONG_DPS


@dataclass(frozen=True, slots=True)
class AidedFilter:
    """How a filter takes measurements of second sources. All functions take its state, some its coefficients before it.

    has_block_ended
        Whether the last sample ended a block, so that a measurement can be taken.
    rate_dps
        Rate about the vertical as measured, deg/s.
    moments
        Moments of the Gaussian sum.
    take
        Updates all hypotheses by a reading, and returns the probability that it is right.
    add_scale_error
        Keeps the yaw error of the scale factor since the last time in yaw, with a variance beside it, deg²; None for a
        filter with the scale among its states.
    """

    has_block_ended: Callable[[Any], bool]
    rate_dps: Callable[[Any], float]
    moments: Callable[[Any], AidMoments]
    take: Callable[[Any, Any, AidReading], float]
    add_scale_error: Callable[[Any, Any, float], None] | None = None


def normal_pdf(x: float, variance: float) -> float:
    """Density of a normal distribution with mean 0."""
    return exp(-0.5 * x * x / variance) / sqrt(2.0 * pi * variance)
