"""The server of the Foxglove SDK: samples, the filter's state and the link's statistics for the Foxglove app.

The SDK runs threads of its own; what it sends reaches clients through `foxglove_session`.
"""

import asyncio
import json
import threading
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass
from math import isnan
from typing import TYPE_CHECKING, Annotated, Any, cast

from gyrodrift.outputs.foxglove_schemas import SAMPLE_SCHEMA, schema_of
from gyrodrift.outputs.foxglove_session import PROTOCOL, FoxgloveSession
from gyrodrift.outputs.json_line import json_line
from gyrodrift.outputs.net.websocket import WebSocketClient, WebSocketServer
from gyrodrift.outputs.options import LOOPBACK, About, Host, Port, Rate
from gyrodrift.outputs.output import Output, OutputError, OutputHost
from gyrodrift.outputs.status import ClientStatus, ConfigStatus, FilterStatus, LinkStatus, ServiceStatus
from gyrodrift.outputs.thinning import Thinning
from gyrodrift.sample import Corrected

if TYPE_CHECKING:
    from foxglove import Channel, Context
    from foxglove.websocket import ChannelView, Client, Parameter, ServerListener
    from foxglove.websocket import WebSocketServer as SdkServer

BACKLOG = 4096
"""Messages that the SDK keeps for us while we do other things."""

STOP_S = 1.0


@dataclass(frozen=True, slots=True)
class FoxgloveOptions:
    """Where, and how often."""

    host: Annotated[Host, About("address to listen on")] = LOOPBACK
    port: Annotated[Port, About("port to listen on; 0 takes a free one")] = 8765
    rate_hz: Annotated[Rate, About("at most so many samples a second of device time")] = None


class FoxgloveOutput(Output[FoxgloveOptions]):
    """Three channels, and the config in force as parameters that nobody can set."""

    options_type = FoxgloveOptions

    def __init__(self, options: FoxgloveOptions, host: OutputHost) -> None:
        super().__init__(options, host)
        self._listener = FoxgloveListener()
        self._thinning = Thinning(options.rate_hz)
        self._server = WebSocketServer(self._session, host.log, subprotocols=[PROTOCOL])
        self._relays: set[asyncio.Task[None]] = set()
        self._sdk: SdkServer | None = None
        self._context: Context | None = None  # the SDK forgets channels whose context nobody holds
        self._channels: dict[str, Channel] = {}

    async def open(self) -> None:
        """Begin to listen."""
        import foxglove
        from foxglove.websocket import Capability

        context = self._context = foxglove.Context()
        schemas = {
            "/gyro/sample": SAMPLE_SCHEMA,
            "/gyro/state": schema_of("gyrodrift.State", FilterStatus),
            "/gyro/link_stats": schema_of("gyrodrift.LinkStats", LinkStatus),
        }
        self._channels = {
            topic: foxglove.Channel(topic, schema=schema, context=context) for topic, schema in schemas.items()
        }
        try:
            self._sdk = foxglove.start_server(
                name="gyrodrift",
                host=LOOPBACK,
                port=0,
                capabilities=[Capability.Parameters],
                server_listener=cast("ServerListener", self._listener),  # it has those that can be called here
                context=context,
                message_backlog_size=BACKLOG,
            )
        except RuntimeError as error:
            raise OutputError(f"the Foxglove SDK does not start: {error}") from error
        self.address = await self._server.listen(self.options.host, self.options.port)

    def take(self, samples: Sequence[Corrected]) -> None:
        """Send samples, where somebody has subscribed."""
        if not self._listener.has_subscribed("/gyro/sample"):
            return
        channel = self._channels["/gyro/sample"]
        for each in self._thinning.due(samples):
            channel.log(_sample(each), log_time=int(each.sample.t_host_s * 1e9))

    def note(self, status: ServiceStatus) -> None:
        """Send state and statistics, and the parameters where they are others now."""
        values = parameters_of(status.config)
        if self._sdk is not None and values != self._listener.values:
            self._listener.values = values
            self._sdk.publish_parameter_values(self._listener.parameters())
        for topic, record in (("/gyro/state", status.filter), ("/gyro/link_stats", status.link)):
            if self._listener.has_subscribed(topic):
                self._channels[topic].log(_known(record))

    def clients(self) -> Sequence[ClientStatus]:
        """Who is connected."""
        return self._server.statuses()

    def counts(self) -> tuple[int, int]:
        """Messages."""
        return self._server.counts()

    async def close(self) -> None:
        """Close the connections."""
        await self._server.close()
        if self._relays:
            await asyncio.wait(self._relays)
        if self._sdk is not None:
            await _stopped(self._sdk)
            self._sdk = None
        for channel in self._channels.values():
            channel.close()
        self._channels, self._context = {}, None

    def _session(self, client: WebSocketClient) -> FoxgloveSession:
        assert self._sdk is not None  # noqa: S101 - clients come while it is open
        session = FoxgloveSession(client, self._sdk.port)
        self._relays.add(session.task)
        session.task.add_done_callback(self._relays.discard)
        return session


class FoxgloveListener:
    """What clients ask for. The SDK calls it from its own threads; each change here is one step of a dict.

    values
        Parameters by name.
    """

    def __init__(self) -> None:
        self.values: dict[str, float | str] = {}
        self._subscriptions: dict[tuple[int, str], None] = {}

    def has_subscribed(self, topic: str) -> bool:
        """Somebody has, to this one."""
        return any(each == topic for _, each in list(self._subscriptions))

    def parameters(self, names: Sequence[str] = ()) -> "list[Parameter]":
        """These of the parameters, or all."""
        from foxglove.websocket import Parameter, ParameterType

        return [
            Parameter(name, value=value, type=None if isinstance(value, str) else ParameterType.Float64)
            for name, value in self.values.items()
            if not names or name in names
        ]

    def on_subscribe(self, client: "Client", channel: "ChannelView") -> None:
        """Begin to send."""
        self._subscriptions[client.id, channel.topic] = None

    def on_unsubscribe(self, client: "Client", channel: "ChannelView") -> None:
        """No longer send; also when it is gone."""
        self._subscriptions.pop((client.id, channel.topic), None)

    def on_get_parameters(
        self, client: "Client", param_names: list[str], request_id: str | None = None
    ) -> "list[Parameter]":
        """Answer with those that there are."""
        del client, request_id
        return self.parameters(param_names)

    def on_set_parameters(
        self, client: "Client", parameters: "list[Parameter]", request_id: str | None = None
    ) -> "list[Parameter]":
        """Answer with what they are: nothing is set from here."""
        del client, request_id
        return self.parameters([each.name for each in parameters])

    def on_parameters_subscribe(self, param_names: list[str]) -> None:
        """The SDK keeps who has."""

    def on_parameters_unsubscribe(self, param_names: list[str]) -> None:
        """Likewise."""


async def _stopped(server: "SdkServer") -> None:
    """Stop it; the SDK waits for ever for a client who does not read, and then a thread is left that waits for it."""
    loop, has_stopped = asyncio.get_running_loop(), asyncio.Event()

    def stop() -> None:
        server.stop()
        with suppress(RuntimeError):  # the loop is over
            loop.call_soon_threadsafe(has_stopped.set)

    threading.Thread(target=stop, name="foxglove-stop", daemon=True).start()
    with suppress(TimeoutError):
        async with asyncio.timeout(STOP_S):
            await has_stopped.wait()


def parameters_of(config: ConfigStatus) -> dict[str, float | str]:
    """The config in force: the file, the filter, and its parameters by `FILTER.NAME`."""
    named: dict[str, float | str] = {f"{config.filter}.{name}": value for name, value in config.params.items()}
    return {"filter": config.filter, "config": config.file or "", **named}


def _sample(corrected: Corrected) -> bytes:
    opening = f'{{"t_host_s":{corrected.sample.t_host_s!r},'
    if not isnan(corrected.raw_yaw_deg):
        opening += f'"raw_yaw_deg":{corrected.raw_yaw_deg!r},'
    return json_line(corrected, opening).encode()


def _known(record: Any) -> bytes:
    return json.dumps({name: value for name, value in asdict(record).items() if value is not None}).encode()
