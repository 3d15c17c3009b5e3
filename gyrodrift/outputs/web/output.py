"""The output `web`: a page for people, and the stream that it draws."""

import json
import time
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Annotated, Any

from annotated_types import MaxLen

from gyrodrift import __version__
from gyrodrift.outputs.health import health
from gyrodrift.outputs.net.periodic import Periodic
from gyrodrift.outputs.net.servers import ServerOutput
from gyrodrift.outputs.net.websocket import WebSocketClient, WebSocketServer
from gyrodrift.outputs.options import LOOPBACK, About, Host, Port
from gyrodrift.outputs.output import ControlAccess, OutputHost
from gyrodrift.outputs.status import ServiceStatus
from gyrodrift.outputs.web.assets import Assets
from gyrodrift.outputs.web.buttons import Buttons, is_local
from gyrodrift.outputs.web.points import LAYOUTS, ONE_AXIS, POINTS_HZ, PointHistory, PointLayout, in_messages
from gyrodrift.values.sample import Corrected

KEPT_EVENTS = 50
"""Kept events of the config, and as many others: link events do not displace config events."""


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


class WebSession:
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
