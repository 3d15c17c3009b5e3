"""Writing of sessions for other tools: chunked MCAP with `sensor_msgs/msg/Imu` messages or JSON."""

import json
import math
from collections.abc import Iterable, Iterator, Sequence
from itertools import chain
from pathlib import Path
from typing import Any

from gyrodrift import __version__
from gyrodrift.io.files import whole_file
from gyrodrift.io.json_numbers import finite
from gyrodrift.session.aids import COLUMN, aid_values, aids_by_row
from gyrodrift.session.mcap.layout import SAMPLES
from gyrodrift.session.session import AXIS_COLUMNS, DEVICE_COLUMNS, Session
from gyrodrift.values.constants import NS_PER_S
from gyrodrift.values.errors import DataError
from gyrodrift.values.sample import DeviceYaw, Inertial, Sample

LATEST_LOG_NS = 2**64 - 1
STAMP_SECONDS = range(-(2**31), 2**31)
"""Range of `builtin_interfaces/Time`."""

IMU_TOPIC = "/imu"
IMU_SCHEMA = "sensor_msgs/msg/Imu"
FRAME_ID = "gyro"

# From common_interfaces of ROS 2; every message follows the message that needs it.
IMU_TEXT = f"""\
# This is a message to hold data from an IMU (Inertial Measurement Unit)
#
# Accelerations should be in m/s^2 (not in g's), and rotational velocity should be in rad/sec
#
# If the covariance of the measurement is known, it should be filled in (if all you know is the
# variance of each measurement, e.g. from the datasheet, just put those along the diagonal)
# A covariance matrix of all zeros will be interpreted as "covariance unknown", and to use the
# data a covariance will have to be assumed or gotten from some other source
#
# If you have no estimate for one of the data elements (e.g. your IMU doesn't produce an
# orientation estimate), please set element 0 of the associated covariance matrix to -1
# If you are interpreting this message, please check for a value of -1 in the first element of each
# covariance matrix, and disregard the associated estimate.

std_msgs/Header header

geometry_msgs/Quaternion orientation
float64[9] orientation_covariance # Row major about x, y, z axes

geometry_msgs/Vector3 angular_velocity
float64[9] angular_velocity_covariance # Row major about x, y, z axes

geometry_msgs/Vector3 linear_acceleration
float64[9] linear_acceleration_covariance # Row major x, y z

{"=" * 80}
MSG: std_msgs/Header
# Standard metadata for higher-level stamped data types.
# This is generally used to communicate timestamped data
# in a particular coordinate frame.

# Two-integer timestamp that is expressed as seconds and nanoseconds.
builtin_interfaces/Time stamp

# Transform frame with which this data is associated.
string frame_id

{"=" * 80}
MSG: builtin_interfaces/Time
# This message communicates ROS Time defined here:
# https://design.ros2.org/articles/clock_and_time.html

# The seconds component, valid over all int32 values.
int32 sec

# The nanoseconds component, valid in the range [0, 1e9).
uint32 nanosec

{"=" * 80}
MSG: geometry_msgs/Quaternion
# This represents an orientation in free space in quaternion form.

float64 x 0
float64 y 0
float64 z 0
float64 w 1

{"=" * 80}
MSG: geometry_msgs/Vector3
# This represents a vector in free space.

# This is semantically different than a point.
# A vector is always anchored at the origin.
# When a transform is applied to a vector, only the rotational component is applied.

float64 x
float64 y
float64 z
"""

JSON_SCHEMA = "gyrodrift.Sample"
NUMBER_OR_NONE = {"type": ["number", "null"]}
OPTIONAL_NUMBERS = ("encoder_deg", "temp_c", "still")
SAMPLE_FIELDS = tuple(name for name in Sample._fields if name not in ("inertial", "device_yaw", "aids"))
ALWAYS_WRITTEN = ("t_device_s", "t_host_s", "rate_dps")
"""Null without a number; without `t_host_s` a reader would use the log time instead."""


def write_imu(path: Path, chunks: Iterable[Session]) -> None:
    """Write the consecutive chunks of a session as `sensor_msgs/msg/Imu` on `/imu`, rates in rad/s.

    Orientation is marked as unknown, and so is an acceleration that the session does not have. Encoder angle,
    temperature and counter are left out.

    Raises
    ------
    DataError
        A device time does not fit a stamp: not finite, or beyond 32 bits of seconds.
    UsageError
        The file cannot be written; nothing is left behind in either case.
    """
    from mcap_ros2.writer import Writer

    with whole_file(path) as file:
        writer = Writer(file)
        schema = writer.register_msgdef(IMU_SCHEMA, IMU_TEXT)
        for number, sample in enumerate(_samples(chunks, writer), 1):
            message = _imu(_stamp(path, number, sample.t_device_s), sample)
            writer.write_message(IMU_TOPIC, schema, message, _log_ns(sample), sequence=_sequence(sample))
        writer.finish()  # type: ignore[no-untyped-call]  # the package leaves it unannotated


def write_json(path: Path, chunks: Iterable[Session]) -> None:
    """Write the consecutive chunks of a session as JSON objects on `/gyro`, with all digits.

    A value that is not finite is left out; times and rate are null instead.

    Raises
    ------
    UsageError
        The file cannot be written; nothing is left behind.
    """
    from mcap.writer import Writer

    stream = iter(chunks)
    first = next(stream)
    with whole_file(path) as file:
        writer = Writer(file)
        writer.start(library=f"gyrodrift {__version__}")
        schema_id = writer.register_schema(JSON_SCHEMA, "jsonschema", _json_schema(first).encode())
        channel_id = writer.register_channel(SAMPLES.name, "json", schema_id)
        for sample in _samples(chain([first], stream), writer):
            log_ns = _log_ns(sample)
            writer.add_message(channel_id, log_ns, _json(sample), log_ns, _sequence(sample))
        writer.finish()  # type: ignore[no-untyped-call]  # the package leaves it unannotated


def _json_schema(session: Session) -> str:
    axes = () if session.gyro_dps is None else tuple(AXIS_COLUMNS)
    axes += () if session.device_yaw_deg is None else DEVICE_COLUMNS
    properties = {
        "seq": {"type": "integer"},
        **dict.fromkeys(ALWAYS_WRITTEN, NUMBER_OR_NONE),
        **{name: {"type": "number"} for name in (*OPTIONAL_NUMBERS, *axes)},
    }
    return json.dumps(
        {
            "type": "object",
            "description": "A rate sample of a gyro. Angles are degrees, rates deg/s counter-clockwise, times seconds.",
            "properties": properties,
            "required": ["t_device_s", "rate_dps"],
        }
    )


def _samples(chunks: Iterable[Session], writer: Any) -> Iterator[Sample]:
    """Yield the samples; the metadata of the first chunk is written before them."""
    for number, chunk in enumerate(chunks):
        for name, table in chunk.metadata.items() if number == 0 else ():
            writer.add_metadata(name, dict(table))
        columns = [chunk.filled(name).tolist() for name in SAMPLE_FIELDS]
        aids = aids_by_row(chunk.aids or ())
        columns += [_inertials(chunk), _device_yaws(chunk), [aids.get(row, ()) for row in range(len(chunk.rate_dps))]]
        yield from map(Sample._make, zip(*columns, strict=True))


def _inertials(chunk: Session) -> list[Inertial | None]:
    if chunk.gyro_dps is None:
        return [None] * len(chunk.rate_dps)
    return list(map(Inertial._make, zip(*(chunk.filled(name).tolist() for name in AXIS_COLUMNS), strict=True)))


def _device_yaws(chunk: Session) -> list[DeviceYaw | None]:
    if chunk.device_yaw_deg is None:
        return [None] * len(chunk.rate_dps)
    return list(map(DeviceYaw._make, zip(*(chunk.filled(name).tolist() for name in DEVICE_COLUMNS), strict=True)))


def _imu(stamp: dict[str, int], sample: Sample) -> dict[str, Any]:
    inertial = sample.inertial or Inertial(0.0, 0.0, sample.rate_dps)
    rates_rads, forces_mps2 = tuple(map(math.radians, inertial[:3])), inertial[3:]
    has_forces = all(map(math.isfinite, forces_mps2))
    return {
        "header": {"stamp": stamp, "frame_id": FRAME_ID},
        "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0},
        "orientation_covariance": [-1.0, *[0.0] * 8],
        "angular_velocity": _vector(rates_rads),
        "angular_velocity_covariance": [0.0] * 9,
        "linear_acceleration": _vector(forces_mps2 if has_forces else (0.0, 0.0, 0.0)),
        "linear_acceleration_covariance": [0.0 if has_forces else -1.0, *[0.0] * 8],
    }


def _vector(values: Sequence[float]) -> dict[str, float]:
    return dict(zip("xyz", values, strict=True))


def _stamp(path: Path, number: int, t_device_s: float) -> dict[str, int]:
    if math.isfinite(t_device_s):
        sec, nanosec = divmod(_ns(t_device_s), NS_PER_S)
        if sec in STAMP_SECONDS:
            return {"sec": sec, "nanosec": nanosec}
    raise DataError(f"{path}: sample {number} has {t_device_s!r} as t_device_s, which does not fit header.stamp")


def _json(sample: Sample) -> bytes:
    values = sample._asdict()
    inertial = values.pop("inertial")
    values |= inertial._asdict() if inertial else {}
    device_yaw = values.pop("device_yaw")
    values |= dict(zip(DEVICE_COLUMNS, device_yaw, strict=True)) if device_yaw else {}
    aids = list(map(aid_values, values.pop("aids")))
    fields: dict[str, Any] = {
        name: finite(value) for name, value in values.items() if name in ALWAYS_WRITTEN or math.isfinite(value)
    }
    if sample.seq < 0:
        del fields["seq"]
    fields |= {COLUMN: aids} if aids else {}
    return json.dumps(fields, allow_nan=False, separators=(",", ":")).encode()


def _sequence(sample: Sample) -> int:
    """Counter in the range of a message head; 0 without one."""
    return max(sample.seq, 0) & 0xFFFFFFFF


def _log_ns(sample: Sample) -> int:
    """Arrival time, or else device time, in the range of a message head, ns."""
    t_s = sample.t_host_s if math.isfinite(sample.t_host_s) else sample.t_device_s
    return min(max(_ns(t_s), 0), LATEST_LOG_NS) if math.isfinite(t_s) else 0


def _ns(seconds: float) -> int:
    """Nanoseconds without the rounding error of a product, so that whole nanoseconds are exact."""
    whole = math.floor(seconds)
    return whole * NS_PER_S + round((seconds - whole) * NS_PER_S)
