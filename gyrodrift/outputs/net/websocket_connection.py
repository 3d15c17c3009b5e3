"""The part of the WebSocket server that needs the package `websockets`, and so is imported when one listens."""

import asyncio
import logging
from collections.abc import Awaitable, Callable
from typing import Any, ClassVar

from websockets.asyncio.server import Server, ServerConnection, serve

from gyrodrift.outputs.net.limits import Limits

SILENT = logging.getLogger("gyrodrift.websockets")
SILENT.setLevel(logging.CRITICAL + 1)
"""The package logs each client's mistake with a traceback; ours says what matters."""

PING_S = 20.0
CLOSE_S = 2.0


class CountedConnection(ServerConnection):
    """A connection that is cut off at once where there are too many, before it has cost a handshake.

    most, there
        Of connections to one server, which has a class of its own; those in the middle of a handshake count.
    """

    most: ClassVar[int]
    there: "ClassVar[set[ServerConnection]]"

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Count it."""
        super().connection_made(transport)
        self.there.add(self)
        if len(self.there) > self.most:
            self.transport.abort()

    def connection_lost(self, exc: Exception | None) -> None:
        """Forget it."""
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
    """A server that has its port and does not serve yet; OSError where the port cannot be had.

    `there` has its connections from then on, as long as they last; `options` are those of `websockets`.
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
