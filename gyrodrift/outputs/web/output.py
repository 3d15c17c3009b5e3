"""The output `web`: a page for people, the stream that it draws, and the commands of its buttons.

A command needs the token, a page that was opened through loopback, and a connection from this machine. So neither the
network nor another page in the same browser can give one. The command goes to the control socket, as with
`gyrodrift ctl`.
"""

import asyncio
import hmac
import json
import re
import time
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Annotated, Any
from urllib.parse import urlsplit

from annotated_types import MaxLen

from gyrodrift import __version__
from gyrodrift.outputs.health import health
from gyrodrift.outputs.net.addresses import is_loopback
from gyrodrift.outputs.net.json_input import parse_json
from gyrodrift.outputs.net.servers import Periodic, ServerOutput
from gyrodrift.outputs.net.websocket import WebSocketClient, WebSocketServer, WebSocketSession
from gyrodrift.outputs.options import LOOPBACK, About, Host, Port
from gyrodrift.outputs.output import ControlAccess, OutputHost
from gyrodrift.outputs.status import ServiceStatus
from gyrodrift.outputs.web.assets import Assets
from gyrodrift.outputs.web.points import LAYOUTS, ONE_AXIS, POINTS_HZ, PointHistory, PointLayout, in_messages
from gyrodrift.values.sample import Corrected

if TYPE_CHECKING:
    from websockets.asyncio.server import ServerConnection

KEPT_EVENTS = 50
"""Kept events of the config, and as many others: link events do not displace config events."""

COMMANDS = re.compile(
    r"zero|heading -?[0-9]{1,4}(\.[0-9]{1,6})?|record (start|stop)"
    r"|calibrate (start|positions|axis-turns|mark|undo|finish|cancel|state)"
)
"""Commands that a page may give; the service carries out more."""

PATIENCE_S = 20.0
"""The service answers within 3 s; a busy machine takes longer, s."""

LONGEST_ANSWER = 1 << 20
"""A recording with rotation may have thousands of files, bytes."""

MOST_PENDING = 4


def is_local(connection: "ServerConnection") -> bool:
    """Whether a browser on this machine has opened its own page through loopback."""
    request = connection.request
    if request is None or not is_loopback(str(connection.remote_address[0])):
        return False
    hosts, origins = request.headers.get_all("Host"), request.headers.get_all("Origin")
    if len(hosts) != 1 or origins not in ([f"http://{hosts[0]}"], [f"https://{hosts[0]}"]):
        return False
    return is_loopback(urlsplit(f"//{hosts[0]}").hostname or "")


class Buttons:
    """The buttons of one page.

    Parameters
    ----------
    access
        Socket of the service and the token.
    """

    def __init__(self, access: ControlAccess) -> None:
        self._access = access
        self._pending: set[asyncio.Task[None]] = set()

    def press(self, content: str | bytes, send: Any) -> None:
        """Carry out `{"token", "command"}` and send the answer of the service.

        Raises
        ------
        ValueError
            If the message or the token is wrong, or there is no such command.
        """
        message = parse_json(content)
        if not isinstance(message, dict) or not isinstance(message.get("command"), str):
            raise ValueError("expected a token and a command")  # noqa: TRY004 - refuses the client, as all here
        token, command = str(message.get("token")), message["command"]
        if not hmac.compare_digest(token.encode(), self._access.token.encode()):
            raise ValueError("the token is wrong")
        if not COMMANDS.fullmatch(command):
            raise ValueError("there is no such button")
        if len(self._pending) >= MOST_PENDING:
            send(_answer(command, {"ok": False, "error": "the service is busy; try again"}))
            return
        task = asyncio.create_task(self._carry_out(command, send))
        self._pending.add(task)
        task.add_done_callback(self._pending.discard)

    def close(self) -> None:
        """Wait for no answer any more."""
        for task in self._pending:
            task.cancel()

    async def _carry_out(self, command: str, send: Any) -> None:
        try:
            async with asyncio.timeout(PATIENCE_S):
                answer = await ask_service(self._access.path, command)
        except (OSError, ValueError, TimeoutError) as error:
            reason = f": {error}" if str(error) else ""
            answer = {"ok": False, "error": f"the service does not answer{reason}"}
        send(_answer(command, answer))


def _answer(command: str, answer: dict[str, Any]) -> str:
    return json.dumps({"kind": "answer", "command": command, "answer": answer}, separators=(",", ":"))


async def ask_service(path: str, command: str) -> dict[str, Any]:
    """Answer of the control socket at a path."""
    reader, writer = await asyncio.open_unix_connection(path, limit=LONGEST_ANSWER)
    try:
        writer.write(command.encode() + b"\n")
        return dict(json.loads(await reader.readline()))
    finally:
        writer.close()


@dataclass(frozen=True, slots=True)
class WebOptions:
    """Address of the page."""

    host: Annotated[Host, About("address to listen on")] = LOOPBACK
    port: Annotated[Port, About("port to listen on; 0 takes a free one")] = 8117
    reached_as: Annotated[str, MaxLen(253), About("additional host name under which browsers open the page")] = ""


class WebOutput(ServerOutput[WebOptions, "WebSocketServer[WebSession]"]):
    """Serves the page, and sends the last hour, then 30 points a second, events, and the state.

    With the first attitude, and with the first yaw of the device, all pages get a new hello: their points have further
    columns from then on.
    """

    options_type = WebOptions

    def __init__(self, options: WebOptions, host: OutputHost) -> None:
        super().__init__(options, host)
        assets = Assets(options.host, options.reached_as)
        self.server = WebSocketServer(self._session, host.log, assets.answer)
        self._samples: list[Corrected] = []
        self._has = (False, False)
        self._layout = ONE_AXIS
        self._history = PointHistory(self._layout)
        self._events: tuple[deque[str], deque[str]] = (deque(maxlen=KEPT_EVENTS), deque(maxlen=KEPT_EVENTS))
        self._frames: Periodic | None = None

    async def open(self) -> None:
        """Begin to listen."""
        self.address = f"http://{await self.server.listen(self.options.host, self.options.port)}"
        self._frames = Periodic(1.0 / POINTS_HZ, self._frame, waits=True)

    def take(self, samples: Sequence[Corrected]) -> None:
        """Keep samples for the next frame."""
        self._samples += samples
        if self._frames is not None:
            self._frames.wake()

    def hear(self, event: str, fields: Mapping[str, Any]) -> None:
        """Send an event to all pages, and keep it for later pages."""
        message = _json("event", t_s=time.time(), event=event, fields=fields)
        self._events[event.startswith("config_")].append(message)
        self._send(message)

    def note(self, status: ServiceStatus) -> None:
        """Send the state to all pages."""
        if self.server.clients:
            self._send(_state(status))

    async def close(self) -> None:
        """Close the connections; the pages reconnect."""
        if self._frames is not None:
            await self._frames.close()
        await super().close()

    def _frame(self) -> None:
        """Send the samples since the last frame as one point."""
        if not self._samples:
            return
        self._extend(self._samples[-1])
        point = self._layout.point_of(self._samples)
        self._samples.clear()
        self._history.add(point)
        self._send(self._layout.pack(point))

    def _extend(self, newest: Corrected) -> None:
        """Add the columns of an attitude and of the device's own yaw when a sample has them."""
        has_attitude, has_device_yaw = self._has
        is_compared = newest.device_difference_deg == newest.device_difference_deg
        has = (has_attitude or newest.attitude is not None, has_device_yaw or is_compared)
        if has != self._has:
            self._has = has
            self._begin_with(LAYOUTS[has])

    def _begin_with(self, layout: PointLayout) -> None:
        """Begin an empty history with other columns, on all pages too."""
        self._layout, self._history = layout, PointHistory(layout)
        for client in self.server.clients:
            client.send(self._hello(client))

    def _hello(self, client: WebSocketClient) -> str:
        has_buttons = self._access(client) is not None
        columns = self._layout.columns
        return _json("hello", version=__version__, columns=columns, now_s=time.time(), has_buttons=has_buttons)

    def _access(self, client: WebSocketClient) -> ControlAccess | None:
        """Access to the control socket for a local page."""
        return self.host.access if is_local(client.connection) else None

    def _send(self, message: str | bytes) -> None:
        for client in self.server.clients:
            client.send(message)

    def _session(self, client: WebSocketClient) -> "WebSession":
        access = self._access(client)
        client.send(self._hello(client))
        for message in in_messages(self._history.rows()):
            client.send(message)
        for event in self._events[0] + self._events[1]:
            client.send(event)
        if self.host.status.pid:  # a state was received
            client.send(_state(self.host.status))
        return WebSession(client, None if access is None else Buttons(access))


class WebSession(WebSocketSession):
    """One page.

    Parameters
    ----------
    buttons
        None for a page that only shows.
    """

    def __init__(self, client: WebSocketClient, buttons: Buttons | None) -> None:
        self._client, self._buttons = client, buttons

    def message(self, content: str | bytes) -> None:
        """Carry out a button of a local page; any other message closes the stream."""
        if self._buttons is None:
            raise ValueError("this stream takes no messages")
        self._buttons.press(content, self._client.send)

    def dropped(self, messages: int) -> str:
        """Message for a page that was too slow."""
        return _json("dropped", messages=messages)

    def closed(self) -> None:
        """Wait for no answer any more."""
        if self._buttons is not None:
            self._buttons.close()


def _state(status: ServiceStatus) -> str:
    return _json("state", status=asdict(status), health=[asdict(finding) for finding in health(status)])


def _json(kind: str, **content: Any) -> str:
    return json.dumps({"kind": kind, **content}, separators=(",", ":"), default=str)
