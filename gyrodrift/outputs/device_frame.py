"""Attitude and rates of a device whose sensor has three axes, for clients that expect those of the device.

The device frame has x forward, y left and z up (REP 103). Its heading is yaw: the twist about the vertical. So a device
is turned by yaw about the vertical after the shortest rotation that gives it its roll and pitch.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import asin, atan2, cos, radians, sin, sqrt
from typing import Any

from gyrodrift.values.mount import LEVEL, Mount, Quaternion, with_heading
from gyrodrift.values.sample import Attitude, Inertial
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
            return _positive(with_heading(self.mount.device_attitude(attitude[:4]), heading_deg - yaw_deg))
        w = sqrt(0.5 * (1.0 + up_z))
        swing = w, 0.5 * cos(pitch) * sin(roll) / w, 0.5 * sin(pitch) / w, 0.0
        return _positive(with_heading(swing, heading_deg))

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


def frd(q: Quaternion) -> Quaternion:
    """Rotation between frames forward, right, down instead of forward, left, up."""
    w, x, y, z = q
    return w, x, -y, -z


def angles_rad(q: Quaternion) -> Vector:
    """Roll, pitch and yaw of R = Rz(yaw)·Ry(pitch)·Rx(roll), rad."""
    w, x, y, z = q
    roll = atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
    pitch = asin(max(-1.0, min(1.0, 2.0 * (w * y - z * x))))
    return roll, pitch, atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))


def _positive(q: Quaternion) -> Quaternion:
    w, x, y, z = q
    return q if w >= 0.0 else (-w, -x, -y, -z)
