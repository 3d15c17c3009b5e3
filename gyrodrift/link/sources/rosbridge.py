"""Source `ws://HOST[:9090]/TOPIC`: a topic of sensor_msgs/Imu from a rosbridge server. `wss://` uses TLS.

Source: ROSBRIDGE_PROTOCOL.md of RobotWebTools/rosbridge_suite.
"""

import json
from collections.abc import Mapping
from dataclasses import replace
from math import degrees, isfinite
from typing import TYPE_CHECKING, Any

from gyrodrift.link.port import PortGoneError
from gyrodrift.link.protocols.batch import ReadingBatch, batch_protocol
from gyrodrift.link.protocols.decoder import DeviceDescription
from gyrodrift.link.protocols.plausible import inertial_of
from gyrodrift.link.sources.source import ByteSource, SourceAddress, SourcePort
from gyrodrift.link.sources.stream_channel import (
    TLS_OPTIONS,
    StreamChannel,
    connected_socket,
    host_and_path,
    tls_context,
)
from gyrodrift.values.constants import CLOCK_MASK
from gyrodrift.values.errors import LinkError, UsageError, shortened
from gyrodrift.values.sample import Reading
from gyrodrift.values.vectors import Vector

if TYPE_CHECKING:
    from websockets.uri import WebSocketURI

MISSING = -1.0
LONGEST_STAMP_S = 1 << 63
LONGEST_FRAME_ID = 64


class ImuReadings:
    """Readings of messages; without a stamp in the first one, messages have no clock.

    device
        Frame of the first message.
    """

    def __init__(self) -> None:
        self.device = DeviceDescription()
        self._is_timed: bool | None = None

    def reading(self, message: Mapping[str, Any]) -> Reading | None:
        """Reading of a message; None without plausible rates."""
        rates = _vector(message, "angular_velocity")
        inertial = rates and inertial_of(tuple(map(degrees, rates)), _vector(message, "linear_acceleration"))
        if inertial is None:
            return None
        t_us = self._time_us(message)
        if self._is_timed and t_us is None:
            return None
        return Reading(t_us if self._is_timed else None, None, inertial.gyro_z_dps, inertial=inertial)

    def _time_us(self, message: Mapping[str, Any]) -> int | None:
        """Stamp of a message; the first one decides whether there is a clock."""
        header = message.get("header")
        t_us = _stamp_us(header.get("stamp")) if isinstance(header, dict) else None
        if self._is_timed is None:
            self._is_timed = t_us is not None
            frame_id = str(header.get("frame_id", ""))[:LONGEST_FRAME_ID] if isinstance(header, dict) else ""
            self.device = DeviceDescription(frame_id or "sensor_msgs/Imu", axes=3)
        return t_us


def message_of(content: bytes) -> dict[str, Any] | None:
    """Message of a publication; None if it is none."""
    try:
        publication = json.loads(content)
    except (ValueError, RecursionError):
        return None
    message = publication.get("msg") if isinstance(publication, dict) else None
    return message if isinstance(message, dict) else None


def _vector(message: Mapping[str, Any], name: str) -> Vector | None:
    """Three finite numbers of a field; None if they are missing, or the covariance says so."""
    vector, covariance = message.get(name), message.get(f"{name}_covariance")
    if not isinstance(vector, dict) or (isinstance(covariance, list) and covariance[:1] == [MISSING]):
        return None
    try:
        x, y, z = (float(vector[axis]) for axis in "xyz")
    except (KeyError, TypeError, ValueError, OverflowError):
        return None
    return (x, y, z) if isfinite(x) and isfinite(y) and isfinite(z) else None


def _stamp_us(stamp: object) -> int | None:
    """Stamp in µs; None without one, or for 0, which drivers without a clock send."""
    if not isinstance(stamp, dict):
        return None
    seconds, nanoseconds = (stamp.get(new, stamp.get(old)) for new, old in (("sec", "secs"), ("nanosec", "nsecs")))
    if not isinstance(seconds, int) or not isinstance(nanoseconds, int) or abs(seconds) >= LONGEST_STAMP_S:
        return None
    return (seconds * 1_000_000 + nanoseconds // 1000) & CLOCK_MASK if seconds or nanoseconds else None


ROSBRIDGE_PROTOCOL = batch_protocol(
    "rosbridge",
    "sensor_msgs/Imu as JSON of rosbridge",
    "the topic is no sensor_msgs/Imu, or its angular velocity is marked as missing; see ros2 topic info",
)


USUAL_PORT = 9090
TLS = "wss"
TYPE = "sensor_msgs/Imu"
"""Name of ROS 1, which servers of ROS 2 take too; a server without the type cannot subscribe before the publisher."""

ANY_TYPE = "any"
"""Type in an address for the one of the publisher, which must be there before."""

LONGEST_MESSAGE_BYTES = 64 << 10
"""Longest message of the server."""

LONGEST_PUBLICATION_BYTES = 4096
"""Longest message with a measurement: one of sensor_msgs/Imu has about 1 kB."""

LONGEST_REASON = 200


class RosbridgePort(SourcePort):
    """Subscription to a topic."""

    def __init__(self, channel: StreamChannel, uri: "WebSocketURI") -> None:
        from websockets.client import ClientProtocol

        super().__init__(channel.path, channel.fd)
        self._channel = channel
        self._protocol: ClientProtocol = ClientProtocol(uri, max_size=LONGEST_MESSAGE_BYTES)
        self._readings = ImuReadings()
        self._parts: list[bytes] = []
        self._has_told = False

    def subscribe(self, topic: str, kind: str = TYPE) -> None:
        """Shake hands and subscribe to messages of a type; ANY_TYPE for that of the publisher.

        Raises
        ------
        LinkError
            The peer is no WebSocket server.
        """
        self._protocol.send_request(self._protocol.connect())
        self._flush()
        while self._protocol.handshake_exc is None and self._protocol.state.name == "CONNECTING":
            self._protocol.receive_data(self._channel.wait())
        if self._protocol.handshake_exc is not None:
            reason = shortened(str(self._protocol.handshake_exc), LONGEST_REASON)
            raise LinkError(f"{self.path}: this is no rosbridge server: {reason}")
        if self._protocol.close_expected():
            raise LinkError(f"{self.path}: the server ends the connection: {self._end_reason()}")
        request = {"op": "subscribe", "topic": topic, **({} if kind == ANY_TYPE else {"type": kind})}
        self._protocol.send_text(json.dumps(request).encode())
        self._flush()

    def read(self) -> ReadingBatch:
        """Messages that have arrived, up to a limit, without waiting."""
        chunk = self._channel.read()
        self.wake_s = self._channel.wake_s
        if chunk:
            self._protocol.receive_data(chunk)
        batch = ReadingBatch()
        for message in self._messages():
            self._take(message, batch)
        batch.device = self._readings.device
        self._flush()
        if self._protocol.close_expected():
            self.note("source_refused", reason=self._end_reason())
            raise PortGoneError(self.path)
        return batch

    def close(self) -> None:
        """Close the connection."""
        self._channel.close()

    def _end_reason(self) -> str:
        """Reason why the connection ends."""
        reason = self._protocol.close_reason or str(self._protocol.parser_exc or "the server closes")
        return shortened(reason, LONGEST_REASON)

    def _messages(self) -> list[bytes]:
        """Complete messages; a message may come in several frames."""
        from websockets.frames import DATA_OPCODES, Frame

        messages: list[bytes] = []
        for event in self._protocol.events_received():
            if isinstance(event, Frame) and event.opcode in DATA_OPCODES:
                if event.data:  # empty frames cost no memory
                    self._parts.append(bytes(event.data))
                if event.fin:
                    messages.append(b"".join(self._parts))
                    self._parts = []
        return messages

    def _take(self, message: bytes, batch: ReadingBatch) -> None:
        """Read a publication; other messages report problems."""
        if len(message) > LONGEST_PUBLICATION_BYTES:
            self._tell("source_refused", reason=f"a message of {len(message)} bytes is no {TYPE}")
        elif b'"publish"' in message:
            published = message_of(message)
            if published is None:
                batch.add_damaged(message)
            else:
                batch.add(message, self._readings.reading(published))
        elif b'"status"' in message:
            self._tell("rosbridge_status", message=_status_of(message))

    def _tell(self, event: str, **fields: Any) -> None:
        if not self._has_told:
            self._has_told = True
            self.note(event, **fields)

    def _flush(self) -> None:
        for content in self._protocol.data_to_send():
            if content:
                self._channel.send(content)


def open_rosbridge(address: SourceAddress) -> RosbridgePort:
    """Connect to a rosbridge server and subscribe.

    Raises
    ------
    UsageError
        The address has a mistake.
    LinkError
        The server is absent, or is none.
    """
    from websockets.uri import parse_uri

    rest, options = address.split_query(("type", *TLS_OPTIONS))
    host, port, topic = host_and_path(address, rest, USUAL_PORT)
    if not topic:
        raise UsageError(
            f"--port {address.text}: expected {address.scheme}://HOST[:{USUAL_PORT}]/TOPIC, such as /imu/data"
        )
    context = tls_context(address, options) if address.scheme == TLS else None
    channel = StreamChannel(address.text, connected_socket(address, host, port, context))
    try:
        authority = f"[{host}]:{port}" if ":" in host else f"{host}:{port}"
        subscription = RosbridgePort(channel, parse_uri(f"{address.scheme}://{authority}/"))
        subscription.subscribe(f"/{topic}", options.get("type", TYPE))
    except PortGoneError as error:
        channel.close()
        raise LinkError(f"{address.text}: the server ends the connection") from error
    except BaseException:
        channel.close()
        raise
    return subscription


def _status_of(message: bytes) -> str:
    """Text of a status message."""
    try:
        return shortened(str(json.loads(message).get("msg")), LONGEST_REASON)
    except (ValueError, AttributeError, RecursionError):
        return "unreadable"


WS = ByteSource(
    "ws",
    f"ws://HOST[:{USUAL_PORT}]/TOPIC",
    "a topic of sensor_msgs/Imu from a rosbridge server",
    open_rosbridge,
    protocol=ROSBRIDGE_PROTOCOL,
    packages=("websockets",),
    extra="websocket",
    silence="nothing is published on this topic; list the topics with 'ros2 topic list', and see 'ros2 topic hz TOPIC'",
)
WSS = replace(WS, scheme=TLS, title=f"wss://HOST[:{USUAL_PORT}]/TOPIC", about="the same with TLS")
