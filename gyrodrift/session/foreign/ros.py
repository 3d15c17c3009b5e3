"""Samples from messages of ROS: `sensor_msgs/Imu`, and `gyrodrift/Sample` of our own recordings.

Messages of ROS 2 are CDR with the schema in the file. Messages of ROS 1 have a fixed layout.
"""

import math
import struct
from collections.abc import Callable
from contextlib import redirect_stderr
from io import StringIO
from typing import Any

from mcap.records import Schema
from mcap.well_known import MessageEncoding

from gyrodrift.session.foreign.columns import Decode, WrongValueError, number, sample_of, whole
from gyrodrift.session.session import DEVICE_COLUMNS
from gyrodrift.values.constants import NS_PER_S
from gyrodrift.values.errors import DataError
from gyrodrift.values.sample import Inertial, Sample

MOST_LINES, MOST_SCHEMA_BYTES = 2000, 1 << 18
"""Limits of a schema. The time of its parser grows with the square of the fields: 2000 take 0.3 s, 40,000 take 19 s
(measured). sensor_msgs/msg/Imu with its nested types has 26 lines."""


NO_RATE = "has no rate: angular_velocity_covariance begins with -1"
ROS1_HEADER = struct.Struct("<IIII")
"""Sequence number, stamp in s and ns, and length of the following frame name (std_msgs/Header)."""

ROS1_VALUES = struct.Struct("<4d9d3d9d3d9d")
"""Orientation, angular velocity and acceleration, each with its covariance."""

RATES, RATE_COVARIANCE = slice(13, 16), 16
FORCES, FORCE_COVARIANCE = slice(25, 28), 28
"""Indices in the values."""


def _own_sample(message: Any, log_ns: int) -> Sample:
    names = (*Sample._fields, *Inertial._fields, *DEVICE_COLUMNS)
    return sample_of({name: getattr(message, name) for name in names if hasattr(message, name)}, log_ns)


def imu_sample(message: Any, log_ns: int) -> Sample:
    """Sample with the rate about z; other columns are missing."""
    try:
        stamp, rate, covariance = message.header.stamp, message.angular_velocity.z, message.angular_velocity_covariance
        parts, first = (stamp.sec, stamp.nanosec), covariance[0]
    except (AttributeError, IndexError, TypeError) as error:
        raise WrongValueError("lacks header.stamp, angular_velocity.z or angular_velocity_covariance") from error
    if first == -1.0:
        raise WrongValueError(NO_RATE)
    sec, nanosec = (whole(f"header.stamp.{name}", part) for name, part in zip(("sec", "nanosec"), parts, strict=True))
    rate_dps = math.degrees(number("angular_velocity.z", rate))
    t_device_s = (sec * NS_PER_S + nanosec) / NS_PER_S
    return Sample(-1, t_device_s, log_ns / NS_PER_S, rate_dps, inertial=_inertial(message, rate_dps))


def _inertial(message: Any, rate_dps: float) -> Inertial | None:
    """All axes of an Imu message; None if it lacks a rate, without accelerations if it says that it has none."""
    try:
        rate, force = message.angular_velocity, message.linear_acceleration
        rates_rads, forces_mps2 = (rate.x, rate.y), (force.x, force.y, force.z)
        has_forces = message.linear_acceleration_covariance[0] != -1.0
    except (AttributeError, IndexError, TypeError):
        return None
    x_dps, y_dps = (math.degrees(number("angular_velocity", value)) for value in rates_rads)
    x, y, z = (number("linear_acceleration", value) if has_forces else math.nan for value in forces_mps2)
    return Inertial(x_dps, y_dps, rate_dps, x, y, z)


IMU_NAMES = ("sensor_msgs/Imu", "sensor_msgs/msg/Imu")
ROS_MESSAGES: dict[str, Callable[[Any, int], Sample]] = {
    "gyrodrift/Sample": _own_sample,
    "gyrodrift/msg/Sample": _own_sample,
    **dict.fromkeys(IMU_NAMES, imu_sample),
}
"""Decoders by the name of the schema, in the old and the new form."""


def cdr_decoder(source: str, schema: Schema) -> Decode:
    """Decoder of the messages of a channel with a known schema; `source` names it in messages.

    Raises
    ------
    DataError
        The schema cannot be parsed.
    """
    decode = parsed(source, schema)
    to_sample = ROS_MESSAGES[schema.name]

    return lambda payload, log_ns: to_sample(decode(payload), log_ns)


def parsed(source: str, schema: Schema) -> Callable[[bytes], Any]:
    """Parse a schema, which may be any text; its parser prints errors and raises many types.

    The result decodes a message, and raises WrongValueError for bytes that do not fit the schema.

    Raises
    ------
    DataError
        The schema is too large, or cannot be parsed; `source` names the channel.
    """
    lines = schema.data.count(b"\n") + 1
    if lines > MOST_LINES or len(schema.data) > MOST_SCHEMA_BYTES:
        size = f"{lines} lines and {len(schema.data)} bytes"
        limits = f"at most {MOST_LINES} and {MOST_SCHEMA_BYTES} are read"
        raise DataError(f"{source}: the schema {schema.name} has {size}; {limits}")
    from mcap_ros2.decoder import DecoderFactory

    try:
        with redirect_stderr(StringIO()):
            decode = DecoderFactory().decoder_for(MessageEncoding.CDR, schema)
    except Exception as error:
        raise DataError(f"{source}: the schema {schema.name} cannot be parsed") from error
    if decode is None:
        raise DataError(f"{source}: the schema {schema.name} is not in the form of ROS 2")
    return fitting(decode, schema.name)


def fitting(decode: Callable[[bytes], Any], name: str) -> Callable[[bytes], Any]:
    """A decoder that raises WrongValueError, with the name of the schema, whatever it meets in any bytes."""

    def decoded(payload: bytes) -> Any:
        try:
            return decode(payload)
        except Exception as error:
            raise WrongValueError(f"does not fit its schema {name}") from error

    return decoded


def ros1_imu_sample(payload: bytes, log_ns: int) -> Sample:
    """Sample with the rate about z.

    Raises
    ------
    WrongValueError
        The message has a wrong length, or no rate.
    """
    if len(payload) < ROS1_HEADER.size:
        raise WrongValueError("does not fit its schema sensor_msgs/Imu")
    _, sec, nanosec, name_bytes = ROS1_HEADER.unpack_from(payload)
    if len(payload) != ROS1_HEADER.size + name_bytes + ROS1_VALUES.size:
        raise WrongValueError("does not fit its schema sensor_msgs/Imu")
    values = ROS1_VALUES.unpack_from(payload, ROS1_HEADER.size + name_bytes)
    if values[RATE_COVARIANCE] == -1.0:
        raise WrongValueError(NO_RATE)
    t_device_s = (sec * NS_PER_S + nanosec) / NS_PER_S
    rates_dps = [math.degrees(rate_rads) for rate_rads in values[RATES]]
    forces_mps2 = () if values[FORCE_COVARIANCE] == -1.0 else values[FORCES]
    inertial = Inertial(*rates_dps, *forces_mps2)
    return Sample(-1, t_device_s, log_ns / NS_PER_S, inertial.gyro_z_dps, inertial=inertial)
