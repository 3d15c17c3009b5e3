"""NetworkTables 4.1 for FRC: yaw, rate and sigma with the time of measurement, and the state of the connection.

A device with three axes has its attitude too: as angles, and as a Rotation3d of WPILib. Axes are those of REP 103.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from struct import Struct
from typing import Annotated, Any, TypeVar

from annotated_types import MaxLen, MinLen

from gyrodrift.outputs.device_frame import UNTURNED, DeviceFrame
from gyrodrift.outputs.fields import OF_EVERY_DEVICE, OF_THREE_AXES, Use, fields_of
from gyrodrift.outputs.networktables_robot import RobotTables
from gyrodrift.outputs.networktables_server import ServedTables, TopicValue
from gyrodrift.outputs.options import LOOPBACK, About, Host, Port, Rate
from gyrodrift.outputs.output import Output, OutputHost
from gyrodrift.outputs.status import ClientStatus, ServiceStatus
from gyrodrift.outputs.thinning import Thinning
from gyrodrift.values.constants import US_PER_S
from gyrodrift.values.sample import Attitude, Corrected

T = TypeVar("T")

VALUES = {field.name: field.number for field in fields_of(Use.TOPIC, OF_EVERY_DEVICE)}
TOPICS = {**dict.fromkeys((*VALUES, "time_s"), "double"), "connected": "boolean"}
"""Type of each topic of the table."""

TILT_VALUES = {field.name: field.number for field in fields_of(Use.TOPIC, OF_THREE_AXES)}
TILT_TOPICS = {**dict.fromkeys(TILT_VALUES, "double"), "rotation": "struct:Rotation3d"}
"""Further topics of a device with three axes; other devices do not have them."""

ROTATION = Struct("<4d")
"""Rotation3d of WPILib: a quaternion w, x, y, z."""

SCHEMAS = {"struct:Quaternion": "double w;double x;double y;double z", "struct:Rotation3d": "Quaternion q"}
"""Layouts by type, as WPILib writes them (wpimath, QuaternionStruct and Rotation3dStruct)."""

SILENT_S = 1.0
"""Time without a sample after which the gyro counts as not connected, s."""


@dataclass(frozen=True, slots=True)
class NetworkTablesOptions:
    """Server, table and rate."""

    robot: Annotated[
        str,
        MaxLen(253),
        About("server to publish to: address or team number of the robot; if empty, be a server"),
    ] = ""
    host: Annotated[Host, About("address to listen on, as a server")] = LOOPBACK
    port: Annotated[Port, About("port of the server; 0 takes a free one")] = 5810
    table: Annotated[str, MinLen(1), MaxLen(64), About("table of the topics")] = "gyrodrift"
    rate_hz: Annotated[Rate, About("at most this many values a second of device time")] = 100.0


class MeasuredTime:
    """Converts device time to another clock, s, without the variable part of the delay.

    The smallest difference between arrival and device time is the one without waiting. It may grow as fast as clocks
    drift apart. The delay of the fastest sample remains.
    """

    DRIFT = 5e-4
    """Largest drift of two clocks, s/s: ten times that of quartz."""

    def __init__(self) -> None:
        self._difference_s = float("inf")
        self._at_s = 0.0

    def note(self, t_device_s: float, arrived_s: float) -> None:
        """Note the arrival of a sample."""
        grown_s = self._difference_s + self.DRIFT * abs(t_device_s - self._at_s)
        self._difference_s, self._at_s = min(grown_s, arrived_s - t_device_s), t_device_s

    def of(self, t_device_s: float) -> float:
        """Time of measurement, s."""
        return t_device_s + self._difference_s


class NetworkTablesOutput(Output[NetworkTablesOptions]):
    """A client of the robot, which reconnects by itself, or a server that takes no values from clients."""

    options_type = NetworkTablesOptions

    def __init__(self, options: NetworkTablesOptions, host: OutputHost) -> None:
        super().__init__(options, host)
        self._thinning = Thinning(options.rate_hz)
        self._clock = MeasuredTime()
        self._sent = 0
        self._mount = UNTURNED
        self._has_tilt = False
        self._prefix = "/".join(["", options.table.strip("/"), *filter(None, [host.source]), ""])
        topics = {f"{self._prefix}{name}": kind for name, kind in TOPICS.items()}
        self._tables: RobotTables | ServedTables = (
            RobotTables(options.robot, options.port, topics, host.log)
            if options.robot
            else ServedTables(options.host, options.port, topics, host.log)
        )

    async def open(self) -> None:
        """Listen, or begin to connect to the robot."""
        self.address = await self._tables.open()
        self.note(self.host.status)

    def take(self, samples: Sequence[Corrected]) -> None:
        """Publish values that are due, with the time of measurement."""
        now_s = self._tables.now_s()
        for sample in samples:
            self._clock.note(sample.sample.t_device_s, now_s)
        for sample in self._thinning.due(samples):
            self._publish(sample)
        if samples:
            self._say_connected(is_connected=True)

    def hear(self, event: str, fields: Mapping[str, Any]) -> None:  # noqa: ARG002 - the name says all
        """Report a lost link at once."""
        if event == "link_lost":
            self._say_connected(is_connected=False)

    def note(self, status: ServiceStatus) -> None:
        """Report whether the gyro is connected."""
        link = status.link
        self._mount = DeviceFrame.of(status.config.mount)
        self._say_connected(is_connected=link.is_open and link.samples > 0 and link.silent_s < SILENT_S)
        self.warning = self._tables.check()

    def clients(self) -> Sequence[ClientStatus]:
        """Connected clients, or the robot if it is the server."""
        return self._tables.clients()

    def counts(self) -> tuple[int, int]:
        """Samples published, and messages dropped for slow clients."""
        return self._sent, self._tables.dropped()

    async def close(self) -> None:
        """Close the tables."""
        await self._tables.close()

    def _publish(self, sample: Corrected) -> None:
        measured_s = self._clock.of(sample.sample.t_device_s)
        values: dict[str, TopicValue] = {name: of(sample) for name, of in VALUES.items()}
        values["time_s"] = measured_s + self._tables.server_offset_s()
        if sample.attitude is not None:
            values |= self._tilt(sample, sample.attitude)
        self._tables.publish(self._named(values), round(measured_s * US_PER_S))
        self._sent += 1

    def _tilt(self, sample: Corrected, attitude: Attitude) -> dict[str, TopicValue]:
        """Values of the further topics, which are announced with the first sample that has them."""
        if not self._has_tilt:
            self._has_tilt = True
            self._tables.add(self._named(TILT_TOPICS), SCHEMAS)
        q = self._mount.attitude(attitude, sample.yaw_deg, sample.yaw_deg)
        return {name: of(sample) for name, of in TILT_VALUES.items()} | {"rotation": ROTATION.pack(*q)}

    def _say_connected(self, *, is_connected: bool) -> None:
        self._tables.publish(self._named({"connected": is_connected}))

    def _named(self, values: Mapping[str, T]) -> dict[str, T]:
        return {f"{self._prefix}{name}": value for name, value in values.items()}
