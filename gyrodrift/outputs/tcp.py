"""JSON lines on a TCP port."""

from dataclasses import dataclass
from typing import Annotated

from gyrodrift.outputs.line_output import LineOutput
from gyrodrift.outputs.options import LOOPBACK, About, Host, Port, Rate
from gyrodrift.outputs.output import OutputHost


@dataclass(frozen=True, slots=True)
class TcpOptions:
    """Address and rate."""

    host: Annotated[Host, About("address to listen on")] = LOOPBACK
    port: Annotated[Port, About("port to listen on; 0 takes a free one")] = 7117
    rate_hz: Annotated[Rate, About("at most this many lines a second for clients that request no rate")] = None


class TcpOutput(LineOutput[TcpOptions]):
    """Sends a HELLO line and then samples to each client."""

    options_type = TcpOptions

    def __init__(self, options: TcpOptions, host: OutputHost) -> None:
        super().__init__(options, host, options.rate_hz)

    async def open(self) -> None:
        """Begin to listen."""
        self.address = await self.server.listen_tcp(self.options.host, self.options.port)
