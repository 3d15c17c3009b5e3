"""Reference angle of a ROS message: the heading of a pose, or the position of a joint."""

import math
from operator import attrgetter
from typing import Any, NamedTuple

from gyrodrift.session.foreign.columns import WrongValueError, number, whole
from gyrodrift.values.constants import NS_PER_S
from gyrodrift.values.quaternion import yaw_of

ORIENTATIONS = {
    "nav_msgs/msg/Odometry": attrgetter("pose.pose.orientation"),
    "geometry_msgs/msg/PoseStamped": attrgetter("pose.orientation"),
    "geometry_msgs/msg/PoseWithCovarianceStamped": attrgetter("pose.pose.orientation"),
    "geometry_msgs/msg/TransformStamped": attrgetter("transform.rotation"),
}
"""Quaternion of a message, by its type."""

JOINTS = "sensor_msgs/msg/JointState"

TYPES = (*ORIENTATIONS, JOINTS)
"""Types of messages with a reference angle."""


class AngleReading(NamedTuple):
    """Reference angle of a message in degrees, with its stamp and the time of logging in s."""

    stamp_s: float
    logged_s: float
    angle_deg: float


def type_of(name: str) -> str:
    """Name of a type in the form of ROS 2; ROS 1 leaves out `msg`."""
    package, _, kind = name.partition("/")
    return name if kind.startswith("msg/") else f"{package}/msg/{kind}"


def reading_of(message: Any, kind: str, joint: str, log_ns: int) -> AngleReading:
    """Reading of a message of one of TYPES.

    joint
        Name of the joint; empty for the only one of a message.

    Raises
    ------
    WrongValueError
        The message has no stamp, no orientation, or no such joint.
    """
    try:
        stamp = message.header.stamp
        sec, nanosec = whole("header.stamp.sec", stamp.sec), whole("header.stamp.nanosec", stamp.nanosec)
        angle_deg = _joint_deg(message, joint) if kind == JOINTS else _heading_deg(ORIENTATIONS[kind](message))
    except (AttributeError, IndexError, TypeError) as error:
        raise WrongValueError(f"does not fit its type {kind}") from error
    return AngleReading((sec * NS_PER_S + nanosec) / NS_PER_S, log_ns / NS_PER_S, angle_deg)


def _heading_deg(quaternion: Any) -> float:
    """Heading of an orientation, degrees: the last of its three turns about z, y and x of the body."""
    x, y, z, w = (number(f"orientation.{name}", getattr(quaternion, name)) for name in "xyzw")
    if not math.hypot(x, y, z, w) > 0.0:
        raise WrongValueError("has no orientation: all parts of its quaternion are 0")
    return yaw_of(w, x, y, z)


def _joint_deg(message: Any, joint: str) -> float:
    names = list(message.name)
    if joint not in names and (joint or len(names) != 1):
        raise WrongValueError(f"has the joints {', '.join(names)}; choose one as TOPIC:JOINT")
    return math.degrees(number("position", float(message.position[names.index(joint) if joint else 0])))
