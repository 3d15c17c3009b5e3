"""Messages of `tcp` and `unix` to and from a client, one JSON object per line."""

import json
from collections.abc import Sequence
from typing import Any

from gyrodrift import __version__
from gyrodrift.outputs.fields import CHOICES
from gyrodrift.outputs.json_line import chosen_line, json_line
from gyrodrift.outputs.net.json_input import parse_json
from gyrodrift.outputs.net.lines import LineClient
from gyrodrift.outputs.thinning import Thinning
from gyrodrift.values.nearest import did_you_mean
from gyrodrift.values.sample import Corrected

SAMPLE = '{"class":"SAMPLE",'


def sample_opening(source: str) -> str:
    """Beginning of the line of a sample, with the name of its source if there are several."""
    return f'{SAMPLE}"source":"{source}",' if source else SAMPLE


WATCH_KEYS = ("class", "rate_hz", "fields")


def hello() -> bytes:
    """First line of a connection."""
    return _line({"class": "HELLO", "program": "gyrodrift", "version": __version__, "fields": list(CHOICES)})


def event_line(event: str, fields: Any) -> bytes:
    """Line with an event of the log of the service."""
    return _line({"class": "EVENT", "event": event, **fields})


class JsonSession:
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

    def closed(self) -> None:
        """Do nothing."""

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
