"""Registry of the outputs by name. A new output needs its own file and a line here."""

from dataclasses import dataclass
from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from gyrodrift.values.errors import UsageError

if TYPE_CHECKING:
    from gyrodrift.outputs.output import Output


@dataclass(frozen=True, slots=True)
class OutputKind:
    """An output that exists.

    name
        Name in --output and in the config.
    help
        Description in a few words.
    target
        `module:CLASS` of its `gyrodrift.outputs.output.Output`, imported when the output is wanted. The module can be
        imported without `packages`.
    packages
        Packages that it needs; `extra` is the extra of gyrodrift that installs them.
    """

    name: str
    help: str
    target: str
    packages: tuple[str, ...] = ()
    extra: str = ""

    @property
    def output(self) -> "type[Output[Any]]":
        """Class of the output."""
        module, _, name = self.target.partition(":")
        output_class: type[Output[Any]] = getattr(import_module(module), name)
        return output_class

    def check_packages(self) -> None:
        """Check that its packages are installed.

        Raises
        ------
        UsageError
            With the command that installs a missing package.
        """
        from gyrodrift.io.installation import extra_command

        for package in self.packages:
            if not _is_installed(package):
                raise UsageError(f"output {self.name} needs the package {package}: {extra_command(self.extra)}")


def _is_installed(package: str) -> bool:
    try:
        return find_spec(package) is not None
    except ModuleNotFoundError:  # the parent package is missing
        return False


OUTPUTS: dict[str, OutputKind] = {}


def register(kind: OutputKind) -> None:
    """Add an output.

    Raises
    ------
    ValueError
        If the name is taken.
    """
    if kind.name in OUTPUTS:
        raise ValueError(f"there is an output {kind.name!r} already")
    OUTPUTS[kind.name] = kind


def unregister(name: str) -> None:
    """Remove an output."""
    del OUTPUTS[name]


SHIPPED = (
    OutputKind("tcp", "JSON lines on a TCP port", "gyrodrift.outputs.line_output:TcpOutput"),
    OutputKind("unix", "JSON lines on a unix socket", "gyrodrift.outputs.line_output:UnixOutput"),
    OutputKind("udp", "JSON datagrams for PlotJuggler", "gyrodrift.outputs.udp:UdpOutput"),
    OutputKind(
        "web",
        "live page for the browser",
        "gyrodrift.outputs.web.output:WebOutput",
        packages=("websockets",),
        extra="websocket",
    ),
    OutputKind("gpsd", "JSON of gpsd, for clients of gpsd", "gyrodrift.outputs.gpsd:GpsdOutput"),
    OutputKind(
        "nmea",
        "NMEA 0183: HDT, ROT and XDR",
        "gyrodrift.outputs.nmea:NmeaOutput",
        packages=("pynmeagps",),
        extra="nmea",
    ),
    OutputKind("signalk", "deltas of Signal K on a TCP port", "gyrodrift.outputs.signalk:SignalkOutput"),
    OutputKind(
        "rosbridge",
        "sensor_msgs/Imu over WebSocket, as in rosbridge",
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

for _kind in SHIPPED:
    register(_kind)
