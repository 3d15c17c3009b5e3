"""Registry of the outputs by name. A new output needs its own file and a line here, or an entry point."""

from dataclasses import dataclass, is_dataclass
from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from gyrodrift.io.plug_ins import EntryPoint, PlugIns, subclass_of, summary
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
        for package in self.packages:
            if not _is_installed(package):
                from gyrodrift.io.installation import extra_command

                raise UsageError(f"output {self.name} needs the package {package}: {extra_command(self.extra)}")


def _is_installed(package: str) -> bool:
    try:
        return find_spec(package) is not None
    except ModuleNotFoundError:  # the parent package is missing
        return False


def _accept(entry: EntryPoint, value: Any) -> OutputKind:
    """Record of the class of another package; the first line of its docstring describes it."""
    from gyrodrift.outputs.output import Output

    output = subclass_of(Output, entry, value)
    if not is_dataclass(getattr(output, "options_type", None)):
        raise TypeError(f"{entry.value} has no options_type, the dataclass of its options")
    return OutputKind(entry.name, summary(output), entry.value)


OUTPUTS: PlugIns[OutputKind] = PlugIns("output", _accept)


def register(kind: OutputKind) -> None:
    """Add an output.

    Raises
    ------
    ValueError
        If the name is taken.
    """
    if kind.name in OUTPUTS.own:
        raise ValueError(f"there is an output {kind.name!r} already")
    OUTPUTS.own[kind.name] = kind


def unregister(name: str) -> None:
    """Remove an output."""
    del OUTPUTS.own[name]


def _own(name: str, about: str, target: str, packages: tuple[str, ...] = (), extra: str = "") -> OutputKind:
    """Record of an output of this package."""
    return OutputKind(name, about, f"{__package__}.{target}", packages, extra)


WS = ("websockets",)
SHIPPED = (
    _own("tcp", "JSON lines on a TCP port", "line_output:TcpOutput"),
    _own("unix", "JSON lines on a unix socket", "line_output:UnixOutput"),
    _own("udp", "JSON datagrams for PlotJuggler", "udp:UdpOutput"),
    _own("web", "live page for the browser", "web.output:WebOutput", WS, "websocket"),
    _own("gpsd", "JSON of gpsd, for clients of gpsd", "gpsd:GpsdOutput"),
    _own("nmea", "NMEA 0183: HDT, ROT and XDR", "nmea:NmeaOutput", ("pynmeagps",), "nmea"),
    _own("signalk", "deltas of Signal K on a TCP port", "signalk:SignalkOutput"),
    _own("rosbridge", "sensor_msgs/Imu over WebSocket, as in rosbridge", "rosbridge:RosbridgeOutput", WS, "websocket"),
    _own(
        "foxglove",
        "samples, state and link statistics for the Foxglove app",
        "foxglove:FoxgloveOutput",
        WS,
        "foxglove",
    ),
    _own("mqtt", "state topics on an MQTT broker, for Home Assistant", "mqtt:MqttOutput", ("aiomqtt",), "mqtt"),
    _own(
        "prometheus",
        "counters and gauges for Prometheus to scrape",
        "prometheus:PrometheusOutput",
        ("prometheus_client", *WS),
        "prometheus",
    ),
    _own(
        "networktables",
        "NetworkTables 4, for robots of FRC",
        "networktables:NetworkTablesOutput",
        ("msgpack", "ntcore", *WS),
        "networktables",
    ),
    _own(
        "mavlink",
        "MAVLink odometry or attitude over UDP or serial",
        "mavlink:MavlinkOutput",
        ("pymavlink",),
        "mavlink",
    ),
)

for _kind in SHIPPED:
    register(_kind)
