"""Errors that a second source has of its own, and the scale error of the gyro that a heading shows.

Both are states of a Kalman filter together with yaw and bias. The filter keeps yaw and bias; here are the other states,
and their covariances with both. So a source that was calibrated by the gyro does not confirm the gyro.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, nan, sqrt

from gyrodrift.filters.aids.reading import AidMoments, AidReading

MOST_CORRELATED = 0.9999
"""Largest correlation of an error of a source with the filter: rounding may not reach 1."""

CROSS_AXIS = 0.002
"""Scale error that changes from turn to turn, as a share: a fifth of the scale error, as in the attitude filter."""


@dataclass(slots=True)
class OwnErrors:
    """Means of the errors, their covariance matrix, and their covariances with bias and yaw of the filter.

    bias_var, yaw_var
        Variances of the filter after the last measurement.
    is_fixed
        The errors are not learned any more, but stay uncertain (Schmidt 1966).
    """

    mean: list[float]
    cov: list[list[float]]
    with_bias: list[float]
    with_yaw: list[float]
    bias_var: float = inf
    yaw_var: float = inf
    is_fixed: bool = False

    def follow(self, m: AidMoments, seconds: float, walk_var: float) -> None:
        """Go over time since the last measurement: yaw turned by the error of the bias, or was measured meanwhile."""
        kept_bias = min(1.0, m.bias_var / self.bias_var) if self.bias_var > 0.0 else 0.0
        kept_yaw = min(1.0, m.yaw_var / self.yaw_var) if self.yaw_var > 0.0 else 0.0
        for i, row in enumerate(self.cov):
            row[i] += walk_var * seconds
            with_yaw, with_bias = self.with_yaw[i] - self.with_bias[i] * seconds, self.with_bias[i]
            self.with_yaw[i] = bounded(kept_yaw * with_yaw, row[i] * m.yaw_var)
            self.with_bias[i] = bounded(kept_bias * with_bias, row[i] * m.bias_var)

    def reading(
        self, shape: Sequence[float], value: float, variance: float, m: AidMoments, period_deg: float = 0.0
    ) -> AidReading:
        """A measurement without the mean of the errors, which come with the factors `shape`."""
        own_var = max(0.0, _dot(shape, [_dot(row, shape) for row in self.cov]))
        return AidReading(
            period_deg > 0.0,
            value - _dot(shape, self.mean),
            variance,
            own_var,
            _correlation(_dot(shape, self.with_bias), own_var * m.bias_var),
            _correlation(_dot(shape, self.with_yaw), own_var * m.yaw_var),
            period_deg,
        )

    def update(self, shape: Sequence[float], reading: AidReading, m: AidMoments, right: float) -> None:
        """Learn from a measurement that is right with this probability; `m` are the moments before it."""
        innovation, variance = reading.innovation(m)
        with_measured = self.with_yaw if reading.is_heading else self.with_bias
        gain = [(w + _dot(row, shape)) / variance for w, row in zip(with_measured, self.cov, strict=True)]
        bias_gain, yaw_gain = reading.gains(m)
        spread = right * (variance - (1.0 - right) * innovation * innovation)
        for i, g in enumerate(gain):
            self.with_bias[i] -= spread * g * bias_gain
            self.with_yaw[i] -= spread * g * yaw_gain
            if self.is_fixed:
                continue
            self.mean[i] += right * g * innovation
            for j, second_gain in enumerate(gain):
                self.cov[i][j] -= spread * g * second_gain
            self.cov[i][i] = max(self.cov[i][i], 0.0)


@dataclass(slots=True)
class ScaleError:
    """Scale error of a gyro of one axis: mean and variance, covariance with yaw, and turn up to the last heading."""

    mean: float = 0.0
    variance: float = nan
    with_yaw: float = 0.0
    motion_deg: float = 0.0

    @property
    def sigma(self) -> float:
        """Standard deviation, with the part that changes from turn to turn."""
        return sqrt(self.variance + CROSS_AXIS * CROSS_AXIS)

    def turn(self, motion_deg: float) -> float:
        """Follow the turn since the last heading; variance of yaw beside that of the scale alone, deg²."""
        turn_deg, self.motion_deg = motion_deg - self.motion_deg, motion_deg
        covariance_var = 2.0 * self.with_yaw * turn_deg
        self.with_yaw += self.variance * turn_deg
        return covariance_var

    def update(self, reading: AidReading, m: AidMoments, right: float) -> None:
        """Learn from a heading that is right with this probability; `m` are the moments before it."""
        innovation, variance = reading.innovation(m)
        with_yaw = bounded(self.with_yaw, self.variance * m.yaw_var)
        gain = with_yaw / variance
        spread = right * (variance - (1.0 - right) * innovation * innovation)
        self.mean += right * gain * innovation
        self.variance = max(0.0, self.variance - spread * gain * gain)
        self.with_yaw = with_yaw - spread * gain * reading.gains(m)[1]


def bounded(covariance: float, variances: float) -> float:
    """A covariance that the product of both variances allows."""
    return _correlation(covariance, variances) * sqrt(max(0.0, variances))


def _correlation(covariance: float, variances: float) -> float:
    return max(-MOST_CORRELATED, min(covariance / sqrt(variances), MOST_CORRELATED)) if variances > 0.0 else 0.0


def _dot(a: Sequence[float], b: Sequence[float]) -> float:
    return sum(x * y for x, y in zip(a, b, strict=True))
