"""A ROS 2 node in one file: a cheap gyro on a serial port as `sensor_msgs/Imu`, with corrected drift.

Run it where ROS 2 is sourced and gyrodrift is installed:

    python ros2_node.py --ros-args -p port:=/dev/ttyUSB0 -p frame_id:=imu_link

Axes are those of REP 103: z up, counter-clockwise positive, rad and rad/s. A device with one axis measures only yaw. A
device with three axes and an accelerometer has an attitude and accelerations too, in the frame of the sensor (REP 145).
"""

import sys
from math import cos, isfinite, radians, sin
from typing import Any, NamedTuple

from gyrodrift import AttitudeEstimate, AttitudeFilter, Estimate, Restlevel, open_link
from gyrodrift.sample import Inertial, Sample

READ_S = 0.005
"""How often the port is read, s."""

UNKNOWN = 1e6
"""Variance of an angle or rate that is not measured, rad²."""

NOT_MEASURED = -1.0
"""First element of the covariance of a quantity that is not in the message."""


Vector = tuple[float, float, float]


class ImuFields(NamedTuple):
    """Values of the message: quaternion x, y, z, w; rates in rad/s; covariances of 3 x 3, row by row; m/s² or None."""

    orientation: tuple[float, float, float, float]
    rates_rad_s: Vector
    orientation_covariance: tuple[float, ...]
    rate_covariance: tuple[float, ...]
    acceleration_covariance: tuple[float, ...]
    accelerations_mps2: Vector | None = None


def diagonal(x: float, y: float, z: float) -> tuple[float, ...]:
    """A covariance without correlations."""
    return (x, 0.0, 0.0, 0.0, y, 0.0, 0.0, 0.0, z)


def variance(sigma_deg: float) -> float:
    """Variance in rad² or (rad/s)² of a standard deviation in deg or deg/s; `UNKNOWN` for NaN."""
    return radians(sigma_deg) ** 2 if isfinite(sigma_deg) else UNKNOWN


def fields_of(estimate: Estimate, rate_dps: float) -> ImuFields:
    """Values of a sample. The variance of the rate is the variance of its bias: the filter knows no other."""
    half_rad = radians(estimate.yaw_deg) / 2.0
    return ImuFields(
        orientation=(0.0, 0.0, sin(half_rad), cos(half_rad)),
        rates_rad_s=(0.0, 0.0, radians(rate_dps - estimate.bias_dps)),
        orientation_covariance=diagonal(UNKNOWN, UNKNOWN, variance(estimate.yaw_sigma_deg)),
        rate_covariance=diagonal(UNKNOWN, UNKNOWN, variance(estimate.bias_sigma_dps)),
        acceleration_covariance=diagonal(NOT_MEASURED, 0.0, 0.0),
    )


def tilted_fields(estimate: AttitudeEstimate, inertial: Inertial) -> ImuFields:
    """Values of a sample with three axes. Zeros are an unknown covariance: the filter knows no noise of the sensors."""
    gx, gy, gz, ax, ay, az = inertial
    is_measured = isfinite(ax + ay + az)
    tilt = variance(estimate.tilt_sigma_deg)
    return ImuFields(
        orientation=(estimate.q_x, estimate.q_y, estimate.q_z, estimate.q_w),
        rates_rad_s=(
            radians(gx - estimate.bias_x_dps),
            radians(gy - estimate.bias_y_dps),
            radians(gz - estimate.bias_z_dps),
        ),
        orientation_covariance=diagonal(tilt, tilt, variance(estimate.yaw_sigma_deg)),
        rate_covariance=diagonal(0.0, 0.0, 0.0),
        acceleration_covariance=diagonal(0.0 if is_measured else NOT_MEASURED, 0.0, 0.0),
        accelerations_mps2=(ax, ay, az) if is_measured else None,
    )


class Corrector:
    """Filters samples; it goes over to three axes with the first sample that has accelerations."""

    def __init__(self) -> None:
        self._level = Restlevel()
        self._tilted: AttitudeFilter | None = None

    def take(self, sample: Sample) -> ImuFields | None:
        """Values of the message; None for a sample that the filter rejects."""
        inertial = sample.inertial
        if inertial is not None and self._tilted is None and isfinite(sum(inertial)):
            self._tilted = AttitudeFilter()
        if inertial is None or self._tilted is None:
            estimate = self._level.update_at(sample.rate_dps, sample.t_device_s)
            return fields_of(estimate, sample.rate_dps) if estimate.is_accepted else None
        tilted = self._tilted.update_at(inertial[:3], inertial[3:], t_s=sample.t_device_s)
        return tilted_fields(tilted, inertial) if tilted.is_accepted else None


def fill(message: Any, fields: ImuFields) -> Any:
    """Write the fields into a `sensor_msgs/Imu`."""
    turn, rates = message.orientation, message.angular_velocity
    turn.x, turn.y, turn.z, turn.w = fields.orientation
    rates.x, rates.y, rates.z = fields.rates_rad_s
    if fields.accelerations_mps2 is not None:
        forces = message.linear_acceleration
        forces.x, forces.y, forces.z = fields.accelerations_mps2
    message.orientation_covariance = list(fields.orientation_covariance)
    message.angular_velocity_covariance = list(fields.rate_covariance)
    message.linear_acceleration_covariance = list(fields.acceleration_covariance)
    return message


def main() -> None:
    """Publish until the node is shut down."""
    try:
        import rclpy  # noqa: PLC0415 - comes with ROS 2
        from rclpy.qos import qos_profile_sensor_data  # noqa: PLC0415
        from rclpy.time import Time  # noqa: PLC0415
        from sensor_msgs.msg import Imu  # noqa: PLC0415
    except ImportError as error:
        sys.exit(f"this node needs {error.name}: source ROS 2 first (source /opt/ros/<distribution>/setup.bash)")

    rclpy.init()
    node = rclpy.create_node("gyrodrift")
    port = node.declare_parameter("port", "/dev/ttyUSB0").value
    frame_id = node.declare_parameter("frame_id", "imu_link").value
    publisher = node.create_publisher(Imu, "imu/data", qos_profile_sensor_data)
    corrector = Corrector()
    with open_link(port, on_event=lambda event, **fields: node.get_logger().info(f"{event} {fields}")) as link:

        def publish() -> None:
            for sample in link.read():
                fields = corrector.take(sample)
                if fields is not None:
                    message = fill(Imu(), fields)
                    message.header.frame_id = frame_id
                    message.header.stamp = Time(nanoseconds=round(sample.t_host_s * 1e9)).to_msg()
                    publisher.publish(message)

        node.create_timer(READ_S, publish)
        try:
            rclpy.spin(node)
        except KeyboardInterrupt:
            pass
        finally:
            node.destroy_node()
            rclpy.try_shutdown()


if __name__ == "__main__":
    main()
