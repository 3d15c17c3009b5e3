"""A corrected sample as `sensor_msgs/Imu` in JSON, with the axes of REP-103: x forward, y left, z up, yaw about z.

Source: sensor_msgs/msg/Imu.msg. Element 0 of a covariance is -1 without an estimate; a matrix of zeros is an unknown
covariance. A device with three axes sends all of its values in the frame of the sensor; accelerations include gravity
(REP 145).
"""

from collections.abc import Iterable
from math import cos, isfinite, isnan, modf, radians, sin
from typing import Literal

from gyrodrift.outputs.device_frame import corrected_rates_dps
from gyrodrift.values.sample import Attitude, Corrected, Inertial

RosVersion = Literal["ros2", "ros1"]

IMU_TYPES: dict[RosVersion, str] = {"ros2": "sensor_msgs/msg/Imu", "ros1": "sensor_msgs/Imu"}
"""Names of the type; clients use both."""

UNMEASURED_VARIANCE = 1e6
"""Variance of roll, pitch and their rates, rad² and (rad/s)²: so large that an estimator gives them no weight. A value
of -1 would make it disregard yaw, too."""

NOT_KNOWN = "[-1.0,0.0,0.0,0.0,-1.0,0.0,0.0,0.0,-1.0]"
NO_COVARIANCE = "[0.0,0.0,0.0,0.0,0.0,0.0,0.0,0.0,0.0]"


class ImuMessage:
    """Encodes `sensor_msgs/Imu` messages.

    Parameters
    ----------
    frame_id
        Frame as a JSON string with its quotes.
    rate_sigma_dps, accel_sigma_mps2
        Standard deviations of one measured rate, deg/s, and acceleration, m/s²; None if unknown.
    """

    def __init__(
        self, frame_id: str, ros: RosVersion, rate_sigma_dps: float | None, accel_sigma_mps2: float | None = None
    ) -> None:
        self._frame_id = frame_id
        self._is_ros1 = ros == "ros1"
        self._rate_sigma_dps = rate_sigma_dps
        self._accelerations = NO_COVARIANCE if accel_sigma_mps2 is None else _diagonal(*(accel_sigma_mps2**2,) * 3)

    def json(self, corrected: Corrected) -> str:
        """Message for one sample."""
        inertial, attitude = corrected.sample.inertial, corrected.attitude
        if inertial is None or attitude is None:
            return self._level(corrected)
        return self._tilted(corrected, inertial, attitude)

    def _level(self, corrected: Corrected) -> str:
        half_rad = radians(corrected.yaw_deg) / 2.0
        return (
            f'{{"header":{self._header(corrected)},'
            f'"orientation":{{"x":0.0,"y":0.0,"z":{sin(half_rad)!r},"w":{cos(half_rad)!r}}},'
            f'"orientation_covariance":{_orientation_covariance(corrected.yaw_sigma_deg)},'
            f'"angular_velocity":{{"x":0.0,"y":0.0,"z":{radians(corrected.corrected_dps)!r}}},'
            f'"angular_velocity_covariance":{self._rate_covariance(corrected.bias_sigma_dps)},'
            f'"linear_acceleration":{{"x":0.0,"y":0.0,"z":0.0}},'
            f'"linear_acceleration_covariance":{NOT_KNOWN}}}'
        )

    def _tilted(self, corrected: Corrected, inertial: Inertial, attitude: Attitude) -> str:
        w, *vector = attitude[:4]
        accelerations = inertial[3:]
        is_measured = all(isfinite(value) for value in accelerations)
        rate_variance = self._rate_variance(corrected.bias_sigma_dps)
        return (
            f'{{"header":{self._header(corrected)},'
            f'"orientation":{{{_xyz(vector)},"w":{w!r}}},'
            f'"orientation_covariance":{_tilt_covariance(attitude.tilt_sigma_deg, corrected.yaw_sigma_deg)},'
            f'"angular_velocity":{{{_xyz(map(radians, corrected_rates_dps(inertial, attitude)))}}},'
            f'"angular_velocity_covariance":{_diagonal(*(rate_variance,) * 3)},'
            f'"linear_acceleration":{{{_xyz(accelerations if is_measured else (0.0, 0.0, 0.0))}}},'
            f'"linear_acceleration_covariance":{self._accelerations if is_measured else NOT_KNOWN}}}'
        )

    def _header(self, corrected: Corrected) -> str:
        if self._is_ros1:
            seq = corrected.sample.seq & 0xFFFFFFFF
            return f'{{"seq":{seq},"stamp":{stamp(corrected.sample.t_host_s, "ros1")},"frame_id":{self._frame_id}}}'
        return f'{{"stamp":{stamp(corrected.sample.t_host_s, "ros2")},"frame_id":{self._frame_id}}}'

    def _rate_covariance(self, bias_sigma_dps: float) -> str:
        if self._rate_sigma_dps is None:
            return NO_COVARIANCE
        return _diagonal(UNMEASURED_VARIANCE, UNMEASURED_VARIANCE, self._rate_variance(bias_sigma_dps))

    def _rate_variance(self, bias_sigma_dps: float) -> float:
        """Variance of a corrected rate, (rad/s)²; 0 if unknown."""
        if self._rate_sigma_dps is None:
            return 0.0
        bias_rad_s = 0.0 if isnan(bias_sigma_dps) else radians(bias_sigma_dps)
        return radians(self._rate_sigma_dps) ** 2 + bias_rad_s**2


def stamp(unix_s: float, ros: RosVersion) -> str:
    """A time as JSON: `sec` and `nanosec`, or `secs` and `nsecs` in ROS 1."""
    fraction, whole = modf(unix_s)
    seconds, nanoseconds = ("secs", "nsecs") if ros == "ros1" else ("sec", "nanosec")
    return f'{{"{seconds}":{int(whole)},"{nanoseconds}":{int(fraction * 1e9)}}}'


def _orientation_covariance(yaw_sigma_deg: float) -> str:
    if isnan(yaw_sigma_deg):
        return NOT_KNOWN
    return _diagonal(UNMEASURED_VARIANCE, UNMEASURED_VARIANCE, radians(yaw_sigma_deg) ** 2)


def _tilt_covariance(tilt_sigma_deg: float, yaw_sigma_deg: float) -> str:
    if isnan(tilt_sigma_deg) or isnan(yaw_sigma_deg):
        return NOT_KNOWN
    tilt = radians(tilt_sigma_deg) ** 2
    return _diagonal(tilt, tilt, radians(yaw_sigma_deg) ** 2)


def _diagonal(x: float, y: float, z: float) -> str:
    return f"[{x!r},0.0,0.0,0.0,{y!r},0.0,0.0,0.0,{z!r}]"


def _xyz(vector: Iterable[float]) -> str:
    x, y, z = vector
    return f'"x":{x!r},"y":{y!r},"z":{z!r}'
