"""One client of foxglove: its subscriptions, and read-only parameters.

The server of the Foxglove SDK has no limit on clients and does not report dropped messages. This module has the part
of the protocol that a server needs to send.

Source: docs/spec.md of foxglove/ws-protocol; `foxglove.sdk.v1`, of the SDK 0.30, is the same for these messages.
"""

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from struct import Struct
from typing import Any

from gyrodrift.outputs.net.json_input import NotJsonError, parse_json
from gyrodrift.outputs.net.websocket import WebSocketClient, WebSocketSession

MESSAGE_DATA = 1
"""Opcode of a binary message to a client."""

MESSAGE_HEAD = Struct("<BIQ")
"""Opcode, subscription number of the client, and time, ns."""

GREATEST_NUMBER = 2**32 - 1

WARNING, ERROR = 1, 2
"""Levels of `status`."""


@dataclass(frozen=True, slots=True)
class FoxgloveChannel:
    """A topic, and the JSON schema of its messages."""

    number: int
    topic: str
    schema: dict[str, Any]

    def advertised(self) -> dict[str, Any]:
        """Announcement of the channel."""
        return {
            "id": self.number,
            "topic": self.topic,
            "encoding": "json",
            "schemaName": self.schema["title"],
            "schemaEncoding": "jsonschema",
            "schema": json.dumps(self.schema),
        }


Parameters = dict[str, float | str]


class FoxgloveSession(WebSocketSession):
    """Protocol state of one client.

    Parameters
    ----------
    parameters
        Gives the present parameters.
    """

    def __init__(
        self,
        client: WebSocketClient,
        channels: Sequence[FoxgloveChannel],
        parameters: Callable[[], Parameters],
    ) -> None:
        self._client = client
        self._channels = {channel.number: channel for channel in channels}
        self._parameters = parameters
        self._subscriptions: dict[int, int] = {}
        self._followed: set[str] = set()
        self._dropped = 0
        self._operations: dict[str, Callable[[dict[str, Any]], None]] = {
            "subscribe": self._subscribe,
            "unsubscribe": self._unsubscribe,
            "getParameters": self._get_parameters,
            "setParameters": self._set_parameters,
            "subscribeParameterUpdates": self._follow,
            "unsubscribeParameterUpdates": self._unfollow,
        }

    def has_subscribed(self, channel: int) -> bool:
        """Whether the client has subscribed to a channel."""
        return channel in self._subscriptions

    def publish(self, channel: int, time_ns: int, message: bytes) -> None:
        """Send a message if the client has subscribed to its channel."""
        if channel in self._subscriptions:
            self._client.send(MESSAGE_HEAD.pack(MESSAGE_DATA, self._subscriptions[channel], time_ns) + message)

    def advertise(self, channel: FoxgloveChannel) -> None:
        """Announce a further channel; a client that does not read is cut off."""
        self._channels[channel.number] = channel
        if not self._client.send_first(advertisement([channel])):
            self._client.connection.transport.abort()

    def tell_parameters(self, names: set[str]) -> None:
        """Send parameters with these names, if the client follows them."""
        if followed := names & self._followed:
            self._urge(self._parameter_values(followed))

    def message(self, content: str | bytes) -> None:
        """Carry out an operation. A mistake is answered with a status; the connection stays."""
        try:
            self._take(parse_json(content) if isinstance(content, str) else None)
        except (LookupError, NotJsonError) as error:
            self._say(ERROR, str(error.args[0]))

    def dropped(self, messages: int) -> str:
        """Status with the total of dropped messages; the app shows only the newest."""
        self._dropped += messages
        text = f"{self._dropped} messages dropped: this client reads too slowly"
        return json.dumps({"op": "status", "level": WARNING, "message": text, "id": "gyrodrift-dropped"})

    def _take(self, operation: Any) -> None:
        name = operation.get("op") if isinstance(operation, dict) else None
        if not isinstance(name, str):
            raise LookupError('expected an object with "op"')  # noqa: TRY004 - a mistake of the client
        if name not in self._operations:
            raise LookupError(f"{name[:40]} is not supported: clients can only read")
        self._operations[name](operation)

    def _subscribe(self, request: dict[str, Any]) -> None:
        for entry in _list_of(request, "subscriptions", dict):
            number, channel = entry.get("id"), entry.get("channelId")
            if not _is_number(number) or channel not in list(self._channels):
                raise LookupError(f"no channel {str(channel)[:40]}, or an invalid id")
            if channel in self._subscriptions or number in self._subscriptions.values():
                self._say(WARNING, f"channel {channel} or id {number} is subscribed already; this is ignored")
            else:
                self._subscriptions[channel] = number

    def _unsubscribe(self, request: dict[str, Any]) -> None:
        gone = _list_of(request, "subscriptionIds", int)
        self._subscriptions = {channel: number for channel, number in self._subscriptions.items() if number not in gone}

    def _get_parameters(self, request: dict[str, Any]) -> None:
        self._answer(request, set(_list_of(request, "parameterNames", str)))

    def _set_parameters(self, request: dict[str, Any]) -> None:
        """Answer with the present values: parameters are read only."""
        names = {str(entry.get("name")) for entry in _list_of(request, "parameters", dict)}
        self._answer(request, names or {""})

    def _follow(self, request: dict[str, Any]) -> None:
        names = _list_of(request, "parameterNames", str) or list(self._parameters())
        self._followed |= self._parameters().keys() & set(names)

    def _unfollow(self, request: dict[str, Any]) -> None:
        self._followed -= set(_list_of(request, "parameterNames", str) or self._followed)

    def _answer(self, request: dict[str, Any], names: set[str]) -> None:
        request_id = request.get("id")
        self._urge(self._parameter_values(names) | ({"id": request_id} if isinstance(request_id, str) else {}))

    def _parameter_values(self, names: set[str]) -> dict[str, Any]:
        """Parameters with these names, or all."""
        values = [
            {"name": name, "value": value} | ({} if isinstance(value, str) else {"type": "float64"})
            for name, value in self._parameters().items()
            if not names or name in names
        ]
        return {"op": "parameterValues", "parameters": values}

    def _say(self, level: int, text: str) -> None:
        self._urge({"op": "status", "level": level, "message": text})

    def _urge(self, message: dict[str, Any]) -> None:
        if not self._client.send_first(json.dumps(message)):
            raise ValueError("too many pending requests")


def opening(channels: Sequence[FoxgloveChannel], session_id: str) -> tuple[str, str]:
    """First messages of a connection."""
    info = {
        "op": "serverInfo",
        "name": "gyrodrift",
        "capabilities": ["parameters", "parametersSubscribe"],
        "metadata": {},
        "sessionId": session_id,
    }
    return json.dumps(info), advertisement(channels)


def advertisement(channels: Sequence[FoxgloveChannel]) -> str:
    """Announcement of channels."""
    return json.dumps({"op": "advertise", "channels": [channel.advertised() for channel in channels]})


def _list_of(request: dict[str, Any], name: str, kind: type[Any]) -> list[Any]:
    values = request.get(name)
    if not isinstance(values, list) or not all(isinstance(value, kind) for value in values):
        raise LookupError(f"{request['op']}: {name} is a list")
    return values


def _is_number(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and 0 <= value <= GREATEST_NUMBER
