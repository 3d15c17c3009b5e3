"""Attitude and rates of a device whose sensor has three axes, for clients that expect those of the device.

The device frame has x forward, y left and z up (REP 103). Its heading is yaw: the twist about the vertical. So a device
is turned by yaw about the vertical after the shortest rotation that gives it its roll and pitch.

In the axes of aircraft, forward, right and down, yaw and its rate are clockwise positive.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import cos, isnan, pi, radians, remainder, sin, sqrt
from typing import Any, Literal

from gyrodrift.values.mount import LEVEL, Mount
from gyrodrift.values.quaternion import Quaternion, angles_rad, frd, positive, with_heading
from gyrodrift.values.sample import Attitude, Corrected, Inertial
from gyrodrift.values.vectors import Vector

UPSIDE_DOWN = cos(radians(150.0))
"""Height of the up axis below which a twist is ill defined. There the service carries yaw by the rate about the
vertical, and the heading is that of the attitude itself."""


@dataclass(frozen=True, slots=True)
class DeviceFrame:
    """Axes of the device in the sensor frame."""

    mount: Mount = LEVEL

    @classmethod
    def of(cls, mount: Mapping[str, Any] | None) -> "DeviceFrame":
        """Frame of a mount: the axes of the sensor, such as `+z`, that point `up` and `forward`."""
        return UNTURNED if mount is None else cls(Mount(**mount))

    def attitude(self, attitude: Attitude, yaw_deg: float, heading_deg: float) -> Quaternion:
        """Rotation from the device to the earth frame with z up, of the two signs that with w ≥ 0.

        Parameters
        ----------
        yaw_deg
            Yaw of the sample, deg.
        heading_deg
            Heading that the rotation has, counter-clockwise, deg: yaw itself, or yaw from north.
        """
        roll, pitch = radians(attitude.roll_deg), radians(attitude.pitch_deg)
        up_z = cos(pitch) * cos(roll)
        if up_z < UPSIDE_DOWN:
            return positive(with_heading(self.mount.device_attitude(attitude[:4]), heading_deg - yaw_deg))
        w = sqrt(0.5 * (1.0 + up_z))
        swing = w, 0.5 * cos(pitch) * sin(roll) / w, 0.5 * sin(pitch) / w, 0.0
        return positive(with_heading(swing, heading_deg))

    def rates_dps(self, inertial: Inertial, attitude: Attitude) -> Vector:
        """Rates about the axes of the device without the estimated drift, deg/s."""
        return self.mount.to_device(corrected_rates_dps(inertial, attitude))


UNTURNED = DeviceFrame()
"""The sensor's own axes."""


def corrected_rates_dps(inertial: Inertial, attitude: Attitude) -> Vector:
    """Rates about the axes of the sensor without the estimated drift, deg/s."""
    return (
        inertial.gyro_x_dps - attitude.bias_x_dps,
        inertial.gyro_y_dps - attitude.bias_y_dps,
        inertial.gyro_z_dps - attitude.bias_z_dps,
    )


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
