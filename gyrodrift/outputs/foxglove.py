"""A server for the Foxglove app: samples, pose, state of the filter, and statistics of the link."""

import json
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from math import isnan
from types import NoneType, UnionType
from typing import Annotated, Any, get_args, get_origin, get_type_hints

from gyrodrift.outputs.device_frame import UNTURNED, DeviceFrame
from gyrodrift.outputs.fields import CHOICES
from gyrodrift.outputs.foxglove_session import FoxgloveChannel, FoxgloveSession, Parameters, opening
from gyrodrift.outputs.json_line import json_line
from gyrodrift.outputs.net.servers import ServerOutput
from gyrodrift.outputs.net.websocket import WebSocketClient, WebSocketServer
from gyrodrift.outputs.options import LOOPBACK, About, Host, Port, Rate
from gyrodrift.outputs.output import OutputHost
from gyrodrift.outputs.status import ConfigStatus, FilterStatus, LinkStatus, ServiceStatus
from gyrodrift.outputs.thinning import Thinning
from gyrodrift.values.constants import NS_PER_S
from gyrodrift.values.sample import Corrected

SUBPROTOCOLS = ("foxglove.sdk.v1", "foxglove.websocket.v1")
"""Present and former name of the protocol; the app and its forks request one or both."""

TYPES = {int: "integer", float: "number", str: "string", bool: "boolean", dict: "object"}
NUMBER: dict[str, Any] = {"type": "number"}
NUMBERS = {"type": "array", "items": NUMBER}


def _object(properties: Mapping[str, Any]) -> dict[str, Any]:
    """Schema of an object. Unknown values are omitted, so no property is required."""
    return {"type": "object", "properties": dict(properties)}


def schema_of(title: str, record: type[Any]) -> dict[str, Any]:
    """Schema of a dataclass of plain values."""
    hints = get_type_hints(record)
    return {"title": title, **_object({field.name: {"type": _type_of(hints[field.name])} for field in fields(record)})}


def _type_of(hint: Any) -> str:
    if isinstance(hint, UnionType):
        hint = next(option for option in get_args(hint) if option is not NoneType)
    return TYPES[get_origin(hint) or hint]


SAMPLE_SCHEMA = {
    "title": "gyrodrift.Sample",
    **_object(
        {
            name: NUMBERS if field.is_list else {"type": "number" if field.decimals else "integer"}
            for name, field in CHOICES.items()
        }
    ),
}

VECTOR, QUATERNION = (_object(dict.fromkeys(names, NUMBER)) for names in ("xyz", "xyzw"))
POSE_SCHEMA = {
    "title": "foxglove.PoseInFrame",
    **_object(
        {
            "timestamp": _object({"sec": {"type": "integer"}, "nsec": {"type": "integer"}}),
            "frame_id": {"type": "string"},
            "pose": _object({"position": VECTOR, "orientation": QUATERNION}),
        }
    ),
}
"""Schema that the app draws as a pose; source: schemas/jsonschema/PoseInFrame.json of foxglove/foxglove-sdk."""

SAMPLE = FoxgloveChannel(1, "/gyro/sample", SAMPLE_SCHEMA)
STATE = FoxgloveChannel(2, "/gyro/state", schema_of("gyrodrift.State", FilterStatus))
LINK = FoxgloveChannel(3, "/gyro/link_stats", schema_of("gyrodrift.LinkStats", LinkStatus))
CHANNELS = (SAMPLE, STATE, LINK)

POSE = FoxgloveChannel(4, "/gyro/pose", POSE_SCHEMA)
"""Attitude of a device with three axes; advertised with the first sample that has one."""

POSE_FRAME = "world"
"""Frame of the pose, with z up."""


@dataclass(frozen=True, slots=True)
class FoxgloveOptions:
    """Address and rate."""

    host: Annotated[Host, About("address to listen on")] = LOOPBACK
    port: Annotated[Port, About("port to listen on; 0 takes a free one")] = 8765
    rate_hz: Annotated[Rate, About("at most this many samples a second of device time")] = None


class FoxgloveOutput(ServerOutput[FoxgloveOptions, WebSocketServer[FoxgloveSession]]):
    """Three channels, a fourth for attitude, and the config in force as read-only parameters."""

    options_type = FoxgloveOptions

    def __init__(self, options: FoxgloveOptions, host: OutputHost) -> None:
        super().__init__(options, host)
        self._thinning = Thinning(options.rate_hz)
        self.server = WebSocketServer(self._session, host.log, subprotocols=SUBPROTOCOLS)
        self._parameters: Parameters = {}
        self._mount = UNTURNED
        self._channels: tuple[FoxgloveChannel, ...] = CHANNELS
        self._session_id = str(time.time_ns())

    async def open(self) -> None:
        """Begin to listen."""
        self.address = await self.server.listen(self.options.host, self.options.port)

    def take(self, samples: Sequence[Corrected]) -> None:
        """Send samples and poses to subscribers; each message is encoded once."""
        if samples[-1].attitude is not None and POSE not in self._channels:
            self._advertise(POSE)
        takers, pose_takers = self._subscribed(SAMPLE), self._subscribed(POSE)
        if not takers and not pose_takers:
            return
        for corrected in self._thinning.due(samples):
            _publish(takers, SAMPLE, corrected, _sample)
            if corrected.attitude is not None:
                _publish(pose_takers, POSE, corrected, self._pose)

    def note(self, status: ServiceStatus) -> None:
        """Send state and statistics, and parameters that have changed."""
        self._set_parameters(parameters_of(status.config))
        self._mount = DeviceFrame.of(status.config.mount)
        for channel, record in ((STATE, status.filter), (LINK, status.link)):
            if subscribed := self._subscribed(channel):
                time_ns, message = time.time_ns(), _present_fields(record)
                for session in subscribed:
                    session.publish(channel.number, time_ns, message)

    def _subscribed(self, channel: FoxgloveChannel) -> list[FoxgloveSession]:
        return [session for session in self.server.clients.values() if session.has_subscribed(channel.number)]

    def _set_parameters(self, values: Parameters) -> None:
        changed = {name for name, value in values.items() if self._parameters.get(name) != value}
        self._parameters = values
        if changed:
            for session in self.server.clients.values():
                session.tell_parameters(changed)

    def _advertise(self, channel: FoxgloveChannel) -> None:
        self._channels += (channel,)
        for session in self.server.clients.values():
            session.advertise(channel)

    def _pose(self, corrected: Corrected) -> bytes:
        """PoseInFrame with the attitude of the device at the origin."""
        assert corrected.attitude is not None  # noqa: S101 - the caller has checked it
        w, x, y, z = self._mount.attitude(corrected.attitude, corrected.yaw_deg, corrected.yaw_deg)
        nanoseconds = _time_ns(corrected)
        message = {
            "timestamp": {"sec": nanoseconds // NS_PER_S, "nsec": nanoseconds % NS_PER_S},
            "frame_id": POSE_FRAME,
            "pose": {"position": {"x": 0, "y": 0, "z": 0}, "orientation": {"x": x, "y": y, "z": z, "w": w}},
        }
        return json.dumps(message).encode()

    def _session(self, client: WebSocketClient) -> FoxgloveSession:
        for message in opening(self._channels, self._session_id):
            client.send_first(message)
        return FoxgloveSession(client, self._channels, lambda: self._parameters)


def parameters_of(config: ConfigStatus) -> Parameters:
    """The config in force: the file, the filter, and its parameters by `FILTER.NAME`."""
    named: Parameters = {f"{config.filter}.{name}": value for name, value in config.params.items()}
    return {"filter": config.filter, "config": config.file or "", **named}


def _publish(
    sessions: Sequence[FoxgloveSession],
    channel: FoxgloveChannel,
    corrected: Corrected,
    encode: Callable[[Corrected], bytes],
) -> None:
    """Encode a message once for all sessions."""
    if sessions:
        time_ns, message = _time_ns(corrected), encode(corrected)
        for session in sessions:
            session.publish(channel.number, time_ns, message)


def _time_ns(corrected: Corrected) -> int:
    return int(corrected.sample.t_host_s * NS_PER_S)


def _sample(corrected: Corrected) -> bytes:
    start = f'{{"t_host_s":{corrected.sample.t_host_s!r},'
    if not isnan(corrected.raw_yaw_deg):
        start += f'"raw_yaw_deg":{corrected.raw_yaw_deg!r},'
    return json_line(corrected, start).encode()


def _present_fields(record: Any) -> bytes:
    return json.dumps({name: value for name, value in asdict(record).items() if value is not None}).encode()
