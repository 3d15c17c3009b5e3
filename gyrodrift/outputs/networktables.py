"""NetworkTables 4 for FRC: yaw, rate and sigma with the time of measurement, and whether the gyro is there."""

import asyncio
import socket
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

from annotated_types import MaxLen, MinLen

from gyrodrift.outputs.json_line import FIELDS
from gyrodrift.outputs.net.addresses import cannot_listen, shown, warn_of_others
from gyrodrift.outputs.options import LOOPBACK, About, Host, Port, Rate
from gyrodrift.outputs.output import Output, OutputError, OutputHost
from gyrodrift.outputs.status import ClientStatus, ServiceStatus
from gyrodrift.outputs.thinning import Thinning
from gyrodrift.sample import Corrected

if TYPE_CHECKING:
    import ntcore

IDENTITY = "gyrodrift"
VALUES = ("yaw_deg", "corrected_dps", "yaw_sigma_deg", "bias_dps", "heading_deg", "temp_c")
PERIOD_S = 0.01
SILENT_S = 1.0
"""A gyro that has said nothing for longer is not connected."""
NO_NT3 = 0
NO_FILE = ""
US_PER_S = 1e6


@dataclass(frozen=True, slots=True)
class NetworkTablesOptions:
    """Where the tables are, and how often."""

    robot: Annotated[
        str, MaxLen(253), About("server to publish to: the robot's address or team number; where empty, we are one")
    ] = ""
    host: Annotated[Host, About("address to listen on, where we are the server")] = LOOPBACK
    port: Annotated[Port, About("port of the server; 0 takes a free one, where it is ours")] = 5810
    table: Annotated[str, MinLen(1), MaxLen(64), About("table that the topics are in")] = "gyrodrift"
    rate_hz: Annotated[Rate, About("at most so many values a second of device time")] = 100.0


class NetworkTablesOutput(Output[NetworkTablesOptions]):
    """A client of the robot's server, which reconnects by itself, or a server; ntcore sends from threads of its own.

    A client that is slow gets the newest value of each topic, not all of them.
    """

    options_type = NetworkTablesOptions

    def __init__(self, options: NetworkTablesOptions, host: OutputHost) -> None:
        super().__init__(options, host)
        self._thinning = Thinning(options.rate_hz)
        self._clock = MeasuredTime()
        self._instance: ntcore.NetworkTableInstance | None = None
        self._values: dict[str, ntcore.DoublePublisher] = {}
        self._time: ntcore.DoublePublisher | None = None
        self._connected: ntcore.BooleanPublisher | None = None
        self._sent = 0

    async def open(self) -> None:
        """Listen, or begin to look for the robot."""
        import ntcore

        self._instance = ntcore.NetworkTableInstance.create()
        if self.options.robot:
            self._seek(self._instance)
        else:
            await self._serve(self._instance)
        table = self._instance.getTable(self.options.table)
        options = ntcore.PubSubOptions(periodic=PERIOD_S)
        self._values = {name: table.getDoubleTopic(name).publish(options) for name in VALUES}
        self._time = table.getDoubleTopic("time_s").publish(options)
        self._connected = table.getBooleanTopic("connected").publish(options)
        self.note(self.host.status)

    def take(self, samples: Sequence[Corrected]) -> None:
        """Publish what is due, stamped with when it was measured."""
        import ntcore

        now_s = ntcore._now() / US_PER_S  # noqa: SLF001 - the clock of NetworkTables has no other name in Python
        for each in samples:
            self._clock.note(each.sample.t_device_s, now_s)
        for each in self._thinning.due(samples):
            self._publish(each)
        if samples and self._connected is not None:
            self._connected.set(value=True)

    def hear(self, event: str, fields: Mapping[str, Any]) -> None:  # noqa: ARG002 - the name says all
        """A link that is lost is told at once."""
        if event == "link_lost" and self._connected is not None:
            self._connected.set(value=False)

    def note(self, status: ServiceStatus) -> None:
        """Tell whether the gyro is there and speaks."""
        if self._connected is not None:
            link = status.link
            self._connected.set(value=link.is_open and link.samples > 0 and link.silent_s < SILENT_S)

    def clients(self) -> Sequence[ClientStatus]:
        """Who is connected; the robot, where it is the server."""
        if self._instance is None:
            return ()
        found = self._instance.getConnections()
        return [ClientStatus(f"{each.remote_id} {shown(each.remote_ip, each.remote_port)}") for each in found]

    def counts(self) -> tuple[int, int]:
        """Samples published."""
        return self._sent, 0

    async def close(self) -> None:
        """Let go of the tables."""
        if self._instance is not None:
            import ntcore

            for publisher in (*self._values.values(), self._time, self._connected):
                if publisher is not None:
                    publisher.close()
            self._instance.stopClient()
            self._instance.stopServer()
            ntcore.NetworkTableInstance.destroy(self._instance)
            self._instance = None

    def _publish(self, sample: Corrected) -> None:
        assert self._instance is not None  # noqa: S101 - samples are taken while it is open
        assert self._time is not None  # noqa: S101 - likewise
        measured_us = round(self._clock.of(sample.sample.t_device_s) * US_PER_S)
        offset_us = self._instance.getServerTimeOffset() or 0
        for name, publisher in self._values.items():
            publisher.set(FIELDS[name](sample), measured_us)
        self._time.set((measured_us + offset_us) / US_PER_S, measured_us)
        self._sent += 1

    def _seek(self, instance: "ntcore.NetworkTableInstance") -> None:
        robot, port = self.options.robot, self.options.port
        if robot.isdecimal():
            instance.setServerTeam(int(robot), port)
        else:
            instance.setServer(robot, port)
        instance.startClient4(IDENTITY)
        self.address = f"team {robot}" if robot.isdecimal() else shown(robot, port)

    async def _serve(self, instance: "ntcore.NetworkTableInstance") -> None:
        host, port = await _free(self.options.host, self.options.port)
        instance.startServer(NO_FILE, host, NO_NT3, port)
        starting = instance.NetworkMode.kNetModeStarting.value
        while instance.getNetworkMode() & starting:  # noqa: ASYNC110 - ntcore has no event for it
            await asyncio.sleep(PERIOD_S)
        warn_of_others(self.host.log, self.options.host)
        self.address = shown(host, port)


class MeasuredTime:
    """Turns device time into the time of measurement on another clock, s, without the delays that vary.

    The smallest difference that was seen between arrival and device time is the one without waiting; it may grow as
    fast as clocks drift apart. What the fastest sample takes remains.
    """

    DRIFT = 5e-4
    """Of two clocks against each other, s/s: ten times what quartz does."""

    def __init__(self) -> None:
        self._difference_s = float("inf")
        self._at_s = 0.0

    def note(self, t_device_s: float, arrived_s: float) -> None:
        """A sample that arrived now."""
        grown_s = self._difference_s + self.DRIFT * abs(t_device_s - self._at_s)
        self._difference_s, self._at_s = min(grown_s, arrived_s - t_device_s), t_device_s

    def of(self, t_device_s: float) -> float:
        """When it was measured."""
        return t_device_s + self._difference_s


async def _free(host: str, port: int) -> tuple[str, int]:
    """The address in numbers and a port that can be had: ntcore itself says it nowhere that a port is taken."""
    try:
        found = await asyncio.get_running_loop().getaddrinfo(host, port, type=socket.SOCK_STREAM)
    except OSError as error:
        raise OutputError(f"{host} is no address: {error.strerror}") from error
    family, _, _, _, address = found[0]
    with socket.socket(family, socket.SOCK_STREAM) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind(address)
        except OSError as error:
            raise cannot_listen(error, host, port) from error
        return str(address[0]), int(probe.getsockname()[1])
