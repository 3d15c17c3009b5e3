"""What clients of the outputs send: lines of JSON, requests of gpsd, and messages over WebSocket.

ValueError closes the connection of the client that caused it; anything else that is raised breaks the target.
"""

import json
from contextlib import suppress
from typing import Any, NoReturn, cast

import msgpack

from gyrodrift.outputs.foxglove_session import FoxgloveChannel, FoxgloveSession
from gyrodrift.outputs.gpsd import requests
from gyrodrift.outputs.line_output import JsonSession
from gyrodrift.outputs.net.lines import LineClient
from gyrodrift.outputs.net.websocket import WebSocketClient
from gyrodrift.outputs.networktables_server import TableSession
from gyrodrift.outputs.rosbridge import RosbridgeSession, RosServices

LONGEST_ANSWER = 200_000
"""A message of 64 kB may be repeated in an answer, each of its characters as `\\u0000`, but not more than once."""

MOST_MESSAGES = 200
"""Of a client in a second."""

TOPICS = {"/gyrodrift/yaw_deg": "double", "/gyrodrift/is_connected": "boolean"}
IDS = {name: index for index, name in enumerate(TOPICS)}
CHANNELS = [FoxgloveChannel(1, "/gyro", {"title": "Gyro"}), FoxgloveChannel(2, "/link", {"title": "Link"})]


def no_constant(name: str) -> NoReturn:
    """NaN and Infinity are no JSON."""
    raise AssertionError(f"{name} in an answer")


class Answers:
    """A client that is sent answers: JSON objects or lists a line, or MessagePack."""

    peer = "fuzz"

    def send(self, content: str | bytes, _messages: int = 1) -> None:
        """Look at an answer."""
        assert len(content) < 2 * LONGEST_ANSWER
        for line in content.splitlines():
            assert isinstance(json.loads(line, parse_constant=no_constant), dict | list)

    def send_first(self, content: str | bytes) -> bool:
        """Look at an urgent one."""
        if isinstance(content, bytes):
            assert isinstance(msgpack.unpackb(content), list)
        else:
            self.send(content)
        return True


def clients(content: bytes) -> None:
    """Lines of the outputs tcp, unix and gpsd."""
    session = JsonSession(cast("LineClient", Answers()))
    for line in content.split(b"\n"):
        with suppress(ValueError):
            session.line(line)
        with suppress(ValueError):  # is answered with an error
            for _ in requests(line.decode(errors="replace")):
                pass


def sockets(content: bytes) -> None:
    """Messages to rosbridge, foxglove and networktables: a line each, and all of it as bytes."""
    client = cast("WebSocketClient", Answers())
    sessions: list[Any] = [
        RosbridgeSession(client, RosServices("/gyro", "sensor_msgs/msg/Imu", "ros2")),
        FoxgloveSession(client, CHANNELS, lambda: {"yaw_deg": 1.0, "filter": "hdr"}),
        TableSession(client, TOPICS, IDS, {0: b"\x94\x00\x00\x01\x00"}, lambda: 1.0, forget),
    ]
    for session in sessions:
        for message in (content, *content.decode(errors="replace").split("\n")[:MOST_MESSAGES]):
            with suppress(ValueError):
                session.message(message)
        if isinstance(session, TableSession):
            session.follow_topics()
        session.closed()


def forget(*_: object) -> None:
    """A session is over, or a client wanted to publish."""
