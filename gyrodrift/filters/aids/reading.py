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
    """A measurement with errors of two kinds: chance, and those of its source, which the gyro may have calibrated.

    is_heading
        Whether it measures yaw, deg; else the bias, deg/s.
    value, variance
        Measured value, and variance of its chance error.
    own_var
        Variance of the error of its source.
    bias_correlation, yaw_correlation
        Correlations of that error with the errors of bias and yaw of the filter.
    period_deg
        Period of a heading, deg; 0 for a bias.
    """

    is_heading: bool
    value: float
    variance: float
    own_var: float = 0.0
    bias_correlation: float = 0.0
    yaw_correlation: float = 0.0
    period_deg: float = 0.0

    def difference(self, expected: float) -> float:
        """The value minus an expected one, within half a period of 0."""
        difference = self.value - expected
        period = self.period_deg
        return difference - period * round(difference / period) if period > 0.0 else difference

    def with_bias(self, bias_var: float) -> float:
        """Covariance of the error of the source with a bias of this variance."""
        return _bounded(self.bias_correlation, self.own_var, bias_var)

    def with_yaw(self, yaw_var: float) -> float:
        """Covariance of the error of the source with a yaw of this variance."""
        return _bounded(self.yaw_correlation, self.own_var, yaw_var)

    def innovation(self, m: AidMoments) -> tuple[float, float]:
        """Difference to the filter, and its variance."""
        variance = self.own_var + self.variance
        if self.is_heading:
            return self.difference(m.yaw_deg), m.yaw_var + 2.0 * self.with_yaw(m.yaw_var) + variance
        return self.difference(m.bias_dps), m.bias_var + 2.0 * self.with_bias(m.bias_var) + variance

    def gains(self, m: AidMoments) -> tuple[float, float]:
        """Gains for bias and yaw of the filter."""
        _, variance = self.innovation(m)
        bias, yaw = (m.covariance, m.yaw_var) if self.is_heading else (m.bias_var, m.covariance)
        return (bias + self.with_bias(m.bias_var)) / variance, (yaw + self.with_yaw(m.yaw_var)) / variance

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


def _bounded(correlation: float, own_var: float, variance: float) -> float:
    """Covariance with which a measurement does not move the filter away from itself."""
    return max(-variance, correlation * sqrt(own_var * variance)) if variance > 0.0 else 0.0


def normal_pdf(x: float, variance: float) -> float:
    """Density of a normal distribution with mean 0."""
    return exp(-0.5 * x * x / variance) / sqrt(2.0 * pi * variance)
