"""One client of the server of NetworkTables: what it subscribed to, and what it may not do."""

import json
from collections.abc import Callable, Mapping
from typing import Any

from gyrodrift.outputs.net.json_input import parse_json
from gyrodrift.outputs.net.websocket import WebSocketClient

MOST_SUBSCRIPTIONS = 200
MOST_METHODS = 1000
"""In a message; ntcore sends all subscriptions of a dashboard in one."""
TIME_TOPIC = -1
TYPE_NUMBERS = {bool: 0, float: 1}
"""Data types of a value in MessagePack messages: boolean and double."""


def value_message(topic: int, stamp_us: int, value: float | bool) -> bytes:  # noqa: FBT001 - it is a value
    """A value of a topic, as MessagePack."""
    import msgpack

    packed: bytes = msgpack.packb([topic, max(stamp_us, 0), TYPE_NUMBERS[type(value)], value])
    return packed


class TableSession:
    """Messages in, messages out.

    Parameters
    ----------
    topics
        Type of each topic, by its full name, in the order of their numbers.
    last
        The last value message of each topic, by its number.
    forget
        Called with the session when the client is gone.
    refuse
        Called with the client and the topic of ours that it wanted to publish or change.
    """

    def __init__(
        self,
        client: WebSocketClient,
        topics: Mapping[str, str],
        last: Mapping[int, bytes],
        now_s: Callable[[], float],
        forget: "Callable[[TableSession], None]",
        refuse: Callable[[WebSocketClient, str], None],
    ) -> None:
        self._client = client
        self._topics, self._last, self._now_s = topics, last, now_s
        self._forget, self._refuse = forget, refuse
        self._ids = {name: index for index, name in enumerate(topics)}
        self._announced: set[str] = set()
        self._subscriptions: dict[int, frozenset[int]] = {}
        self._wanted: frozenset[int] = frozenset()
        self._methods: dict[str, Callable[[dict[str, Any]], None]] = {
            "subscribe": self._subscribe,
            "unsubscribe": self._unsubscribe,
            "publish": self._publish,
            "setproperties": self._set_properties,
        }

    def publish(self, messages: Mapping[int, bytes]) -> None:
        """Send those values that the client subscribed to, in one frame."""
        frame = b"".join(message for topic, message in messages.items() if topic in self._wanted)
        if frame:
            self._client.send(frame)

    def message(self, content: str | bytes) -> None:
        """Take requests, or values, of which those of the clock alone are answered."""
        if isinstance(content, bytes):
            self._answer_clocks(content)
            return
        requests = parse_json(content)
        if not isinstance(requests, list) or len(requests) > MOST_METHODS:
            raise ValueError(f"expected a list of at most {MOST_METHODS} messages")
        for request in requests:
            self._take(request)

    def dropped(self, messages: int) -> str:  # noqa: ARG002 - the protocol has no word for it
        """Nothing; `status` counts them."""
        return ""

    def closed(self) -> None:
        """It is no longer published to."""
        self._forget(self)

    def _take(self, request: Any) -> None:
        """As the specification has it, what is no request that is known is ignored."""
        if not isinstance(request, dict):
            return
        method, params = request.get("method"), request.get("params")
        if isinstance(method, str) and isinstance(params, dict) and method in self._methods:
            self._methods[method](params)

    def _subscribe(self, params: dict[str, Any]) -> None:
        number, names, options = params.get("subuid"), params.get("topics"), params.get("options")
        options = options if isinstance(options, dict) else {}
        if not isinstance(number, int) or not isinstance(names, list):
            return
        if len(self._subscriptions) >= MOST_SUBSCRIPTIONS and number not in self._subscriptions:
            raise ValueError(f"more than {MOST_SUBSCRIPTIONS} subscriptions")
        found = self._matching([each for each in names if isinstance(each, str)], is_prefix=bool(options.get("prefix")))
        for name in found:
            self._announce(name)
        values = frozenset() if options.get("topicsonly") else frozenset(self._ids[name] for name in found)
        before = self._wanted
        self._subscriptions[number] = values
        self._settle()
        self.publish({topic: self._last[topic] for topic in self._wanted - before if topic in self._last})

    def _unsubscribe(self, params: dict[str, Any]) -> None:
        number = params.get("subuid")
        if isinstance(number, int):
            self._subscriptions.pop(number, None)
            self._settle()

    def _settle(self) -> None:
        self._wanted = frozenset().union(*self._subscriptions.values())

    def _publish(self, params: dict[str, Any]) -> None:
        """Answer with what the topic is; values of clients are ignored, also those for topics of their own."""
        name, number = params.get("name"), params.get("pubuid")
        if isinstance(name, str) and name in self._topics and isinstance(number, int):
            self._refuse(self._client, name)
            self._announce(name, pubuid=number)

    def _set_properties(self, params: dict[str, Any]) -> None:
        name = params.get("name")
        if isinstance(name, str) and name in self._topics:
            self._refuse(self._client, name)

    def _matching(self, names: list[str], *, is_prefix: bool) -> list[str]:
        if is_prefix:
            prefixes = tuple(names)
            return [name for name in self._topics if name.startswith(prefixes)]
        return [name for name in self._topics if name in names]

    def _announce(self, name: str, **more: int) -> None:
        if name in self._announced and not more:
            return
        self._announced.add(name)
        properties = {"retained": False, "persistent": False}
        params = {"name": name, "id": self._ids[name], "type": self._topics[name], "properties": properties, **more}
        self._urge(json.dumps([{"method": "announce", "params": params}]))

    def _answer_clocks(self, content: bytes) -> None:
        import msgpack

        for time_us in clock_questions(content):
            self._urge(msgpack.packb([TIME_TOPIC, round(self._now_s() * 1e6), 2, time_us]))

    def _urge(self, message: str | bytes) -> None:
        if not self._client.send_first(message):
            raise ValueError("too many requests wait for an answer")


def clock_questions(content: bytes) -> list[int | float]:
    """The client's times in a frame of MessagePack messages: those that ask for the server's.

    Raises
    ------
    ValueError
        Where it is no MessagePack.
    """
    import msgpack

    unpacker = msgpack.Unpacker(max_buffer_size=len(content) or 1, strict_map_key=False)
    unpacker.feed(content)
    try:
        messages = list(unpacker)
    except (ValueError, TypeError, msgpack.exceptions.UnpackException) as error:  # TypeError: a map with a list as key
        raise ValueError(f"this is no MessagePack: {type(error).__name__}") from None
    return [
        each[3]
        for each in messages
        if isinstance(each, list) and len(each) == 4 and each[0] == TIME_TOPIC and isinstance(each[3], (int, float))
    ]
