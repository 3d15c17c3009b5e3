"""A server of NetworkTables 4.1 that takes no values from clients.

The server of ntcore takes values for any topic from any client, without a limit on clients and without access control.
This server uses the WebSocket server of the other outputs, with its limits and its queue.

Source: "Network Tables Protocol Specification, Version 4.1", ntcore/doc/networktables4.adoc of WPILib.
"""

import json
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from http import HTTPStatus
from typing import TYPE_CHECKING, Any
from urllib.parse import unquote_to_bytes

from gyrodrift.io.logger import FilteringBoundLogger
from gyrodrift.outputs.net.addresses import shown_name
from gyrodrift.outputs.net.json_input import parse_json
from gyrodrift.outputs.net.servers import BoundedEvent
from gyrodrift.outputs.net.websocket import WebSocketClient, WebSocketServer, WebSocketSession
from gyrodrift.outputs.status import ClientStatus

if TYPE_CHECKING:
    from websockets.asyncio.server import ServerConnection
    from websockets.http11 import Request, Response

MOST_SUBSCRIPTIONS = 200
MOST_METHODS = 1000
"""Most requests in a message; ntcore sends all subscriptions of a dashboard in one message."""
TIME_TOPIC = -1
TYPE_NUMBERS = {bool: 0, float: 1, bytes: 5}
"""Data types of a value in MessagePack messages: boolean, double and raw."""

TopicValue = float | bool | bytes

SUBPROTOCOLS = ("v4.1.networktables.first.wpi.edu", "rtt.networktables.first.wpi.edu")
"""Subprotocols; the second is for connections that only measure the round trip."""

PATH = "/nt/"

SCHEMA_PREFIX = "/.schema/"
"""Beginning of the topics with layouts of types."""


def value_message(topic: int, stamp_us: int, value: TopicValue) -> bytes:
    """Value of a topic as MessagePack."""
    import msgpack

    packed: bytes = msgpack.packb([topic, max(stamp_us, 0), TYPE_NUMBERS[type(value)], value])
    return packed


@dataclass(frozen=True, slots=True)
class Subscription:
    """Names or prefixes that a client subscribes to.

    has_values
        Whether it gets values; otherwise only announcements.
    """

    names: tuple[str, ...]
    is_prefix: bool
    has_values: bool

    def has(self, topic: str) -> bool:
        """Whether a topic is subscribed."""
        return topic.startswith(self.names) if self.is_prefix else topic in self.names


class TableSession(WebSocketSession):
    """Protocol state of one client.

    Parameters
    ----------
    topics, ids
        Type and number of each topic, by its full name. Topics can be added later; see `follow_topics`.
    last
        The last value message of each topic, by its number.
    refuse
        Called with the client and the topic that it wanted to publish or change.
    """

    def __init__(
        self,
        client: WebSocketClient,
        topics: Mapping[str, str],
        ids: Mapping[str, int],
        last: Mapping[int, bytes],
        now_s: Callable[[], float],
        refuse: Callable[[WebSocketClient, str], None],
    ) -> None:
        self._client = client
        self._topics, self._ids, self._last, self._now_s = topics, ids, last, now_s
        self._refuse = refuse
        self._announced: set[str] = set()
        self._subscriptions: dict[int, Subscription] = {}
        self._topic_ids: frozenset[int] = frozenset()
        self._methods: dict[str, Callable[[dict[str, Any]], None]] = {
            "subscribe": self._subscribe,
            "unsubscribe": self._unsubscribe,
            "publish": self._publish,
            "setproperties": self._set_properties,
        }

    def publish(self, messages: Mapping[int, bytes]) -> None:
        """Send the subscribed values in one frame."""
        frame = b"".join(message for topic, message in messages.items() if topic in self._topic_ids)
        if frame:
            self._client.send(frame)

    def follow_topics(self) -> None:
        """Announce topics that were added, if they are subscribed; a client that does not read is cut off."""
        try:
            for subscription in self._subscriptions.values():
                self._announce_all(subscription)
        except ValueError:
            self._client.connection.transport.abort()
        self._update_wanted()

    def message(self, content: str | bytes) -> None:
        """Take requests, or values; of values only clock requests are answered."""
        if isinstance(content, bytes):
            self._answer_clocks(content)
            return
        requests = parse_json(content)
        if not isinstance(requests, list) or len(requests) > MOST_METHODS:
            raise ValueError(f"expected a list of at most {MOST_METHODS} messages")
        for request in requests:
            self._take(request)

    def _take(self, request: Any) -> None:
        """Carry out a request; unknown requests are ignored, as the specification says."""
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
        subscription = self._subscriptions[number] = Subscription(
            tuple(name for name in names if isinstance(name, str)),
            is_prefix=bool(options.get("prefix")),
            has_values=not options.get("topicsonly"),
        )
        self._announce_all(subscription)
        before = self._topic_ids
        self._update_wanted()
        self.publish({topic: self._last[topic] for topic in self._topic_ids - before if topic in self._last})

    def _unsubscribe(self, params: dict[str, Any]) -> None:
        number = params.get("subuid")
        if isinstance(number, int):
            self._subscriptions.pop(number, None)
            self._update_wanted()

    def _update_wanted(self) -> None:
        with_values = [entry for entry in self._subscriptions.values() if entry.has_values]
        self._topic_ids = frozenset(
            index for name, index in self._ids.items() if any(entry.has(name) for entry in with_values)
        )

    def _publish(self, params: dict[str, Any]) -> None:
        """Announce the topic as it is; values of clients are always ignored."""
        name, number = params.get("name"), params.get("pubuid")
        if isinstance(name, str) and name in self._topics and isinstance(number, int):
            self._refuse(self._client, name)
            self._announce(name, pubuid=number)

    def _set_properties(self, params: dict[str, Any]) -> None:
        name = params.get("name")
        if isinstance(name, str) and name in self._topics:
            self._refuse(self._client, name)

    def _announce_all(self, subscription: Subscription) -> None:
        for name in self._topics:
            if subscription.has(name):
                self._announce(name)

    def _announce(self, name: str, **extra: int) -> None:
        if name in self._announced and not extra:
            return
        self._announced.add(name)
        properties = {"retained": False, "persistent": False}
        params = {"name": name, "id": self._ids[name], "type": self._topics[name], "properties": properties, **extra}
        self._urge(json.dumps([{"method": "announce", "params": params}]))

    def _answer_clocks(self, content: bytes) -> None:
        import msgpack

        for time_us in clock_questions(content):
            self._urge(msgpack.packb([TIME_TOPIC, round(self._now_s() * 1e6), 2, time_us]))

    def _urge(self, message: str | bytes) -> None:
        if not self._client.send_first(message):
            raise ValueError("too many pending requests")


def clock_questions(content: bytes) -> list[int | float]:
    """Client times of the clock requests in a frame of MessagePack messages.

    Raises
    ------
    ValueError
        If it is no MessagePack.
    """
    import msgpack

    unpacker = msgpack.Unpacker(max_buffer_size=len(content) or 1, strict_map_key=False)
    unpacker.feed(content)
    try:
        messages = list(unpacker)
    except (ValueError, TypeError, msgpack.exceptions.UnpackException) as error:  # TypeError: a map with a list as key
        raise ValueError(f"this is no MessagePack: {type(error).__name__}") from None
    return [
        value[3]
        for value in messages
        if isinstance(value, list) and len(value) == 4 and value[0] == TIME_TOPIC and isinstance(value[3], (int, float))
    ]


class ServedTables:
    """Topics on a server of this process.

    Parameters
    ----------
    topics
        Type of each topic, by its full name.
    """

    def __init__(self, host: str, port: int, topics: Mapping[str, str], log: FilteringBoundLogger) -> None:
        self._where = host, port
        self._topics = dict(topics)
        self._ids = {name: index for index, name in enumerate(topics)}
        self._last: dict[int, bytes] = {}
        self._server: WebSocketServer[TableSession] = WebSocketServer(
            self._session, log, _answer, subprotocols=SUBPROTOCOLS
        )
        self._refused = BoundedEvent(log.warning, "forgery_refused", "forgeries_refused")
        self._begun_s = time.time() - time.monotonic()

    async def open(self) -> str:
        """Begin to listen."""
        return await self._server.listen(*self._where)

    def now_s(self) -> float:
        """Unix time without jumps, s."""
        return self._begun_s + time.monotonic()

    def server_offset_s(self) -> float:
        """0: this is the server."""
        return 0.0

    def add(self, topics: Mapping[str, str], schemas: Mapping[str, str]) -> None:
        """Announce further topics to their subscribers, and publish the layouts of their types."""
        layouts = {f"{SCHEMA_PREFIX}{kind}": schema.encode() for kind, schema in schemas.items()}
        self._topics |= {**dict.fromkeys(layouts, "structschema"), **topics}
        self._ids |= {name: index for index, name in enumerate(self._topics)}
        for session in self._server.clients.values():
            session.follow_topics()
        self.publish(layouts)

    def publish(self, values: Mapping[str, TopicValue], stamp_us: int | None = None) -> None:
        """Send values to subscribers, and keep them for later subscribers."""
        stamp_us = round(self.now_s() * 1e6) if stamp_us is None else stamp_us
        messages = {self._ids[name]: value_message(self._ids[name], stamp_us, value) for name, value in values.items()}
        self._last |= messages
        for session in self._server.clients.values():
            session.publish(messages)

    def check(self) -> str:
        """Empty: no client can publish."""
        return ""

    def clients(self) -> Sequence[ClientStatus]:
        """Connected clients."""
        return self._server.statuses()

    def dropped(self) -> int:
        """Messages dropped for slow clients."""
        return self._server.counts()[1]

    async def close(self) -> None:
        """Close the connections."""
        await self._server.close()
        self._refused.close()

    def _session(self, client: WebSocketClient) -> TableSession:
        request = client.connection.request
        name = shown_name(unquote_to_bytes(request.path.removeprefix(PATH))) if request else ""
        client.peer = f"{name} {client.peer}"
        return TableSession(client, self._topics, self._ids, self._last, self.now_s, self._refuse)

    def _refuse(self, client: WebSocketClient, topic: str) -> None:
        self._refused.happened(client=client.peer, topic=shown_name(topic), hint="clients cannot publish to it")


def _answer(connection: "ServerConnection", request: "Request") -> "Response | None":
    """Refuse requests of other paths; None lets the handshake continue."""
    if request.path.startswith(PATH):
        return None
    return connection.respond(HTTPStatus.NOT_FOUND, f"NetworkTables 4.1 is at {PATH}NAME, with a WebSocket.\n")
