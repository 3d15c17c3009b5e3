"""Mount of a sensor on its device, and what it makes of an attitude: tilt, roll and pitch.

Quaternions (w, x, y, z) rotate from the sensor to the earth frame, z up. The device frame has x forward, y left and z
up (REP 103). Roll and pitch are its Tait-Bryan angles, R = Rz(yaw)·Ry(pitch)·Rx(roll): roll is positive with the right
side down, pitch with the nose down.
"""

from dataclasses import dataclass
from functools import cache
from math import asin, atan2, degrees, hypot, sqrt
from typing import Literal, get_args

from gyrodrift.values.quaternion import Quaternion, product, up_in_sensor, with_heading
from gyrodrift.values.vectors import Vector

Axis = Literal["+x", "-x", "+y", "-y", "+z", "-z"]

AXES: tuple[Axis, ...] = get_args(Axis)


@dataclass(frozen=True, slots=True)
class Mount:
    """Axes of the sensor that point up and forward on the level device.

    Raises
    ------
    ValueError
        If both are the same axis of the sensor.
    """

    up: Axis = "+z"
    forward: Axis = "+x"

    def __post_init__(self) -> None:
        if self.up[1] == self.forward[1]:
            raise ValueError(
                f"up is {self.up} and forward is {self.forward}; expected two different axes of the sensor"
            )

    @property
    def axes(self) -> tuple[Vector, Vector, Vector]:
        """Forward, left and up of the device as unit vectors in the sensor frame."""
        return _axes_of(self.forward, self.up)

    @property
    def quaternion(self) -> Quaternion:
        """Rotation from the device to the sensor frame, by Shepperd's method: of four forms the longest is exact."""
        (a, d, g), (b, e, h), (c, f, i) = self.axes
        candidates = (
            (1.0 + a + e + i, h - f, c - g, d - b),
            (h - f, 1.0 + a - e - i, b + d, c + g),
            (c - g, b + d, 1.0 - a + e - i, f + h),
            (d - b, c + g, f + h, 1.0 - a - e + i),
        )
        w, x, y, z = max(candidates, key=lambda parts: sum(part * part for part in parts))
        size = sqrt(w * w + x * x + y * y + z * z)
        return w / size, x / size, y / size, z / size

    def to_device(self, of_sensor: Vector) -> Vector:
        """Vector of the sensor frame in the device frame."""
        x, y, z = (a * of_sensor[0] + b * of_sensor[1] + c * of_sensor[2] for a, b, c in self.axes)
        return x, y, z

    def to_sensor(self, of_device: Vector) -> Vector:
        """Vector of the device frame in the sensor frame."""
        x, y, z = (sum(a * b for a, b in zip(of_device, axis, strict=True)) for axis in zip(*self.axes, strict=True))
        return x, y, z

    def sensor_attitude(self, q: Quaternion) -> Quaternion:
        """Attitude of the sensor from that of the device; a level device of heading 0 has a sensor of heading 0."""
        w, x, y, z = self.quaternion
        return with_heading(product(q, (w, -x, -y, -z)), self._twist_deg)

    def device_attitude(self, q: Quaternion) -> Quaternion:
        """Attitude of the device from that of the sensor, the reverse of `sensor_attitude`."""
        return product(with_heading(q, -self._twist_deg), self.quaternion)

    @property
    def _twist_deg(self) -> float:
        """Twist of the rotation from the device to the sensor frame, deg."""
        w, _, _, z = self.quaternion
        return degrees(2.0 * atan2(z, w))

    def tilt_deg(self, q: Quaternion) -> float:
        """Angle between the up axis and the vertical, 0 to 180 deg."""
        forward_z, left_z, up_z = self._heights(q)
        return degrees(atan2(hypot(forward_z, left_z), up_z))

    def roll_pitch_deg(self, q: Quaternion) -> tuple[float, float]:
        """Roll, −180 to 180 deg, and pitch, −90 to 90 deg."""
        forward_z, left_z, up_z = self._heights(q)
        return degrees(atan2(left_z, up_z)), degrees(asin(max(-1.0, min(1.0, -forward_z))))

    def _heights(self, q: Quaternion) -> Vector:
        """Heights of the unit vectors forward, left and up over the horizon."""
        vertical = up_in_sensor(q)
        return vertical if self is LEVEL else self.to_device(vertical)


@cache
def _axes_of(forward: Axis, up: Axis) -> tuple[Vector, Vector, Vector]:
    return vector_of(forward), _cross(vector_of(up), vector_of(forward)), vector_of(up)


LEVEL = Mount()


def vector_of(axis: Axis) -> Vector:
    """Unit vector of an axis in the sensor frame."""
    x, y, z = (1.0 if axis[1] == name else 0.0 for name in "xyz")
    return (x, y, z) if axis[0] == "+" else (-x, -y, -z)


def nearest_axis(of_sensor: Vector) -> Axis:
    """Axis of the sensor that is nearest to a vector in its frame, such as gravity."""
    return max(AXES, key=lambda axis: sum(a * b for a, b in zip(vector_of(axis), of_sensor, strict=True)))


def _cross(a: Vector, b: Vector) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
