"""Angles of devices that send a rate as well, or none: which of the two is taken, and the yaw of a quaternion."""

from math import atan2, degrees

ANGLES_BEFORE = 5
"""So many angles wait for a rate: devices that send both do so in turns."""


class RateOrAngle:
    """One or the other for the whole stream: the rate, unless ANGLES_BEFORE angles came without any."""

    def __init__(self) -> None:
        self._has_rate = False
        self._angles = 0

    @property
    def is_angle(self) -> bool:
        """Whether the angle has been chosen."""
        return self._angles > ANGLES_BEFORE

    def takes_rate(self) -> bool:
        """Of a rate that came: whether it is taken."""
        self._has_rate = not self.is_angle
        return self._has_rate

    def takes_angle(self) -> bool:
        """Of an angle that came: whether it is taken."""
        self._angles += not self._has_rate
        return self.is_angle


def yaw_of(w: float, x: float, y: float, z: float) -> float:
    """Yaw in degrees of the rotation from body to world, about the world's z axis (Z-Y-X Euler angles)."""
    return degrees(atan2(2.0 * (w * z + x * y), w * w + x * x - y * y - z * z))
