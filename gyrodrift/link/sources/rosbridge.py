"""Source `ws://HOST[:9090]/TOPIC`: a topic of sensor_msgs/Imu from a rosbridge server. `wss://` uses TLS.

Source: ROSBRIDGE_PROTOCOL.md of RobotWebTools/rosbridge_suite.
"""

import json
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from gyrodrift.link.port import PortGoneError
from gyrodrift.link.sources.packets import LONGEST_BYTES, packet
from gyrodrift.link.sources.query import split_query
from gyrodrift.link.sources.ros_imu import MESSAGE, ROSBRIDGE_PROTOCOL
from gyrodrift.link.sources.source import ByteSource, SourceAddress, SourcePort
from gyrodrift.link.sources.stream_channel import TLS_OPTIONS, StreamChannel, host_and_path, open_channel, tls_context
from gyrodrift.values.errors import LinkError, UsageError, shortened

if TYPE_CHECKING:
    from websockets.uri import WebSocketURI

USUAL_PORT = 9090
TLS = "wss"
TYPE = "sensor_msgs/Imu"
"""Name of ROS 1, which servers of ROS 2 take too; a server without the type cannot subscribe before the publisher."""

LONGEST_MESSAGE_BYTES = 64 << 10
"""Longest message of the server; one of sensor_msgs/Imu has about 1 kB."""

LONGEST_REASON = 200


class RosbridgePort(SourcePort):
    """Subscription to a topic; its messages become packets."""

    def __init__(self, channel: StreamChannel, uri: "WebSocketURI") -> None:
        from websockets.client import ClientProtocol

        super().__init__(channel.path, channel.fd)
        self._channel = channel
        self._protocol: ClientProtocol = ClientProtocol(uri, max_size=LONGEST_MESSAGE_BYTES)
        self._parts: list[bytes] = []
        self._has_told = False

    def subscribe(self, topic: str) -> None:
        """Shake hands and subscribe.

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
        request = {"op": "subscribe", "topic": topic, "type": TYPE}
        self._protocol.send_text(json.dumps(request).encode())
        self._flush()
        self._channel.start()

    def read(self) -> bytes:
        """Packets of the messages that have arrived, up to a limit, without waiting."""
        chunk = self._channel.receive()
        self.wake_s = 0.0 if self._channel.has_more else 1.0
        if chunk:
            self._protocol.receive_data(chunk)
        packets = [self._taken(message) for message in self._messages()]
        self._flush()
        if self._protocol.close_expected():
            self.note("source_refused", reason=self._end_reason())
            raise PortGoneError(self.path)
        return b"".join(packets)

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

    def _taken(self, message: bytes) -> bytes:
        """Packet of a publication; other messages report problems."""
        if len(message) > LONGEST_BYTES:
            self._tell("source_refused", reason=f"a message of {len(message)} bytes is no {TYPE}")
            return b""
        if b'"publish"' in message:
            return packet(MESSAGE, message)
        if b'"status"' in message:
            self._tell("rosbridge_status", message=_status_of(message))
        return b""

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

    rest, options = split_query(address, TLS_OPTIONS)
    host, port, topic = host_and_path(address, rest, USUAL_PORT)
    if not topic:
        raise UsageError(
            f"--port {address.text}: expected {address.scheme}://HOST[:{USUAL_PORT}]/TOPIC, such as /imu/data"
        )
    context = tls_context(address, options) if address.scheme == TLS else None
    channel = open_channel(address, host, port, context)
    try:
        authority = f"[{host}]:{port}" if ":" in host else f"{host}:{port}"
        subscription = RosbridgePort(channel, parse_uri(f"{address.scheme}://{authority}/"))
        subscription.subscribe(f"/{topic}")
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
