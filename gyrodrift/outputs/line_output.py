"""Common part of `tcp` and `unix`: JSON lines for each client of a server of lines."""

from collections.abc import Mapping, Sequence
from typing import Any, TypeVar

from gyrodrift.outputs.json_line import json_line
from gyrodrift.outputs.line_session import JsonSession, event_line, hello, sample_opening
from gyrodrift.outputs.net.lines import LineServer
from gyrodrift.outputs.output import Output, OutputHost
from gyrodrift.outputs.status import ClientStatus
from gyrodrift.outputs.thinning import Thinning
from gyrodrift.values.sample import Corrected

LineOptions = TypeVar("LineOptions")


class LineOutput(Output[LineOptions]):
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
        for client in self.server.clients:
            session = client.session
            if isinstance(session, JsonSession) and not session.is_plain:
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

    def clients(self) -> Sequence[ClientStatus]:
        """Connected clients."""
        return self.server.statuses()

    def counts(self) -> tuple[int, int]:
        """Lines sent and dropped."""
        return self.server.counts()

    async def close(self) -> None:
        """Close the connections."""
        await self.server.close()
