"""JSON datagrams for the UDP server of PlotJuggler: objects with a `timestamp`; it numbers the values of a list.

In PlotJuggler: Streaming, UDP Server, port 9870, protocol JSON, "use field as timestamp if available": timestamp.
"""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Literal

from gyrodrift.outputs.fields import CHOICES
from gyrodrift.outputs.json_line import present_values
from gyrodrift.outputs.net.addresses import DatagramSender
from gyrodrift.outputs.options import LOOPBACK, About, Host, Port, Rate
from gyrodrift.outputs.output import Output, OutputHost
from gyrodrift.outputs.thinning import Thinning
from gyrodrift.values.sample import Corrected


@dataclass(frozen=True, slots=True)
class UdpOptions:
    """Receiver, rate and clock."""

    host: Annotated[Host, About("receiver: a name, an address, or a broadcast address")] = LOOPBACK
    port: Annotated[Port, About("port of the receiver")] = 9870
    rate_hz: Annotated[Rate, About("at most this many datagrams a second of device time")] = None
    timestamp: Annotated[
        Literal["host", "device"], About("clock of `timestamp`: host (Unix time) or device (s since its start)")
    ] = "host"


class UdpOutput(Output[UdpOptions]):
    """Sends a datagram per sample; datagrams that the network does not take are lost."""

    options_type = UdpOptions

    def __init__(self, options: UdpOptions, host: OutputHost) -> None:
        super().__init__(options, host)
        self._sender = DatagramSender()
        self._thinning = Thinning(options.rate_hz)
        self._clock = CHOICES["t_host_s" if options.timestamp == "host" else "t_s"].number

    async def open(self) -> None:
        """Resolve the receiver."""
        self.address = await self._sender.open(self.options.host, self.options.port)

    def take(self, samples: Sequence[Corrected]) -> None:
        """Send a datagram for each sample that is due."""
        for sample in self._thinning.due(samples):
            self._sender.send(self.datagram(sample))

    def datagram(self, sample: Corrected) -> bytes:
        """A sample for PlotJuggler, without unknown values; `gyro/NAME/yaw_deg` with several sources."""
        values: dict[str, Any] = present_values(sample)
        if self.host.source:
            values = {"gyro": {self.host.source: values}}
        return json.dumps({"timestamp": self._clock(sample), **values}).encode()

    def counts(self) -> tuple[int, int]:
        """Datagrams sent and dropped."""
        return self._sender.sent, self._sender.dropped

    async def close(self) -> None:
        """Close the socket."""
        self._sender.close()
