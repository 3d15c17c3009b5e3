"""Rotations in plain floats. A quaternion (w, x, y, z) turns vectors of a sensor or device to the earth frame, z up."""

from math import acos, asin, atan2, cos, degrees, radians, sin, sqrt
from typing import TYPE_CHECKING, TypeVar

from gyrodrift.values.vectors import Vector

if TYPE_CHECKING:
    from gyrodrift.values.arrays import Floats

Number = TypeVar("Number", float, "Floats")
Quaternion = tuple[float, float, float, float]

IDENTITY: Quaternion = (1.0, 0.0, 0.0, 0.0)

INVERTED_UP = -0.8660254037844387
"""Cosine of 150°, the tilt from which the twist turns fast for small rotations."""

SERIES_LIMIT = 0.0625
"""Squared angle, rad², up to which the series of `from_rotation_vector` is exact to 1e-8: n³/46080."""


def from_rotation_vector(x: float, y: float, z: float) -> Quaternion:
    """Quaternion of a rotation vector in rad; its norm is 1 to 1e-8."""
    n = x * x + y * y + z * z
    if n < SERIES_LIMIT:
        k = 0.5 - n * (1.0 / 48.0 - n / 3840.0)
        return (1.0 - n * (0.125 - n / 384.0), k * x, k * y, k * z)
    angle = sqrt(n)
    k = sin(0.5 * angle) / angle
    return (cos(0.5 * angle), k * x, k * y, k * z)


def normalized(q: Quaternion) -> Quaternion:
    """Quaternion of norm 1."""
    w, x, y, z = q
    k = 1.0 / sqrt(w * w + x * x + y * y + z * z)
    return (k * w, k * x, k * y, k * z)


def rotate(q: Quaternion, v: Vector) -> Vector:
    """Vector v of the sensor in the earth frame."""
    w, x, y, z = q
    vx, vy, vz = v
    tx, ty, tz = 2.0 * (y * vz - z * vy), 2.0 * (z * vx - x * vz), 2.0 * (x * vy - y * vx)
    return (
        vx + w * tx + y * tz - z * ty,
        vy + w * ty + z * tx - x * tz,
        vz + w * tz + x * ty - y * tx,
    )


def up_in_sensor(q: Quaternion) -> Vector:
    """Unit vector of the earth's vertical in the sensor frame."""
    w, x, y, z = q
    return (2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y))


def heading_axis(q: Quaternion) -> Vector:
    """Vector a of the sensor frame whose product with the rates is the rate of the twist about the vertical u.

    a = (z + u)/(1 + z·u) with the z axis of the sensor. For a constant tilt it gives the rate about the vertical, and
    its integral stays the heading when the tilt changes. Above 150° of tilt it is u itself.
    """
    x, y, z = up_in_sensor(q)
    if z < INVERTED_UP:
        return x, y, z
    k = 1.0 / (1.0 + z)
    return k * x, k * y, 1.0


def heading_deg(w: float, x: float, y: float, z: float) -> float:
    """Twist of a quaternion about the vertical, -180 to 180 deg; x and y do not matter.

    The heading error of an estimate is the twist of estimate times inverse reference.
    """
    del x, y
    twist = 2.0 * degrees(atan2(z, w))
    return twist - 360.0 if twist > 180.0 else twist + 360.0 if twist < -180.0 else twist


def tilt_deg(w: float, x: float, y: float, z: float) -> float:
    """Angle between the sensor's z axis and the vertical, 0 to 180 deg."""
    return degrees(acos(max(-1.0, min(1.0, (w * w + z * z) - (x * x + y * y)))))


def level(x: float, y: float, z: float) -> Quaternion:
    """Attitude of heading 0 whose vertical has this direction in the sensor; IDENTITY for a zero vector."""
    norm = sqrt(x * x + y * y + z * z)
    if norm == 0.0:
        return IDENTITY
    if z < -0.999999 * norm:
        return (0.0, 1.0, 0.0, 0.0)
    s = sqrt(2.0 * (1.0 + z / norm))
    return normalized((0.5 * s, y / (norm * s), -x / (norm * s), 0.0))


def with_heading(q: Quaternion, turn_deg: float) -> Quaternion:
    """Attitude after a further turn about the vertical."""
    half = radians(0.5 * turn_deg)
    c, s = cos(half), sin(half)
    w, x, y, z = q
    return c * w - s * z, c * x - s * y, c * y + s * x, c * z + s * w


def product(p: Quaternion, q: Quaternion) -> Quaternion:
    """Hamilton product: the rotation q, then p."""
    a, b, c, d = p
    w, x, y, z = q
    return (
        a * w - b * x - c * y - d * z,
        a * x + b * w + c * z - d * y,
        a * y - b * z + c * w + d * x,
        a * z + b * y - c * x + d * w,
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


def positive(q: Quaternion) -> Quaternion:
    """Quaternion of the same rotation with w ≥ 0."""
    w, x, y, z = q
    return q if w >= 0.0 else (-w, -x, -y, -z)


def yaw_parts(w: Number, x: Number, y: Number, z: Number) -> tuple[Number, Number]:
    """Sine and cosine of the yaw of R = Rz(yaw)·Ry(pitch)·Rx(roll), times a positive factor; of arrays, too."""
    return 2.0 * (w * z + x * y), w * w + x * x - y * y - z * z


def yaw_of(w: float, x: float, y: float, z: float) -> float:
    """Yaw of R = Rz(yaw)·Ry(pitch)·Rx(roll), deg, of a quaternion of any norm."""
    return degrees(atan2(*yaw_parts(w, x, y, z)))
