"""A ROS 2 node in one file: a cheap gyro on a serial port as `sensor_msgs/Imu`, with corrected drift.

Run it where ROS 2 is sourced and gyrodrift is installed:

    python ros2_node.py --ros-args -p port:=/dev/ttyUSB0 -p frame_id:=imu_link

Axes are those of REP 103: z up, counter-clockwise positive, rad and rad/s. Only yaw is measured.
"""

import sys
from math import cos, isfinite, radians, sin
from typing import Any, NamedTuple

from gyrodrift import Estimate, Restlevel, open_link

READ_S = 0.005
"""How often the port is read, s."""

UNKNOWN = 1e6
"""Variance of an angle or rate that is not measured, rad²."""

NOT_MEASURED = -1.0
"""First element of the covariance of a quantity that is not in the message."""


class ImuFields(NamedTuple):
    """Values of the message: quaternion z and w, rate about z in rad/s, covariances of 3 x 3, row by row."""

    z: float
    w: float
    rate_rad_s: float
    orientation_covariance: tuple[float, ...]
    rate_covariance: tuple[float, ...]
    acceleration_covariance: tuple[float, ...]


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
        z=sin(half_rad),
        w=cos(half_rad),
        rate_rad_s=radians(rate_dps - estimate.bias_dps),
        orientation_covariance=diagonal(UNKNOWN, UNKNOWN, variance(estimate.yaw_sigma_deg)),
        rate_covariance=diagonal(UNKNOWN, UNKNOWN, variance(estimate.bias_sigma_dps)),
        acceleration_covariance=diagonal(NOT_MEASURED, 0.0, 0.0),
    )


def fill(message: Any, fields: ImuFields) -> Any:
    """Write the fields into a `sensor_msgs/Imu`."""
    message.orientation.z, message.orientation.w = fields.z, fields.w
    message.angular_velocity.z = fields.rate_rad_s
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
    drift = Restlevel()
    with open_link(port, on_event=lambda event, **fields: node.get_logger().info(f"{event} {fields}")) as link:

        def publish() -> None:
            for sample in link.read():
                estimate = drift.update_at(sample.rate_dps, sample.t_device_s)
                if estimate.is_accepted:
                    message = fill(Imu(), fields_of(estimate, sample.rate_dps))
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
