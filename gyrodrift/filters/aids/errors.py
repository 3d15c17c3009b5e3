"""Errors that a second source has of its own, and the scale error of the gyro that a heading shows."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import nan, sqrt

from gyrodrift.filters.aids.reading import AidMoments, AidReading

CROSS_AXIS = 0.002
"""Scale error that changes from turn to turn, as a share: a fifth of the scale error, as in the attitude filter."""


@dataclass(slots=True)
class OwnErrors:
    """Means of the errors of a source and their covariance matrix.

    They are learned beside the filter, as if independent of it. In turn neither makes the other more certain than
    itself: a source that the gyro has calibrated does not confirm the gyro.

    shared_var, shared_covariance
        Variance of yaw and covariance with the bias that an offset shares, because it was learned from yaw.
    is_fixed
        The errors are not learned any more, but stay uncertain (Schmidt 1966).
    """

    mean: list[float]
    cov: list[list[float]]
    shared_var: float = 0.0
    shared_covariance: float = 0.0
    is_fixed: bool = False

    def own_var(self, shape: Sequence[float]) -> float:
        """Variance of a measurement's error whose parts come with these factors."""
        return max(0.0, _dot(shape, [_dot(row, shape) for row in self.cov]))

    def wander(self, seconds: float, walk_var: float) -> None:
        """Let the errors walk at random over a time."""
        for i, row in enumerate(self.cov):
            row[i] += walk_var * seconds

    def update(self, shape: Sequence[float], reading: AidReading, m: AidMoments, right: float) -> None:
        """Learn from a measurement that is right with this probability; `m` are the moments before it."""
        if self.is_fixed:
            return
        innovation, variance = reading.innovation(m)
        gain = [_dot(row, shape) / variance for row in self.cov]
        filter_var, own_var = m.yaw_var - self.shared_var if reading.is_heading else m.bias_var, reading.own_var
        spread = right * (variance - (1.0 - right) * innovation * innovation)
        taken_var = spread * own_var * own_var / (variance * variance)
        most_var = max(0.0, own_var - max(0.0, filter_var))
        spread *= min(1.0, most_var / taken_var) if taken_var > 0.0 else 1.0
        for i, g in enumerate(gain):
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
        most = sqrt(self.variance * m.yaw_var)
        with_yaw = max(-most, min(self.with_yaw, most))
        gain = with_yaw / variance
        spread = right * (variance - (1.0 - right) * innovation * innovation)
        self.mean += right * gain * innovation
        self.variance = max(0.0, self.variance - spread * gain * gain)
        self.with_yaw = with_yaw - spread * gain * m.yaw_var / variance


def _dot(a: Sequence[float], b: Sequence[float]) -> float:
    return sum(x * y for x, y in zip(a, b, strict=True))
