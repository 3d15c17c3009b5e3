"""Yaw as a plain number, one line per sample; the answer to `?` is the bias estimate."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

from gyrodrift.outputs.net.lines import LineClient, LineServer, LineSession
from gyrodrift.outputs.net.servers import ServerOutput
from gyrodrift.outputs.options import LOOPBACK, About, Host, Port, Rate
from gyrodrift.outputs.output import OutputHost
from gyrodrift.outputs.thinning import Thinning
from gyrodrift.sample import Corrected


@dataclass(frozen=True, slots=True)
class PlainYawOptions:
    """Address and rate."""

    host: Annotated[Host, About("address to listen on")] = LOOPBACK
    port: Annotated[Port, About("port to listen on; 0 takes a free one")] = 7000
    rate_hz: Annotated[Rate, About("at most this many lines a second of device time")] = None


class PlainYawOutput(ServerOutput[PlainYawOptions, "LineServer[PlainYawSession]"]):
    """Sends one line per sample."""

    options_type = PlainYawOptions

    def __init__(self, options: PlainYawOptions, host: OutputHost) -> None:
        super().__init__(options, host)
        self.server = LineServer(self._session, host.log)
        self._thinning = Thinning(options.rate_hz)

    async def open(self) -> None:
        """Listen."""
        self.address = await self.server.listen_tcp(self.options.host, self.options.port)

    def take(self, samples: Sequence[Corrected]) -> None:
        """Send the samples that are due to all clients."""
        due = self._thinning.due(samples)
        lines = "".join(f"{sample.yaw_deg:.3f}\n" for sample in due).encode()
        for client in self.server.clients:
            client.send(lines, len(due))

    def _session(self, client: LineClient) -> "PlainYawSession":
        return PlainYawSession(client, self.host)


class PlainYawSession(LineSession):
    """One client."""

    def __init__(self, client: LineClient, host: OutputHost) -> None:
        self._client, self._host = client, host

    def line(self, text: bytes) -> None:
        """Answer a question."""
        if text != b"?":
            raise ValueError("ask with ?")
        self._client.send(f"# bias_dps {self._host.status.filter.bias_dps:.5f}\n".encode())

    def dropped(self, messages: int) -> bytes:
        """Notice for a client that was too slow."""
        return b"# missed %d\n" % messages

    def refused(self, why: str) -> bytes:
        """Notice for a client that is disconnected."""
        return f"# {why}\n".encode()
