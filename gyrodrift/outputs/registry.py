"""The outputs there are, by name; a line below is all that one needs beside its own file."""

from dataclasses import dataclass
from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from gyrodrift.errors import UsageError

if TYPE_CHECKING:
    from gyrodrift.outputs.output import Output


@dataclass(frozen=True, slots=True)
class OutputKind:
    """One of them.

    name
        What a person calls it.
    help
        What it does, in a few words.
    place
        `module:CLASS` of its `gyrodrift.outputs.output.Output`, imported when the output is asked for. The module
        imports without `packages`: what runs imports them, not what declares.
    packages
        Modules of other people that it needs, and `extra` the extra of this package that brings them.
    """

    name: str
    help: str
    place: str
    packages: tuple[str, ...] = ()
    extra: str = ""

    @property
    def output(self) -> "type[Output[Any]]":
        """Its class."""
        module, _, name = self.place.partition(":")
        found: type[Output[Any]] = getattr(import_module(module), name)
        return found

    def check_packages(self) -> None:
        """See that its packages are there.

        Raises
        ------
        UsageError
            With the command that installs what is missing.
        """
        from gyrodrift.installation import extra_command

        for package in self.packages:
            if not _is_there(package):
                raise UsageError(f"output {self.name} needs the package {package}: {extra_command(self.extra)}")


def _is_there(package: str) -> bool:
    try:
        return find_spec(package) is not None
    except ModuleNotFoundError:  # of the package that it stands in
        return False


OUTPUTS: dict[str, OutputKind] = {}


def register(kind: OutputKind) -> None:
    """Let the service send corrected samples to one place more.

    Raises
    ------
    ValueError
        Where the name is taken.
    """
    if kind.name in OUTPUTS:
        raise ValueError(f"there is an output {kind.name!r} already")
    OUTPUTS[kind.name] = kind


def unregister(name: str) -> None:
    """Take an output away again."""
    del OUTPUTS[name]


SHIPPED = (
    OutputKind("tcp", "newline JSON to whoever connects", "gyrodrift.outputs.tcp:TcpOutput"),
    OutputKind("unix", "newline JSON on a unix socket", "gyrodrift.outputs.unix:UnixOutput"),
    OutputKind("udp", "JSON datagrams, as PlotJuggler takes them", "gyrodrift.outputs.udp:UdpOutput"),
    OutputKind(
        "web",
        "a page for the browser",
        "gyrodrift.outputs.web.output:WebOutput",
        packages=("websockets",),
        extra="websocket",
    ),
    OutputKind("gpsd", "gpsd's JSON, for its clients", "gyrodrift.outputs.gpsd:GpsdOutput"),
    OutputKind(
        "nmea",
        "NMEA 0183: HDT, ROT and XDR",
        "gyrodrift.outputs.nmea:NmeaOutput",
        packages=("pynmeagps",),
        extra="nmea",
    ),
    OutputKind(
        "rosbridge",
        "sensor_msgs/Imu over WebSocket, as rosbridge has it",
        "gyrodrift.outputs.rosbridge:RosbridgeOutput",
        packages=("websockets",),
        extra="websocket",
    ),
    OutputKind(
        "foxglove",
        "samples, state and link statistics for the Foxglove app",
        "gyrodrift.outputs.foxglove:FoxgloveOutput",
        packages=("websockets",),
        extra="foxglove",
    ),
    OutputKind(
        "mqtt",
        "state topics on an MQTT broker, for Home Assistant",
        "gyrodrift.outputs.mqtt:MqttOutput",
        ("aiomqtt",),
        "mqtt",
    ),
    OutputKind(
        "prometheus",
        "counters and gauges for Prometheus to scrape",
        "gyrodrift.outputs.prometheus:PrometheusOutput",
        ("prometheus_client", "websockets"),
        "prometheus",
    ),
    OutputKind(
        "networktables",
        "NetworkTables 4, for robots of FRC",
        "gyrodrift.outputs.networktables:NetworkTablesOutput",
        ("msgpack", "ntcore", "websockets"),
        "networktables",
    ),
    OutputKind(
        "mavlink",
        "MAVLink odometry or attitude over UDP or serial",
        "gyrodrift.outputs.mavlink:MavlinkOutput",
        packages=("pymavlink",),
        extra="mavlink",
    ),
)

for _each in SHIPPED:
    register(_each)
