"""Limits on size and number of packets from a broker. paho itself takes packets of 256 MB, and any number.

paho and aiomqtt have no such option, so the guard wraps the method that reads all bytes. Tests with a hostile broker
fail if a later version reads in another way.
"""

from typing import TYPE_CHECKING, Any

from gyrodrift.outputs.net.limits import Allowance

if TYPE_CHECKING:
    import aiomqtt

LONGEST_PACKET_BYTES = 16 << 10
"""Longest packet. A broker answers with a few bytes, and the birth message of Home Assistant is a word."""

READS_PER_S = 1000.0
"""Most reads a second; a packet takes three or four."""

MOST_WAITING = 200
"""Most answers that the broker has not read, and most messages with an incomplete handshake."""


class BrokerGuard:
    """Ends the connection to a broker that sends too much.

    problem
        Reason for the end of the connection; empty while it is open.
    """

    def __init__(self, client: "aiomqtt.Client") -> None:
        self.problem = ""
        self._paho = _paho_of(client)
        self._receive = self._paho._sock_recv  # noqa: SLF001 - no public name
        self._allowance = Allowance(READS_PER_S)
        self._paho._sock_recv = self.receive  # noqa: SLF001 - no public name

    def receive(self, longest_bytes: int) -> bytes:
        """Read as the method of paho: a byte of a header, or the rest of a packet."""
        if longest_bytes > LONGEST_PACKET_BYTES:
            self._refuse(f"a packet of {longest_bytes} bytes, more than {LONGEST_PACKET_BYTES}")
        content: bytes = self._receive(longest_bytes)
        if not self._allowance.take():
            self._refuse(f"more than {READS_PER_S / 4:g} packets a second")
        if len(self._paho._out_packet) > MOST_WAITING or len(self._paho._in_messages) > MOST_WAITING:  # noqa: SLF001 - no public name
            self._refuse(f"more than {MOST_WAITING} packets that wait for an answer")
        return content

    def close(self) -> None:
        """Close the socket of a failed connection; paho would continue to read from it."""
        if self._paho._sock is not None:  # noqa: SLF001 - no public name
            self._paho._sock_close()  # noqa: SLF001 - no public name

    def _refuse(self, why: str) -> None:
        self.problem = self.problem or f"the broker sends {why}"
        raise ConnectionError(self.problem)


def _paho_of(client: "aiomqtt.Client") -> Any:
    return client._client  # noqa: SLF001 - no public name
