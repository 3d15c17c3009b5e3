"""Limits on what a broker may send. paho itself takes packets of 256 MB, and any number of them.

paho has no such option, so the guard wraps the method that reads all bytes. Tests with a hostile broker fail if a later
version reads in another way.
"""

from typing import Any

MOST_WAITING = 200
"""Most answers that the broker has not read, and most messages with an incomplete handshake."""


class PahoGuard:
    """Ends the connection to a broker that sends too much.

    problem
        Reason for the end of the connection; empty while it is open.
    is_drained
        Whether the last read found no byte.
    """

    def __init__(self, paho: Any, longest_packet_bytes: int) -> None:
        self.problem = ""
        self.is_drained = False
        self._paho = paho
        self._longest_packet_bytes = longest_packet_bytes
        self._receive = paho._sock_recv  # noqa: SLF001 - no public name
        paho._sock_recv = self.receive  # noqa: SLF001 - no public name

    def receive(self, longest_bytes: int) -> bytes:
        """Read as the method of paho: a byte of a header, or the rest of a packet."""
        if longest_bytes > self._longest_packet_bytes:
            self.refuse(f"a packet of {longest_bytes} bytes, more than {self._longest_packet_bytes}")
        self.is_drained = True
        content: bytes = self._receive(longest_bytes)
        self.is_drained = False
        if len(self._paho._out_packet) > MOST_WAITING or len(self._paho._in_messages) > MOST_WAITING:  # noqa: SLF001 - no public name
            self.refuse(f"more than {MOST_WAITING} packets that wait for an answer")
        return content

    def close(self) -> None:
        """Close the socket of a failed connection; paho would continue to read from it."""
        if self._paho._sock is not None:  # noqa: SLF001 - no public name
            self._paho._sock_close()  # noqa: SLF001 - no public name

    def refuse(self, why: str) -> None:
        """End the connection.

        Raises
        ------
        ConnectionError
            Always; paho closes the connection.
        """
        self.problem = self.problem or f"the broker sends {why}"
        raise ConnectionError(self.problem)
