"""Roll and pitch of a device from the attitude of its sensor and the axes that point up and forward."""

from dataclasses import dataclass
from math import asin, atan2, degrees

from gyrodrift.filters.attitude.quaternion import Quaternion, Vector, rotate

AXES: dict[str, Vector] = {
    "+x": (1.0, 0.0, 0.0),
    "-x": (-1.0, 0.0, 0.0),
    "+y": (0.0, 1.0, 0.0),
    "-y": (0.0, -1.0, 0.0),
    "+z": (0.0, 0.0, 1.0),
    "-z": (0.0, 0.0, -1.0),
}


@dataclass(frozen=True, slots=True)
class Mount:
    """Axes of the sensor that point up and forward in the device, such as `+z` and `+x`.

    Raises
    ------
    ValueError
        For an unknown axis, and for axes that are not perpendicular.
    """

    up: str = "+z"
    forward: str = "+x"

    def __post_init__(self) -> None:
        for key, axis in (("up", self.up), ("forward", self.forward)):
            if axis not in AXES:
                raise ValueError(f"mount: {key} is {axis!r}; use one of {', '.join(AXES)}")
        if self.up[1] == self.forward[1]:
            raise ValueError(f"mount: up {self.up} and forward {self.forward} are one axis; use two different axes")


def roll_pitch_deg(q: Quaternion, mount: Mount) -> tuple[float, float]:
    """Roll and pitch in deg: ROS signs of x forward, y left, z up; positive pitch is nose down.

    Roll is in -180 to 180 and pitch in -90 to 90. They are the angles of yaw, pitch, roll in this order (Tait-Bryan).
    """
    up, forward = AXES[mount.up], AXES[mount.forward]
    leftward = (
        up[1] * forward[2] - up[2] * forward[1],
        up[2] * forward[0] - up[0] * forward[2],
        up[0] * forward[1] - up[1] * forward[0],
    )
    rise = rotate(q, forward)[2]
    return degrees(atan2(rotate(q, leftward)[2], rotate(q, up)[2])), degrees(asin(max(-1.0, min(1.0, -rise))))
