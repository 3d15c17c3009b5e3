"""A sample in the axes of aircraft: forward, right, down. Yaw and its rate are clockwise positive."""

from dataclasses import dataclass
from math import cos, isnan, pi, radians, remainder, sin
from typing import Literal

from gyrodrift.outputs.device_frame import UNTURNED, DeviceFrame, angles_rad, frd
from gyrodrift.values.mount import Quaternion
from gyrodrift.values.sample import Attitude, Corrected, Inertial
from gyrodrift.values.vectors import Vector

FrdReference = Literal["frd", "ned"]
"""Yaw from the start of the service, or heading from north."""


@dataclass(frozen=True, slots=True)
class FrdSample:
    """Attitude, rates and variances; NaN for unknown variances.

    roll_rad, pitch_rad, yaw_rad
        Angles, rad; yaw is in -π to π, NaN in `ned` before a heading was set.
    rates_rad_s
        Rates about forward, right and down, rad/s.
    quaternion
        Rotation from body to reference: w, x, y, z.
    has_axes
        Whether roll, pitch and their rates are measured.
    """

    roll_rad: float
    pitch_rad: float
    yaw_rad: float
    rates_rad_s: Vector
    quaternion: Quaternion
    tilt_variance_rad2: float
    yaw_variance_rad2: float
    rate_variance_rad2_s2: float
    has_axes: bool


def frd_sample(
    sample: Corrected, reference: FrdReference, tilt_sigma_deg: float, mount: DeviceFrame = UNTURNED
) -> FrdSample:
    """Sample of a device; level if it has one axis.

    Parameters
    ----------
    tilt_sigma_deg
        Standard deviation of roll and pitch if the sample has none, deg.
    """
    inertial, attitude = sample.sample.inertial, sample.attitude
    clockwise_deg = sample.heading_deg if reference == "ned" else -sample.yaw_deg
    if inertial is None or attitude is None or isnan(clockwise_deg):
        return _level(sample, clockwise_deg, tilt_sigma_deg)
    return _tilted(sample, inertial, attitude, clockwise_deg, tilt_sigma_deg, mount)


def _level(sample: Corrected, clockwise_deg: float, tilt_sigma_deg: float) -> FrdSample:
    yaw_rad = remainder(radians(clockwise_deg), 2.0 * pi)
    quaternion = cos(yaw_rad / 2.0), 0.0, 0.0, sin(yaw_rad / 2.0)
    rates = 0.0, 0.0, -radians(sample.corrected_dps)
    return FrdSample(0.0, 0.0, yaw_rad, rates, quaternion, *_variances(sample, tilt_sigma_deg), has_axes=False)


def _tilted(
    sample: Corrected,
    inertial: Inertial,
    attitude: Attitude,
    clockwise_deg: float,
    tilt_sigma_deg: float,
    mount: DeviceFrame,
) -> FrdSample:
    quaternion = frd(mount.attitude(attitude, sample.yaw_deg, -clockwise_deg))
    forward, leftward, upward = map(radians, mount.rates_dps(inertial, attitude))
    sigma_deg = tilt_sigma_deg if isnan(attitude.tilt_sigma_deg) else attitude.tilt_sigma_deg
    rates = forward, -leftward, -upward
    return FrdSample(*angles_rad(quaternion), rates, quaternion, *_variances(sample, sigma_deg), has_axes=True)


def _variances(sample: Corrected, tilt_sigma_deg: float) -> Vector:
    """Variances of tilt, of yaw, and of rates."""
    return (
        radians(tilt_sigma_deg) ** 2,
        radians(sample.yaw_sigma_deg) ** 2,
        radians(sample.bias_sigma_dps) ** 2,
    )
