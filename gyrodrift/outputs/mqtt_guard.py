"""What a broker may send: small packets, few of them. paho itself takes packets of 256 MB, and any number.

paho and aiomqtt have no option for it, so that the guard stands before the method through which all bytes come. The
tests with a hostile broker fail where a later version reads in another way.
"""

from typing import TYPE_CHECKING, Any

from gyrodrift.outputs.net.limits import Allowance

if TYPE_CHECKING:
    import aiomqtt

LONGEST_PACKET_BYTES = 16 << 10
"""A broker answers with a few bytes, and Home Assistant's birth message is a word."""

READS_PER_S = 1000.0
"""A packet takes three or four."""

MOST_WAITING = 200
"""Answers of ours that the broker has not read, and messages of which it has sent half the handshake."""


class BrokerGuard:
    """Ends the connection to a broker that sends too much.

    problem
        Why it was ended; empty where it was not.
    """

    def __init__(self, client: "aiomqtt.Client") -> None:
        self.problem = ""
        self._paho = _paho_of(client)
        self._receive = self._paho._sock_recv  # noqa: SLF001 - likewise
        self._allowance = Allowance(READS_PER_S)
        self._paho._sock_recv = self.receive  # noqa: SLF001 - likewise

    def receive(self, longest_bytes: int) -> bytes:
        """As the method of paho, which asks for a byte of a header or for the rest of a packet."""
        if longest_bytes > LONGEST_PACKET_BYTES:
            self._refuse(f"a packet of {longest_bytes} bytes, more than {LONGEST_PACKET_BYTES}")
        found: bytes = self._receive(longest_bytes)
        if not self._allowance.take():
            self._refuse(f"more than {READS_PER_S / 4:g} packets a second")
        if len(self._paho._out_packet) > MOST_WAITING or len(self._paho._in_messages) > MOST_WAITING:  # noqa: SLF001 - likewise
            self._refuse(f"more than {MOST_WAITING} packets that wait for an answer")
        return found

    def close(self) -> None:
        """Close what a connection that failed half way has left open: paho would go on to read from it."""
        if self._paho._sock is not None:  # noqa: SLF001 - likewise
            self._paho._sock_close()  # noqa: SLF001 - likewise

    def _refuse(self, why: str) -> None:
        self.problem = self.problem or f"the broker sends {why}"
        raise ConnectionError(self.problem)


def _paho_of(client: "aiomqtt.Client") -> Any:
    return client._client  # noqa: SLF001 - see above
