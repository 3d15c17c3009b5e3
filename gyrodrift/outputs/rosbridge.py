"""rosbridge v2: `sensor_msgs/Imu` as JSON over WebSocket, for roslibjs, roslibpy and other clients.

A client has subscriptions, status messages, and the services of `rosapi` that clients call.
Source: ROSBRIDGE_PROTOCOL.md of RobotWebTools/rosbridge_suite, and the behavior of rosbridge.
"""

import json
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Annotated, Any

from annotated_types import Gt, Le, MaxLen, MinLen

from gyrodrift.outputs.net.json_input import parse_json
from gyrodrift.outputs.net.servers import ServerOutput
from gyrodrift.outputs.net.websocket import WebSocketClient, WebSocketServer, WebSocketSession
from gyrodrift.outputs.options import LOOPBACK, About, Host, Port, Rate
from gyrodrift.outputs.output import OutputHost
from gyrodrift.outputs.ros_messages import IMU_TYPES, ImuMessage, RosVersion, stamp
from gyrodrift.outputs.thinning import SAME_TIME_S, Thinning
from gyrodrift.values.sample import Corrected

MOST_NAMES = 100
"""Most subscriptions, and most topics, of a client."""

LEVELS = ("none", "error", "warning", "info")
"""Levels of a status; each includes those before it. The default is error."""

LONGEST_THROTTLE_MS = 3_600_000

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


class RosbridgeSession(WebSocketSession):
    """Protocol state of one client."""

    def __init__(self, client: WebSocketClient, services: RosServices) -> None:
        self._client = client
        self._services = services
        self._throttles_s: dict[str | None, float] = {}
        self._opening = ""
        self._every_s = 0.0
        self._published_s = float("-inf")
        self._advertised: set[str] = set()
        self._level = "error"
        self._operations: dict[str, Callable[[dict[str, Any]], None]] = {
            "subscribe": self._subscribe,
            "unsubscribe": self._unsubscribe,
            "call_service": self._call_service,
            "advertise": self._advertise,
            "unadvertise": self._unadvertise,
            "set_level": self._set_level,
        }

    @property
    def has_subscribed(self) -> bool:
        """Whether the client has subscribed."""
        return bool(self._throttles_s)

    def publish(self, t_s: float, message: str) -> None:
        """Send a message of device time `t_s` if it is due; a clock may restart."""
        if 0.0 <= t_s - self._published_s < self._every_s - SAME_TIME_S:
            return
        self._published_s = t_s
        self._client.send(f"{self._opening}{message}}}")

    def message(self, content: str | bytes) -> None:
        """Carry out an operation. A mistake is answered with a status; the connection stays."""
        operation: Any = None
        try:
            operation = parse_json(content)
            self._take(operation)
        except ValueError as error:
            self._say("error", str(error), operation)

    def dropped(self, messages: int) -> str:
        """Status with the number of dropped messages."""
        return _status("error", f"{messages} messages dropped: this client reads too slowly")

    def _take(self, operation: Any) -> None:
        if not isinstance(operation, dict) or not isinstance(operation.get("op"), str):
            raise ValueError('expected an object with "op"')  # noqa: TRY004 - a mistake of the client
        name = operation["op"]
        if name not in self._operations:
            raise ValueError(f"{name[:40]} is not supported: clients can only read")
        self._operations[name](operation)

    def _subscribe(self, request: dict[str, Any]) -> None:
        topic = _text(request, "topic")
        if not self._services.is_ours(topic):
            raise ValueError(f"no topic {topic[:100]}; there is {self._services.topic}")
        kind = request.get("type")
        if kind and not same_type(kind, self._services.kind):
            raise ValueError(f"{topic} is of type {self._services.kind}, not {str(kind)[:100]}")
        throttle_s = _throttle_ms(request) / 1000.0
        if len(self._throttles_s) >= MOST_NAMES:
            raise ValueError(f"more than {MOST_NAMES} subscriptions")
        self._throttles_s[_id(request)] = throttle_s
        self._opening = f'{{"op":"publish","topic":{json.dumps(topic)},"msg":'
        self._update_interval()
        if request.get("compression") not in {None, "none"}:
            self._say("warning", "there is no compression; messages are plain JSON", request)

    def _unsubscribe(self, request: dict[str, Any]) -> None:
        if not self._services.is_ours(_text(request, "topic")):
            raise ValueError(f"there is no subscription to {request['topic'][:100]}")
        if _id(request) is None:
            self._throttles_s.clear()
        elif self._throttles_s.pop(_id(request), None) is None:
            self._say("warning", "there is no subscription with this id", request)
        self._update_interval()

    def _update_interval(self) -> None:
        self._every_s = min(self._throttles_s.values(), default=0.0)

    def _call_service(self, request: dict[str, Any]) -> None:
        service = _text(request, "service")
        args = request.get("args")
        response: dict[str, Any] = {"op": "service_response", "service": service}
        try:
            values = self._services.call(service, args if isinstance(args, dict) else {})
            response |= {"values": values, "result": True}
        except LookupError as error:
            response |= {"values": str(error.args[0]), "result": False}
        if "id" in request:
            response["id"] = request["id"]
        self._client.send(json.dumps(response))

    def _advertise(self, request: dict[str, Any]) -> None:
        topic, kind = with_slash(_text(request, "topic")), _text(request, "type")
        if self._services.is_ours(topic):
            raise ValueError(f"{topic} ({self._services.kind}) is published by gyrodrift, not as {kind[:100]}")
        if len(self._advertised) >= MOST_NAMES:
            raise ValueError(f"more than {MOST_NAMES} topics")
        self._advertised.add(topic)
        self._say("warning", f"there is no subscriber to {topic[:100]}", request)

    def _unadvertise(self, request: dict[str, Any]) -> None:
        topic = with_slash(_text(request, "topic"))
        if topic not in self._advertised:
            self._say("warning", f"{topic[:100]} was not advertised", request)
        self._advertised.discard(topic)

    def _set_level(self, request: dict[str, Any]) -> None:
        level = request.get("level")
        if level not in LEVELS:
            raise ValueError(f"level: expected one of {', '.join(LEVELS)}")
        self._level = level

    def _say(self, level: str, text: str, request: object = None) -> None:
        if LEVELS.index(level) <= LEVELS.index(self._level):
            self._client.send(_status(level, text, request))


def _status(level: str, text: str, request: object = None) -> str:
    status: dict[str, Any] = {"op": "status", "level": level, "msg": text}
    if isinstance(request, dict) and isinstance(request.get("id"), (str, int)):
        status["id"] = request["id"]
    return json.dumps(status)


def _text(request: dict[str, Any], name: str) -> str:
    value = request.get(name)
    if not isinstance(value, str) or not value:
        raise ValueError(f"{request['op']}: expected a text {name!r}")
    return value


def _id(request: dict[str, Any]) -> str | None:
    value = request.get("id")
    return None if value is None else str(value)


def _throttle_ms(request: dict[str, Any]) -> float:
    value = request.get("throttle_rate", 0)
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0 <= value <= LONGEST_THROTTLE_MS:
        raise ValueError(f"throttle_rate: expected the minimum time between messages, 0 to {LONGEST_THROTTLE_MS} ms")
    return float(value)


@dataclass(frozen=True, slots=True)
class RosbridgeOptions:
    """Address, rate and names."""

    host: Annotated[Host, About("address to listen on")] = LOOPBACK
    port: Annotated[Port, About("port to listen on; 0 takes a free one")] = 9090
    rate_hz: Annotated[Rate, About("at most this many messages a second of device time")] = None
    topic: Annotated[str, MinLen(1), MaxLen(200), About("topic of the Imu messages")] = "/imu/data"
    frame_id: Annotated[str, MaxLen(200), About("frame that the sensor is fixed to")] = "imu_link"
    ros: Annotated[RosVersion, About("version of ROS for header and type name")] = "ros2"
    rate_sigma_dps: Annotated[
        Annotated[float, Gt(0.0), Le(1000.0)] | None,
        About("standard deviation of one measured rate, deg/s; without it the covariance of the rate is unknown"),
    ] = None
    accel_sigma_mps2: Annotated[
        Annotated[float, Gt(0.0), Le(1000.0)] | None,
        About("standard deviation of one acceleration, m/s²; without it their covariance is unknown"),
    ] = None


class RosbridgeOutput(ServerOutput[RosbridgeOptions, WebSocketServer[RosbridgeSession]]):
    """One topic, and the services that clients call before they subscribe."""

    options_type = RosbridgeOptions

    def __init__(self, options: RosbridgeOptions, host: OutputHost) -> None:
        super().__init__(options, host)
        services = RosServices(f"/{options.topic.strip('/')}", IMU_TYPES[options.ros], options.ros)
        self.server = WebSocketServer(lambda client: RosbridgeSession(client, services), host.log)
        sigmas = options.rate_sigma_dps, options.accel_sigma_mps2
        self._message = ImuMessage(json.dumps(options.frame_id), options.ros, *sigmas)
        self._thinning = Thinning(options.rate_hz)

    async def open(self) -> None:
        """Begin to listen."""
        self.address = await self.server.listen(self.options.host, self.options.port)

    def take(self, samples: Sequence[Corrected]) -> None:
        """Publish to subscribers; each message is encoded once."""
        subscribed = [session for session in self.server.clients.values() if session.has_subscribed]
        if not subscribed:
            return
        for corrected in self._thinning.due(samples):
            message = self._message.json(corrected)
            for session in subscribed:
                session.publish(corrected.sample.t_device_s, message)
