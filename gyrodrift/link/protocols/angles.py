"""Choice between rate and angle of a device that may send both, and yaw of a quaternion."""

ANGLES_BEFORE = 5
"""Angles without a rate before the angle is chosen: devices that send both alternate."""


class RateOrAngle:
    """Choice for the whole stream: the rate, unless ANGLES_BEFORE angles came without one."""

    def __init__(self) -> None:
        self._has_rate = False
        self._angles = 0

    @property
    def is_angle(self) -> bool:
        """Whether the angle has been chosen."""
        return self._angles > ANGLES_BEFORE

    def offer_rate(self) -> bool:
        """Note a received rate, and return whether it is used."""
        self._has_rate = not self.is_angle
        return self._has_rate

    def offer_angle(self) -> bool:
        """Note a received angle, and return whether it is used."""
        self._angles += not self._has_rate
        return self.is_angle
