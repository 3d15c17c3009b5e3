"""A server of NetworkTables 4.1 that takes no values from clients.

The server of ntcore takes values for any topic from any client, without a limit on clients and without access control.
This server uses the WebSocket server of the other outputs, with its limits and its queue.

Source: "Network Tables Protocol Specification, Version 4.1", ntcore/doc/networktables4.adoc of WPILib.
"""

import time
from collections.abc import Mapping, Sequence
from http import HTTPStatus
from typing import TYPE_CHECKING
from urllib.parse import unquote_to_bytes

from gyrodrift.io.logger import FilteringBoundLogger
from gyrodrift.outputs.net.addresses import shown_name
from gyrodrift.outputs.net.servers import BoundedEvent
from gyrodrift.outputs.net.websocket import WebSocketClient, WebSocketServer
from gyrodrift.outputs.networktables_session import TableSession, TopicValue, value_message
from gyrodrift.outputs.status import ClientStatus

if TYPE_CHECKING:
    from websockets.asyncio.server import ServerConnection
    from websockets.http11 import Request, Response

SUBPROTOCOLS = ("v4.1.networktables.first.wpi.edu", "rtt.networktables.first.wpi.edu")
"""Subprotocols; the second is for connections that only measure the round trip."""

PATH = "/nt/"

SCHEMA_PREFIX = "/.schema/"
"""Beginning of the topics with layouts of types."""


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
