"""JSON of gpsd on TCP, for existing clients on boats and in cars: VERSION, DEVICES, WATCH, POLL, and ATT.

The protocol is gpsd_json(5), version 3.14. It needs no gpsd; a running gpsd must have another port.

Each sample gives an ATT with the fields of gpsd, and a GYRO with all fields of the JSON line. GYRO is no class of gpsd;
libgps skips it. Angles in ATT are clockwise, as in gpsd; `rot` is in degrees per minute, negative to port. `pitch` is
positive with the bow up, `roll` with the starboard side down.
"""

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Annotated, Any

from gyrodrift import __version__
from gyrodrift.outputs.json_line import iso_time, present_fields
from gyrodrift.outputs.net.json_input import parse_json_at
from gyrodrift.outputs.net.lines import LineClient, LineServer, LineSession
from gyrodrift.outputs.net.servers import ServerOutput
from gyrodrift.outputs.options import LOOPBACK, About, Host, Port, Rate
from gyrodrift.outputs.output import OutputHost
from gyrodrift.outputs.status import ServiceStatus
from gyrodrift.outputs.thinning import Thinning
from gyrodrift.values.sample import Attitude, Corrected

PROTOCOL = (3, 14)
"""Major and minor version of the protocol."""

SHOWN = 40
"""Characters of a request that an error message shows."""


LONGEST_REQUEST = 1024
"""Longest line of requests; gpsd_json(5) says 80, but clients send more."""


@dataclass(frozen=True, slots=True)
class GpsdOptions:
    """Address and rate."""

    host: Annotated[Host, About("address to listen on")] = LOOPBACK
    port: Annotated[Port, About("port to listen on; 0 takes a free one")] = 2947
    rate_hz: Annotated[Rate, About("at most this many reports a second of device time")] = 10.0


class GpsdOutput(ServerOutput[GpsdOptions, "LineServer[GpsdSession]"]):
    """Serves clients of gpsd."""

    options_type = GpsdOptions

    def __init__(self, options: GpsdOptions, host: OutputHost) -> None:
        super().__init__(options, host)
        self.last: Corrected | None = None
        self.server = LineServer(lambda client: GpsdSession(client, self), host.log, _greet)
        self._thinning = Thinning(options.rate_hz)
        self._device = device_of(host.status)

    async def open(self) -> None:
        """Begin to listen."""
        self.address = await self.server.listen_tcp(self.options.host, self.options.port)

    def take(self, samples: Sequence[Corrected]) -> None:
        """Send reports to watching clients."""
        self.last = samples[-1]
        due = self._thinning.due(samples)
        if due and (watching := self._watching()):
            lines = b"".join(encoded(report) for sample in due for report in reports(sample, self.path))
            for client in watching:
                client.send(lines, 2 * len(due))

    def note(self, status: ServiceStatus) -> None:
        """Tell watching clients that the device came or went."""
        device = device_of(status)
        if device != self._device:
            self._device = device
            for client in self._watching():
                client.send(encoded(device))

    @property
    def path(self) -> str:
        """Name of the device for clients."""
        return path_of(self.host.status)

    def device(self) -> dict[str, Any]:
        """The DEVICE object."""
        return device_of(self.host.status)

    def _watching(self) -> list[LineClient]:
        return [client for client, session in self.server.clients.items() if session.is_watching]


class GpsdSession(LineSession):
    """One client, and its WATCH policy."""

    def __init__(self, client: LineClient, output: GpsdOutput) -> None:
        self._client, self._output = client, output
        self._is_enabled = self._is_json = False

    @property
    def is_watching(self) -> bool:
        """Whether the client gets reports."""
        return self._is_enabled and self._is_json

    def line(self, text: bytes) -> None:
        """Answer the requests of a line; as in gpsd, a mistake gives an ERROR."""
        try:
            for name, argument in requests(text.decode("ascii", "replace")):
                self._answer(name, argument)
        except ValueError as error:
            self._send({"class": "ERROR", "message": str(error)})

    def dropped(self, messages: int) -> bytes:
        """Message for a client that was too slow; not a class of gpsd."""
        return encoded({"class": "DROPPED", "messages": messages})

    def refused(self, why: str) -> bytes:
        """Message for a client whose connection is closed."""
        return encoded({"class": "ERROR", "message": why})

    def _answer(self, name: str, argument: dict[str, Any] | None) -> None:
        if name == "VERSION":
            self._send(version())
        elif name == "DEVICES":
            self._send(self._devices())
        elif name == "DEVICE" and argument is None:
            self._send(self._output.device())
        elif name == "DEVICE":
            raise ValueError("the device cannot be set from here")
        elif name == "WATCH":
            self._watch(argument)
        elif name == "POLL":
            self._send(self._poll())
        else:
            raise ValueError(f"Unrecognized request '?{name[:SHOWN]}'")

    def _watch(self, policy: dict[str, Any] | None) -> None:
        if policy is not None:
            named = policy.get("device", self._output.path)
            if named != self._output.path:
                shown = f" as {named[:SHOWN]}" if isinstance(named, str) else ""
                raise ValueError(f"No such device{shown}, there is {self._output.path}")
            self._is_enabled = _truth(policy, "enable", default=True)
            self._is_json = _truth(policy, "json", default=False)
            self._send(self._devices())
        unused = {"nmea": False, "raw": 0, "scaled": False, "timing": False, "split24": False, "pps": False}
        self._send({"class": "WATCH", "enable": self._is_enabled, "json": self._is_json, **unused})

    def _devices(self) -> dict[str, Any]:
        return {"class": "DEVICES", "devices": [self._output.device()]}

    def _poll(self) -> dict[str, Any]:
        """The last reports, after a WATCH as in gpsd. There is never a position."""
        path, last = self._output.path, self._output.last
        opening = {"class": "POLL", "time": iso_time(datetime.now(UTC).timestamp())}
        if last is None or not self._is_enabled:
            return {**opening, "active": 0, "tpv": [], "gst": [], "sky": [], "att": [], "gyro": []}
        att, gyro = reports(last, path)
        no_fix = {"class": "TPV", "device": path, "mode": 0}
        return {**opening, "active": 1, "tpv": [no_fix], "gst": [], "sky": [], "att": [att], "gyro": [gyro]}

    def _send(self, report: dict[str, Any]) -> None:
        self._client.send(encoded(report))


def requests(line: str) -> Iterator[tuple[str, dict[str, Any] | None]]:
    """Requests of a line: name, and the object behind `=` if there is one.

    Raises
    ------
    ValueError
        At an invalid request.
    """
    if len(line) > LONGEST_REQUEST:
        raise ValueError(f"a line of requests is longer than {LONGEST_REQUEST} characters")
    rest = line.strip(" ;")
    while rest:
        opening, _, _ = rest.partition(";")
        name, equals, _ = opening.partition("=")
        if not name.startswith("?"):
            raise ValueError(f"Unrecognized request '{rest[:SHOWN]}'")
        argument = None
        end = len(name)
        if equals:
            argument, end = _object_at(rest, len(name) + 1)
        yield name[1:].strip(), argument
        rest = rest[end:].lstrip(" ;")


def _object_at(text: str, start: int) -> tuple[dict[str, Any], int]:
    """JSON object at an index, and the index behind it."""
    try:
        value, end = parse_json_at(text, start)
    except ValueError:
        value, end = None, start
    if not isinstance(value, dict):
        raise ValueError(  # noqa: TRY004 - one kind of error for the client
            f"Invalid {text[1 : start - 1][:SHOWN]}: no JSON object follows the ="
        )
    return value, end


def _truth(policy: dict[str, Any], name: str, *, default: bool) -> bool:
    value = policy.get(name, default)
    if not isinstance(value, bool):
        raise ValueError(f"Invalid WATCH: {name} is true or false")  # noqa: TRY004 - one kind of error for the client
    return value


def path_of(status: ServiceStatus) -> str:
    """Name of the device for clients: its port."""
    return status.link.port or "gyrodrift"


def device_of(status: ServiceStatus) -> dict[str, Any]:
    """DEVICE object; only `activated` 0 for a device that is away."""
    opening = {"class": "DEVICE", "path": path_of(status)}
    if not status.link.is_open:
        return {**opening, "activated": 0}
    serial = {"bps": status.link.baud, "parity": "N", "stopbits": 1} if status.link.baud else {}
    name = {"subtype": status.device.device_id} if status.device.device_id else {}
    driver = {"driver": f"gyrodrift {status.link.protocol}"}
    return {**opening, **driver, **name, "activated": iso_time(status.started_s), "readonly": True, **serial}


def _greet(client: LineClient) -> None:
    client.send(encoded(version()))


def version() -> dict[str, Any]:
    """The VERSION object."""
    major, minor = PROTOCOL
    release = f"gyrodrift {__version__}"
    return {"class": "VERSION", "release": release, "rev": __version__, "proto_major": major, "proto_minor": minor}


def reports(sample: Corrected, path: str) -> tuple[dict[str, Any], dict[str, Any]]:
    """ATT and GYRO of a sample, without unknown values."""
    opening = {"device": path, "time": iso_time(sample.sample.t_host_s)}
    attitude = {
        "heading": sample.heading_deg,
        "yaw": clockwise_deg(sample.yaw_deg),
        **_tilt(sample.attitude),
        "rot": round(-60.0 * sample.corrected_dps, 3),
        "temp": sample.sample.temp_c,
    }
    present = {name: value for name, value in attitude.items() if value == value}  # noqa: PLR0124 - not NaN
    return {"class": "ATT", **opening, **present}, {"class": "GYRO", **opening, **present_fields(sample)}


def _tilt(attitude: Attitude | None) -> dict[str, float]:
    if attitude is None:
        return {}
    return {"pitch": round(-attitude.pitch_deg, 4), "roll": round(attitude.roll_deg, 4)}


def clockwise_deg(yaw_deg: float) -> float:
    """Convert unwrapped counter-clockwise yaw to clockwise from -180 to 180."""
    return round((180.0 - yaw_deg) % 360.0 - 180.0, 4)


def encoded(report: dict[str, Any]) -> bytes:
    """Encode a report as a line; libgps requires that no blank stands before the class."""
    return json.dumps(report, separators=(",", ":")).encode() + b"\r\n"
