"""Samples from `sensor_msgs/Imu` as ROS 1 writes it, which `mcap convert` keeps of a bag: a fixed layout."""

import math
import struct

from gyrodrift.sample import Sample
from gyrodrift.session.foreign.columns import NS_PER_S, WrongValueError

NAMES = frozenset({"sensor_msgs/Imu", "sensor_msgs/msg/Imu"})
HEADER = struct.Struct("<IIII")
"""Sequence number, stamp in s and ns, and the length of the frame's name that follows (std_msgs/Header)."""

VALUES = struct.Struct("<4d9d3d9d3d9d")
"""Orientation, angular velocity and acceleration, with the covariance behind each."""

RATE_Z, RATE_COVARIANCE = 15, 16
"""Indices among the values."""


def ros1_imu_sample(payload: bytes, log_ns: int) -> Sample:
    """The turn about z.

    Raises
    ------
    WrongValueError
        Where it has another length, or no rate.
    """
    if len(payload) < HEADER.size:
        raise WrongValueError("does not fit its schema sensor_msgs/Imu")
    _, sec, nanosec, name_bytes = HEADER.unpack_from(payload)
    if len(payload) != HEADER.size + name_bytes + VALUES.size:
        raise WrongValueError("does not fit its schema sensor_msgs/Imu")
    values = VALUES.unpack_from(payload, HEADER.size + name_bytes)
    if values[RATE_COVARIANCE] == -1.0:
        raise WrongValueError("has no rate: angular_velocity_covariance begins with -1")
    t_device_s = (sec * NS_PER_S + nanosec) / NS_PER_S
    return Sample(-1, t_device_s, log_ns / NS_PER_S, math.degrees(values[RATE_Z]))
