"""One client of foxglove: the channels that it subscribed to, and parameters that nobody can set.

The server of the Foxglove SDK has no limit on its clients and tells nobody what it drops. This is the part of its
protocol that a server needs who only sends.

Source: docs/spec.md of foxglove/ws-protocol; `foxglove.sdk.v1`, of the SDK 0.30, is the same for these messages.
"""

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from struct import Struct
from typing import Any

from gyrodrift.outputs.net.json_input import NotJsonError, parse_json
from gyrodrift.outputs.net.websocket import WebSocketClient

MESSAGE_DATA = 1
"""Opcode of a binary message to a client."""

MESSAGE_HEAD = Struct("<BIQ")
"""Opcode, the client's number of its subscription, and time, ns."""

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
        """As clients are told of it."""
        return {
            "id": self.number,
            "topic": self.topic,
            "encoding": "json",
            "schemaName": self.schema["title"],
            "schemaEncoding": "jsonschema",
            "schema": json.dumps(self.schema),
        }


Parameters = dict[str, float | str]


class FoxgloveSession:
    """Messages in, messages out.

    Parameters
    ----------
    parameters
        Gives the parameters as they are now.
    forget
        Called with the session when the client is gone.
    """

    def __init__(
        self,
        client: WebSocketClient,
        channels: Sequence[FoxgloveChannel],
        parameters: Callable[[], Parameters],
        forget: "Callable[[FoxgloveSession], None]",
    ) -> None:
        self._client = client
        self._channels = {channel.number: channel for channel in channels}
        self._parameters, self._forget = parameters, forget
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
        """It is sent messages of this channel."""
        return channel in self._subscriptions

    def publish(self, channel: int, time_ns: int, message: bytes) -> None:
        """Send a message, where the client has subscribed to its channel."""
        if channel in self._subscriptions:
            self._client.send(MESSAGE_HEAD.pack(MESSAGE_DATA, self._subscriptions[channel], time_ns) + message)

    def tell_parameters(self, names: set[str]) -> None:
        """Send those of the parameters with these names that the client follows."""
        if followed := names & self._followed:
            self._urge(self._parameter_values(followed))

    def message(self, content: str | bytes) -> None:
        """Take an operation; what cannot be done is answered with a status, and the connection stays."""
        try:
            self._take(parse_json(content) if isinstance(content, str) else None)
        except (LookupError, NotJsonError) as error:
            self._say(ERROR, str(error.args[0]))

    def dropped(self, messages: int) -> str:
        """How many messages this client was too slow for so far; the app shows the last of these alone."""
        self._dropped += messages
        text = f"{self._dropped} messages dropped: this client reads too slowly"
        return json.dumps({"op": "status", "level": WARNING, "message": text, "id": "gyrodrift-dropped"})

    def closed(self) -> None:
        """It is no longer published to."""
        self._forget(self)

    def _take(self, operation: Any) -> None:
        name = operation.get("op") if isinstance(operation, dict) else None
        if not isinstance(name, str):
            raise LookupError('expected an object with "op"')  # noqa: TRY004 - the client's mistake, told to it
        if name not in self._operations:
            raise LookupError(f"{name[:40]} is not done here: nothing that a client sends reaches the gyro")
        self._operations[name](operation)

    def _subscribe(self, asked: dict[str, Any]) -> None:
        for each in _list_of(asked, "subscriptions", dict):
            number, channel = each.get("id"), each.get("channelId")
            if not _is_number(number) or channel not in list(self._channels):
                raise LookupError(f"there is no channel {str(channel)[:40]}, or the id is none")
            if channel in self._subscriptions or number in self._subscriptions.values():
                self._say(WARNING, f"channel {channel} or id {number} is subscribed already; this is ignored")
            else:
                self._subscriptions[channel] = number

    def _unsubscribe(self, asked: dict[str, Any]) -> None:
        gone = _list_of(asked, "subscriptionIds", int)
        self._subscriptions = {channel: number for channel, number in self._subscriptions.items() if number not in gone}

    def _get_parameters(self, asked: dict[str, Any]) -> None:
        self._answer(asked, set(_list_of(asked, "parameterNames", str)))

    def _set_parameters(self, asked: dict[str, Any]) -> None:
        """Answer with what they are: nothing is set from here."""
        names = {str(each.get("name")) for each in _list_of(asked, "parameters", dict)}
        self._answer(asked, names or {""})

    def _follow(self, asked: dict[str, Any]) -> None:
        names = _list_of(asked, "parameterNames", str) or list(self._parameters())
        self._followed |= self._parameters().keys() & set(names)

    def _unfollow(self, asked: dict[str, Any]) -> None:
        self._followed -= set(_list_of(asked, "parameterNames", str) or self._followed)

    def _answer(self, asked: dict[str, Any], names: set[str]) -> None:
        request = asked.get("id")
        self._urge(self._parameter_values(names) | ({"id": request} if isinstance(request, str) else {}))

    def _parameter_values(self, names: set[str]) -> dict[str, Any]:
        """All parameters, or those with the names."""
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
            raise ValueError("too many requests wait for an answer")


def opening(channels: Sequence[FoxgloveChannel], session_id: str) -> tuple[str, str]:
    """The messages that a connection begins with."""
    info = {
        "op": "serverInfo",
        "name": "gyrodrift",
        "capabilities": ["parameters", "parametersSubscribe"],
        "metadata": {},
        "sessionId": session_id,
    }
    return json.dumps(info), json.dumps({"op": "advertise", "channels": [each.advertised() for each in channels]})


def _list_of(asked: dict[str, Any], name: str, kind: type[Any]) -> list[Any]:
    found = asked.get(name)
    if not isinstance(found, list) or not all(isinstance(each, kind) for each in found):
        raise LookupError(f"{asked['op']}: {name} is a list")
    return found


def _is_number(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and 0 <= value <= GREATEST_NUMBER
