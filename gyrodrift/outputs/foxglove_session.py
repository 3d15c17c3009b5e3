"""One client of foxglove: what goes between it and the SDK's server passes through a bounded queue of ours.

The SDK drops what a slow client does not read and tells nobody how many, nor does it bound clients and what they send.
So it serves us alone, and our server has the clients, as it has those of other outputs.
"""

import asyncio
import json
from typing import TYPE_CHECKING

from gyrodrift.outputs.net.websocket import WebSocketClient

if TYPE_CHECKING:
    from websockets.asyncio.client import ClientConnection

PROTOCOL = "foxglove.sdk.v1"

MOST_ASKED = 64
"""Messages of a client that the SDK has not taken yet."""

WARNING = 1
"""A level of `status` in Foxglove's protocol."""

CLOSE_S = 1.0


class FoxgloveSession:
    """Hands on what the client sends and what the SDK answers: text at once, samples as the client reads.

    Parameters
    ----------
    port
        Where the SDK listens.
    """

    def __init__(self, client: WebSocketClient, port: int) -> None:
        self._client = client
        self._asked: asyncio.Queue[str | bytes] = asyncio.Queue(MOST_ASKED)
        self._dropped = 0
        self.task = asyncio.create_task(self._run(port))

    def message(self, content: str | bytes) -> None:
        """Hand a message on to the SDK."""
        try:
            self._asked.put_nowait(content)
        except asyncio.QueueFull:
            raise ValueError(f"more than {MOST_ASKED} messages wait for an answer") from None

    def dropped(self, messages: int) -> str:
        """How many messages this client was too slow for so far; the app shows the last of these alone."""
        self._dropped += messages
        text = f"{self._dropped} messages dropped: this client reads too slowly"
        return json.dumps({"op": "status", "level": WARNING, "message": text, "id": "gyrodrift-dropped"})

    def closed(self) -> None:
        """The SDK hears that it is gone."""
        self.task.cancel()

    async def _run(self, port: int) -> None:
        """Until one of the two goes; a client whose SDK has gone is closed."""
        from websockets.asyncio.client import connect
        from websockets.exceptions import WebSocketException
        from websockets.typing import Subprotocol

        try:
            async with connect(
                f"ws://127.0.0.1:{port}",
                subprotocols=[Subprotocol(PROTOCOL)],
                compression=None,
                max_size=None,
                ping_interval=None,
                close_timeout=CLOSE_S,
                proxy=None,
            ) as sdk:
                await self._hand_on(sdk)
        except (OSError, WebSocketException):
            pass  # it ends, and so does the client's connection
        await self._client.connection.close()

    async def _hand_on(self, sdk: "ClientConnection") -> None:
        asking = asyncio.create_task(self._ask(sdk))
        try:
            async for message in sdk:
                if isinstance(message, bytes):
                    self._client.send(message)
                elif not self._client.send_first(message):
                    return
        finally:
            asking.cancel()
            await asyncio.wait([asking])

    async def _ask(self, sdk: "ClientConnection") -> None:
        while True:
            await sdk.send(await self._asked.get())
