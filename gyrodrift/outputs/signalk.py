"""Deltas of Signal K on TCP, one JSON object a line, for a data connection of a Signal K server.

Angles are in rad, rates in rad/s, positive to starboard. Pitch is positive with the bow up, roll with the starboard
side down. A device with one axis has no roll and pitch, and so no attitude.
Source: Signal K 1.7.0, "Delta Format" and the paths of `navigation`.
"""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from math import isnan, pi, radians, remainder
from typing import Annotated, Any

from gyrodrift.outputs.json_line import iso_time
from gyrodrift.outputs.net.lines import LineServer, LineSession
from gyrodrift.outputs.net.servers import ServerOutput
from gyrodrift.outputs.options import LOOPBACK, About, Host, Port, Rate
from gyrodrift.outputs.output import OutputHost
from gyrodrift.outputs.thinning import Thinning
from gyrodrift.values.sample import Corrected

DIGITS = 6
"""Digits behind the point: 1e-6 rad is 6e-5 deg."""


@dataclass(frozen=True, slots=True)
class SignalkOptions:
    """Address and rate."""

    host: Annotated[Host, About("address to listen on")] = LOOPBACK
    port: Annotated[Port, About("port to listen on; 0 takes a free one")] = 8375
    rate_hz: Annotated[Rate, About("at most this many deltas a second of device time")] = 10.0


class SignalkOutput(ServerOutput[SignalkOptions, LineServer[LineSession]]):
    """Sends a delta per sample to each client. A server takes only deltas, so losses are told in `status` alone."""

    options_type = SignalkOptions

    def __init__(self, options: SignalkOptions, host: OutputHost) -> None:
        super().__init__(options, host)
        self._thinning = Thinning(options.rate_hz)
        self.server = LineServer(lambda _: LineSession(), host.log)

    async def open(self) -> None:
        """Begin to listen."""
        self.address = await self.server.listen_tcp(self.options.host, self.options.port)

    def take(self, samples: Sequence[Corrected]) -> None:
        """Send the deltas of samples that are due."""
        for sample in self._thinning.due(samples) if self.server.clients else ():
            line = json.dumps(delta(sample, self.host.source), separators=(",", ":")).encode() + b"\n"
            for client in self.server.clients:
                client.send(line)


def delta(sample: Corrected, source: str = "") -> dict[str, Any]:
    """Delta of a sample, without unknown values; the label has the name of its source if there are several."""
    values: dict[str, Any] = {"navigation.rateOfTurn": _rounded(-radians(sample.corrected_dps))}
    if not isnan(sample.heading_deg):
        values["navigation.headingTrue"] = _rounded(radians(sample.heading_deg) % (2.0 * pi))
    attitude = sample.attitude
    if attitude is not None and not isnan(attitude.roll_deg + attitude.pitch_deg):
        values["navigation.attitude"] = {
            "roll": _rounded(radians(attitude.roll_deg)),
            "pitch": _rounded(-radians(attitude.pitch_deg)),
            "yaw": _rounded(remainder(-radians(sample.yaw_deg), 2.0 * pi)),
        }
    update = {
        "source": {"label": ".".join(filter(None, ("gyrodrift", source)))},
        "timestamp": iso_time(sample.sample.t_host_s),
        "values": [{"path": path, "value": value} for path, value in values.items()],
    }
    return {"updates": [update]}


def _rounded(value: float) -> float:
    return round(value, DIGITS) + 0.0  # no -0.0
