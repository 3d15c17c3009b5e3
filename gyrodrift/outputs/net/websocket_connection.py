"""Part of the WebSocket server that needs the package `websockets`; imported when a server listens."""

import asyncio
import logging
from collections.abc import Awaitable, Callable
from typing import Any, ClassVar

from websockets.asyncio.server import Server, ServerConnection, serve

from gyrodrift.outputs.net.limits import Limits

SILENT = logging.getLogger("gyrodrift.websockets")
SILENT.setLevel(logging.CRITICAL + 1)
"""Silent logger: the package logs each mistake of a client with a traceback."""

PING_S = 20.0
CLOSE_S = 2.0


class CountedConnection(ServerConnection):
    """A connection that is cut off before its handshake if there are too many.

    most, there
        Most and present connections of one server, with those in a handshake. Each server has its own subclass.
    """

    most: ClassVar[int]
    there: "ClassVar[set[ServerConnection]]"

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Count the connection."""
        super().connection_made(transport)
        self.there.add(self)
        if len(self.there) > self.most:
            self.transport.abort()

    def connection_lost(self, exc: Exception | None) -> None:
        """Remove the connection."""
        super().connection_lost(exc)
        self.there.discard(self)


async def listen(
    handler: Callable[[ServerConnection], Awaitable[None]],
    there: set[ServerConnection],
    limits: Limits,
    host: str,
    port: int,
    **options: Any,
) -> Server:
    """A server that has its port and does not serve yet; OSError if the port is not available.

    `there` is kept up to date with its connections; `options` are those of `websockets`.
    """
    return await serve(
        handler,
        host,
        port,
        create_connection=type("Connection", (CountedConnection,), {"most": limits.clients, "there": there}),
        compression=None,
        open_timeout=limits.handshake_s,
        ping_interval=PING_S,
        ping_timeout=PING_S,
        close_timeout=CLOSE_S,
        max_size=limits.message_bytes,
        logger=SILENT,
        start_serving=False,
        **options,
    )
