"""Services of `rosapi` about one node with one topic, which rosbridge clients call."""

import json
import time
from collections.abc import Callable
from typing import Any

from gyrodrift.outputs.ros_messages import RosVersion, stamp

NODE = "/gyrodrift"
Args = dict[str, Any]


class RosServices:
    """Answers of the services.

    Parameters
    ----------
    topic
        Topic with its leading slash.
    kind
        Type of the topic.
    """

    def __init__(self, topic: str, kind: str, ros: RosVersion) -> None:
        self.topic = topic
        self.kind = kind
        self._ros: RosVersion = ros
        self._answers: dict[str, tuple[str, Callable[[Args], Any]]] = {
            "/rosapi/topics": ("Topics", lambda _: {"topics": [topic], "types": [kind]}),
            "/rosapi/topic_type": ("TopicType", lambda args: {"type": kind if self.is_ours(args.get("topic")) else ""}),
            "/rosapi/topics_for_type": (
                "TopicsForType",
                lambda args: {"topics": [topic] if same_type(args.get("type"), kind) else []},
            ),
            "/rosapi/publishers": (
                "Publishers",
                lambda args: {"publishers": [NODE] if self.is_ours(args.get("topic")) else []},
            ),
            "/rosapi/subscribers": ("Subscribers", lambda _: {"subscribers": []}),
            "/rosapi/nodes": ("Nodes", lambda _: {"nodes": [NODE]}),
            "/rosapi/node_details": ("NodeDetails", self._node_details),
            "/rosapi/services": ("Services", lambda _: {"services": list(self._answers)}),
            "/rosapi/service_type": ("ServiceType", lambda args: {"type": self._type(with_slash(args.get("service")))}),
            "/rosapi/services_for_type": (
                "ServicesForType",
                lambda args: {"services": [name for name in self._answers if self._type(name) == args.get("type")]},
            ),
            "/rosapi/action_servers": ("GetActionServers", lambda _: {"action_servers": []}),
            "/rosapi/get_param_names": ("GetParamNames", lambda _: {"names": []}),
            "/rosapi/get_time": ("GetTime", lambda _: {"time": json.loads(stamp(time.time(), self._ros))}),
        }

    def is_ours(self, topic: object) -> bool:
        """Whether a name, with or without leading slash, is the topic."""
        return with_slash(topic) == self.topic

    def call(self, service: str, args: Args) -> Any:
        """Values of the response.

        Raises
        ------
        LookupError
            If there is no such service, with the existing services.
        """
        name = with_slash(service)
        if name not in self._answers:
            raise LookupError(f"no service {service[:100]}; there are {', '.join(self._answers)}")
        return self._answers[name][1](args)

    def _node_details(self, args: Args) -> Any:
        is_ours = with_slash(args.get("node")) == NODE
        return {
            "subscribing": [],
            "publishing": [self.topic] if is_ours else [],
            "services": list(self._answers) if is_ours else [],
        }

    def _type(self, service: str) -> str:
        middle = "rosapi_msgs/srv" if self._ros == "ros2" else "rosapi"
        return f"{middle}/{self._answers[service][0]}" if service in self._answers else ""


def with_slash(name: object) -> str:
    """A name of ROS with its leading slash, such as `/imu/data`."""
    return f"/{name.strip('/')}" if isinstance(name, str) else ""


def same_type(first: object, second: str) -> bool:
    """Whether two types are equal; `sensor_msgs/Imu` equals `sensor_msgs/msg/Imu`."""
    return isinstance(first, str) and first.replace("/msg/", "/") == second.replace("/msg/", "/")
