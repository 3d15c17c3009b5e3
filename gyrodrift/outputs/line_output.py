"""The outputs `tcp` and `unix`: JSON lines for each client, which may choose a rate and fields."""

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, TypeVar

from annotated_types import MaxLen

from gyrodrift import __version__
from gyrodrift.outputs.fields import CHOICES
from gyrodrift.outputs.json_line import chosen_line, json_line
from gyrodrift.outputs.net.json_input import parse_json
from gyrodrift.outputs.net.lines import LineClient, LineServer, LineSession
from gyrodrift.outputs.net.servers import ServerOutput
from gyrodrift.outputs.options import LOOPBACK, About, Host, Port, Rate
from gyrodrift.outputs.output import OutputHost
from gyrodrift.outputs.thinning import Thinning
from gyrodrift.values.sample import Corrected
from gyrodrift.values.words import did_you_mean

SAMPLE = '{"class":"SAMPLE",'
WATCH_KEYS = ("class", "rate_hz", "fields")

LONGEST_PATH = 107
"""Longest path in bytes: sun_path of unix(7)."""

NAME = "gyrodrift.sock"

LineOptions = TypeVar("LineOptions")


@dataclass(frozen=True, slots=True)
class TcpOptions:
    """Address and rate."""

    host: Annotated[Host, About("address to listen on")] = LOOPBACK
    port: Annotated[Port, About("port to listen on; 0 takes a free one")] = 7117
    rate_hz: Annotated[Rate, About("at most this many lines a second for clients that request no rate")] = None


@dataclass(frozen=True, slots=True)
class UnixOptions:
    """Address and rate."""

    path: Annotated[
        str, MaxLen(LONGEST_PATH), About(f"path of the socket; {NAME} in the runtime directory if empty")
    ] = ""
    rate_hz: Annotated[Rate, About("at most this many lines a second for clients that request no rate")] = None


class LineOutput(ServerOutput[LineOptions, "LineServer[JsonSession]"]):
    """JSON lines; a line that all clients get is encoded once."""

    def __init__(self, options: LineOptions, host: OutputHost, rate_hz: float | None) -> None:
        super().__init__(options, host)
        self.server = LineServer(
            lambda client: JsonSession(client, host.source), host.log, greet=lambda client: client.send(hello())
        )
        self._thinning = Thinning(rate_hz)

    def take(self, samples: Sequence[Corrected]) -> None:
        """Send samples to all clients, with the rate and fields that each has requested."""
        if not self.server.clients:
            return
        due = self._thinning.due(samples)
        lines: bytes | None = None
        for client, session in self.server.clients.items():
            if not session.is_plain:
                session.take(samples)
            elif due:
                if lines is None:
                    lines = "".join([json_line(sample, sample_opening(self.host.source)) for sample in due]).encode()
                client.send(lines, len(due))

    def hear(self, event: str, fields: Mapping[str, Any]) -> None:
        """Send an event to all clients."""
        line = event_line(event, fields)
        for client in self.server.clients:
            client.send(line)


class TcpOutput(LineOutput[TcpOptions]):
    """Sends a HELLO line and then samples to each client."""

    options_type = TcpOptions

    def __init__(self, options: TcpOptions, host: OutputHost) -> None:
        super().__init__(options, host, options.rate_hz)

    async def open(self) -> None:
        """Begin to listen."""
        self.address = await self.server.listen_tcp(self.options.host, self.options.port)


class UnixOutput(LineOutput[UnixOptions]):
    """Like `tcp`, but only for this user."""

    options_type = UnixOptions

    def __init__(self, options: UnixOptions, host: OutputHost) -> None:
        super().__init__(options, host, options.rate_hz)

    async def open(self) -> None:
        """Begin to listen."""
        self.address = await self.server.listen_unix(Path(self.options.path or runtime_folder() / NAME))


def runtime_folder() -> Path:
    """Runtime folder of the service under systemd or of the session of the user; otherwise /tmp."""
    for name in ("RUNTIME_DIRECTORY", "XDG_RUNTIME_DIR"):
        folder = os.environ.get(name, "").partition(":")[0]
        if folder and Path(folder).is_dir():
            return Path(folder)
    return Path("/tmp")  # noqa: S108 - the socket is only for this user, and a foreign socket is refused


def sample_opening(source: str) -> str:
    """Beginning of the line of a sample, with the name of its source if there are several."""
    return f'{SAMPLE}"source":"{source}",' if source else SAMPLE


def hello() -> bytes:
    """First line of a connection."""
    return _line({"class": "HELLO", "program": "gyrodrift", "version": __version__, "fields": list(CHOICES)})


def event_line(event: str, fields: Any) -> bytes:
    """Line with an event of the log of the service."""
    return _line({"class": "EVENT", "event": event, **fields})


class JsonSession(LineSession):
    """One client: all samples with all fields, until it sends a WATCH with a rate and fields."""

    def __init__(self, client: LineClient, source: str = "") -> None:
        self.client = client
        self._source = source
        self._thinning: Thinning | None = None
        self._fields: Sequence[str] = ()

    @property
    def is_plain(self) -> bool:
        """Whether the client has sent no WATCH."""
        return self._thinning is None and not self._fields

    def take(self, samples: Sequence[Corrected]) -> None:
        """Send samples with the rate and fields of the WATCH."""
        due = samples if self._thinning is None else self._thinning.due(samples)
        if self._fields:
            head = {"class": "SAMPLE"} | ({"source": self._source} if self._source else {})
            lines = [chosen_line(sample, self._fields, **head) for sample in due]
        else:
            lines = [json_line(sample, sample_opening(self._source)) for sample in due]
        if lines:
            self.client.send("".join(lines).encode(), len(lines))

    def line(self, text: bytes) -> None:
        """Take a WATCH; any other line is answered with an ERROR."""
        if not text.strip():
            return
        try:
            self._watch(parse_json(text))
        except ValueError as error:
            self.client.send(_line({"class": "ERROR", "message": f"{_shown(text)}: {error}"}))

    def dropped(self, messages: int) -> bytes:
        """Line with the number of dropped lines."""
        return _line({"class": "DROPPED", "lines": messages})

    def refused(self, why: str) -> bytes:
        """Last line of a connection that the service closes."""
        return _line({"class": "ERROR", "message": why})

    def _watch(self, request: Any) -> None:
        expected = 'expected {"class":"WATCH","rate_hz":10,"fields":["t_s","yaw_deg"]}'
        if not isinstance(request, dict) or request.get("class") != "WATCH":
            raise ValueError(expected)
        unknown = [key for key in request if key not in WATCH_KEYS]
        if unknown:
            raise ValueError(f"unknown key {unknown[0]!r}; {expected}")
        rate_hz, fields = request.get("rate_hz"), request.get("fields", [])
        if rate_hz is not None and not (_is_number(rate_hz) and 0.0 < rate_hz <= 1e6):
            raise ValueError("rate_hz: expected a number above 0, up to 1000000, in Hz")
        if not isinstance(fields, list) or len(fields) > len(CHOICES):
            raise ValueError("fields: expected a list of names")
        for name in fields:
            _check_field(name)
        self._thinning = Thinning(rate_hz) if rate_hz else None
        self._fields = fields
        self.client.send(_line({"class": "WATCH", "rate_hz": rate_hz, "fields": fields or list(CHOICES)}))


def _check_field(name: object) -> None:
    if isinstance(name, str) and name in CHOICES:
        return
    meant = did_you_mean(str(name), CHOICES) or f"there are {', '.join(CHOICES)}"
    raise ValueError(f"fields: {_shown(str(name).encode())} is no field; {meant}")


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _shown(text: bytes, most: int = 60) -> str:
    return repr(text[:most].decode(errors="replace"))


def _line(value: Any) -> bytes:
    return json.dumps(value).encode() + b"\n"
