"""Readings of `sensor_msgs/Imu` as JSON of rosbridge: `{"op": "publish", "topic": …, "msg": {…}}`.

Units and axes are those of REP 103: rad/s, m/s², x forward, y left, z up. A covariance that begins with -1 marks a
missing measurement (sensor_msgs/Imu). The stamp of the header is the clock, `nanosec` in ROS 2 and `nsecs` in ROS 1.
"""

import json
from collections.abc import Mapping
from math import degrees, isfinite
from typing import Any

from gyrodrift.link.protocols.batch import batch_protocol
from gyrodrift.link.protocols.decoder import DeviceDescription
from gyrodrift.link.protocols.plausible import inertial_of
from gyrodrift.values.constants import CLOCK_MASK
from gyrodrift.values.sample import Reading
from gyrodrift.values.vectors import Vector

MISSING = -1.0
LONGEST_STAMP_S = 1 << 63
LONGEST_FRAME_ID = 64


class ImuReadings:
    """Readings of messages; without a stamp in the first one, messages have no clock.

    device
        Frame of the first message.
    """

    def __init__(self) -> None:
        self.device = DeviceDescription()
        self._is_timed: bool | None = None

    def reading(self, message: Mapping[str, Any]) -> Reading | None:
        """Reading of a message; None without plausible rates."""
        rates = _vector(message, "angular_velocity")
        inertial = rates and inertial_of(tuple(map(degrees, rates)), _vector(message, "linear_acceleration"))
        if inertial is None:
            return None
        t_us = self._time_us(message)
        if self._is_timed and t_us is None:
            return None
        return Reading(t_us if self._is_timed else None, None, inertial.gyro_z_dps, inertial=inertial)

    def _time_us(self, message: Mapping[str, Any]) -> int | None:
        """Stamp of a message; the first one decides whether there is a clock."""
        header = message.get("header")
        t_us = _stamp_us(header.get("stamp")) if isinstance(header, dict) else None
        if self._is_timed is None:
            self._is_timed = t_us is not None
            frame_id = str(header.get("frame_id", ""))[:LONGEST_FRAME_ID] if isinstance(header, dict) else ""
            self.device = DeviceDescription(frame_id or "sensor_msgs/Imu", axes=3)
        return t_us


def message_of(content: bytes) -> dict[str, Any] | None:
    """Message of a publication; None if it is none."""
    try:
        publication = json.loads(content)
    except (ValueError, RecursionError):
        return None
    message = publication.get("msg") if isinstance(publication, dict) else None
    return message if isinstance(message, dict) else None


def _vector(message: Mapping[str, Any], name: str) -> Vector | None:
    """Three finite numbers of a field; None if they are missing, or the covariance says so."""
    vector, covariance = message.get(name), message.get(f"{name}_covariance")
    if not isinstance(vector, dict) or (isinstance(covariance, list) and covariance[:1] == [MISSING]):
        return None
    try:
        x, y, z = (float(vector[axis]) for axis in "xyz")
    except (KeyError, TypeError, ValueError, OverflowError):
        return None
    return (x, y, z) if isfinite(x) and isfinite(y) and isfinite(z) else None


def _stamp_us(stamp: object) -> int | None:
    """Stamp in µs; None without one, or for 0, which drivers without a clock send."""
    if not isinstance(stamp, dict):
        return None
    seconds, nanoseconds = (stamp.get(new, stamp.get(old)) for new, old in (("sec", "secs"), ("nanosec", "nsecs")))
    if not isinstance(seconds, int) or not isinstance(nanoseconds, int) or abs(seconds) >= LONGEST_STAMP_S:
        return None
    return (seconds * 1_000_000 + nanoseconds // 1000) & CLOCK_MASK if seconds or nanoseconds else None


ROSBRIDGE_PROTOCOL = batch_protocol(
    "rosbridge",
    "sensor_msgs/Imu as JSON of rosbridge",
    "the topic is no sensor_msgs/Imu, or its angular velocity is marked as missing; see ros2 topic info",
)
