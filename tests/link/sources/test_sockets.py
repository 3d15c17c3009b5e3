"""Stream sockets and the serial port behind RFC 2217, byte by byte."""

import socket
from collections.abc import Iterator

import pytest

from gyrodrift.link.port import PortGoneError
from gyrodrift.link.sources.rfc2217 import Rfc2217Port
from gyrodrift.link.sources.sockets import SocketPort


@pytest.fixture
def pair() -> Iterator[tuple[socket.socket, socket.socket]]:
    ours, theirs = socket.socketpair()
    with ours, theirs:
        yield ours, theirs


class Reset:
    """A connection with some bytes, which is then reset."""

    def __init__(self, *chunks: bytes) -> None:
        self._chunks = list(chunks)

    def setblocking(self, _is_blocking: bool) -> None:  # noqa: FBT001 - as of a socket
        return

    def fileno(self) -> int:
        return -1

    def recv(self, _count: int) -> bytes:
        if not self._chunks:
            raise ConnectionResetError
        return self._chunks.pop(0)


@pytest.mark.promise("Samples")
def test_bytes_before_a_reset_are_read() -> None:
    """Bytes of a TCP server before a reset of its connection are read."""
    port = SocketPort("tcp://127.0.0.1:5", Reset(b"1000,0.5\n", b"2000,0.5\n"))  # type: ignore[arg-type]
    assert port.read() == b"1000,0.5\n2000,0.5\n"
    with pytest.raises(PortGoneError):
        port.read()


def test_a_serial_port_of_rfc_2217_is_set_to_eight_bits_no_parity_one_stop_bit(
    pair: tuple[socket.socket, socket.socket],
) -> None:
    """The values of RFC 2217, section 3: 8 bits, parity 1 (none), 1 stop bit, no flow control, DTR, RTS, purge."""
    ours, theirs = pair
    port = Rfc2217Port("rfc2217://127.0.0.1:5", ours)
    theirs.recv(1000)
    port.set_baud(57_600)
    commands = [(1, b"\x00\x00\xe1\x00"), (2, b"\x08"), (3, b"\x01"), (4, b"\x01"), (5, b"\x01"), (5, b"\x08")]
    commands += [(5, b"\x0b"), (12, b"\x01")]
    framed = b"".join(b"\xff\xfa\x2c" + bytes((number,)) + value + b"\xff\xf0" for number, value in commands)
    assert theirs.recv(1000) == framed
