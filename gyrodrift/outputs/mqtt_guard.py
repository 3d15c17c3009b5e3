"""Limits on size and number of packets from a broker."""

from typing import TYPE_CHECKING

from gyrodrift.io.paho_guard import PahoGuard
from gyrodrift.outputs.net.limits import Allowance

if TYPE_CHECKING:
    import aiomqtt

LONGEST_PACKET_BYTES = 16 << 10
"""Longest packet. A broker answers with a few bytes, and the birth message of Home Assistant is a word."""

READS_PER_S = 1000.0
"""Most reads a second; a packet takes three or four."""


class BrokerGuard(PahoGuard):
    """Ends the connection to a broker that sends too much, or too often."""

    def __init__(self, client: "aiomqtt.Client") -> None:
        super().__init__(client._client, LONGEST_PACKET_BYTES)  # noqa: SLF001 - no public name
        self._allowance = Allowance(READS_PER_S)

    def receive(self, longest_bytes: int) -> bytes:
        """Read, unless there were too many reads."""
        content = super().receive(longest_bytes)
        if not self._allowance.take():
            self.refuse(f"more than {READS_PER_S / 4:g} packets a second")
        return content
