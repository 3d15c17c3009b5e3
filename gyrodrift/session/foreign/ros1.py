"""Samples from `sensor_msgs/Imu` of ROS 1, as `mcap convert` writes it from a bag: a fixed layout."""

import math
import struct

from gyrodrift.session.foreign.columns import NS_PER_S, WrongValueError
from gyrodrift.values.sample import Inertial, Sample

NAMES = frozenset({"sensor_msgs/Imu", "sensor_msgs/msg/Imu"})
HEADER = struct.Struct("<IIII")
"""Sequence number, stamp in s and ns, and length of the following frame name (std_msgs/Header)."""

VALUES = struct.Struct("<4d9d3d9d3d9d")
"""Orientation, angular velocity and acceleration, each with its covariance."""

RATES, RATE_COVARIANCE = slice(13, 16), 16
FORCES, FORCE_COVARIANCE = slice(25, 28), 28
"""Indices in the values."""


def ros1_imu_sample(payload: bytes, log_ns: int) -> Sample:
    """Sample with the rate about z.

    Raises
    ------
    WrongValueError
        The message has a wrong length, or no rate.
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
    rates_dps = [math.degrees(rate_rads) for rate_rads in values[RATES]]
    forces_mps2 = () if values[FORCE_COVARIANCE] == -1.0 else values[FORCES]
    inertial = Inertial(*rates_dps, *forces_mps2)
    return Sample(-1, t_device_s, log_ns / NS_PER_S, inertial.gyro_z_dps, inertial=inertial)
