"""Source `rfc2217://HOST:PORT`: a serial port of another machine, with its baud rate (RFC 2217).

Data, commands and subnegotiations share one stream (RFC 854, RFC 855). The client of pyserial reads in a thread, byte
by byte and without a limit (docs/blind-alleys.md); this one has a descriptor to wait for.
"""

import re
import select
import socket
import time
from dataclasses import dataclass, field

from gyrodrift.link.port import READ_BYTES, PortGoneError
from gyrodrift.link.sources.sockets import SocketPort, connected
from gyrodrift.link.sources.source import ByteSource, SourceAddress
from gyrodrift.values.errors import LinkError

IAC, DONT, DO, WONT, WILL, SB, SE = 255, 254, 253, 252, 251, 250, 240
COMMAND = re.compile(
    rb"\xff(?:(?P<doubled>\xff)|(?P<verb>[\xfb-\xfe])(?P<option>.)"
    rb"|\xfa(?P<content>(?:[^\xff]++|\xff[^\xf0])*+)\xff\xf0|[^\xfa-\xff])",
    re.DOTALL,
)
"""A doubled 255, a verb with its option, a subnegotiation, or another command."""

LONGEST_SUBNEGOTIATION = 512
"""A signature of RFC 2217 is the longest one, at most 255 characters; longer ones are dropped. Chosen: twice that."""

BINARY, SUPPRESS_GO_AHEAD, COM_PORT = 0, 3, 44

OFFERED = frozenset({BINARY, SUPPRESS_GO_AHEAD, COM_PORT})
"""Options of RFC 856, RFC 858 and RFC 2217."""

SET_BAUD, SET_DATA_BITS, SET_PARITY, SET_STOP_BITS, SET_CONTROL, PURGE = 1, 2, 3, 4, 5, 12

ANSWER = 100
"""The server answers a command with its number plus 100 (RFC 2217, section 3)."""

NO_PARITY, ONE_STOP_BIT, NO_FLOW_CONTROL, DTR_ON, RTS_ON, RECEIVED = 1, 1, 1, 8, 11, 1

ANSWER_S = 3.0
"""Longest wait for the server to accept RFC 2217, s; pyserial's client waits as long."""


@dataclass(slots=True)
class TelnetReceived:
    """Content of received bytes: data, pairs of verb and option, and subnegotiations without their frame."""

    content: bytes = b""
    commands: list[tuple[int, int]] = field(default_factory=list)
    subnegotiations: list[bytes] = field(default_factory=list)


class TelnetStream:
    """Splits a stream, in any pieces."""

    def __init__(self) -> None:
        self._pending = b""

    def push(self, chunk: bytes) -> TelnetReceived:
        """Content of the next bytes; an incomplete command waits, unless it is too long."""
        content, received = self._pending + chunk, TelnetReceived()
        parts: list[bytes] = []
        position = 0
        while (mark := content.find(IAC, position)) >= 0 and (match := COMMAND.match(content, mark)):
            parts.append(content[position:mark])
            position = match.end()
            if match["doubled"]:
                parts.append(match["doubled"])
            elif match["verb"]:
                received.commands.append((match["verb"][0], match["option"][0]))
            elif match["content"] is not None:
                received.subnegotiations.append(unescaped(match["content"]))
        end = len(content) if mark < 0 else mark
        received.content = b"".join([*parts, content[position:end]])
        self._pending = content[end:] if len(content) - end <= LONGEST_SUBNEGOTIATION else b""
        return received


def unescaped(content: bytes) -> bytes:
    """Content without the doubling of 255."""
    return content.replace(b"\xff\xff", b"\xff")


def escaped(content: bytes) -> bytes:
    """Content with 255 doubled."""
    return content.replace(b"\xff", b"\xff\xff")


class Rfc2217Port(SocketPort):
    """Serial port behind a server."""

    has_line_rate = True

    def __init__(self, path: str, connection: socket.socket) -> None:
        super().__init__(path, connection)
        self._stream = TelnetStream()
        self._content = b""
        self._baud = 0
        self._declined = set[tuple[int, int]]()
        self._is_accepted: bool | None = None
        for option in (BINARY, SUPPRESS_GO_AHEAD):
            self._say(WILL, option)
            self._say(DO, option)
        self._say(WILL, COM_PORT)

    def read(self) -> bytes:
        """Available bytes of the serial port, up to a limit, without waiting."""
        if not self._content:
            self._take(self._stream.push(super().read()))
        content, self._content = self._content, b""
        return content

    def write(self, content: bytes) -> int:
        """Send without waiting; a part of the bytes may be taken."""
        piece = content
        while len(escaped(piece)) != len(piece) and len(piece) > 1:
            piece = piece[: max(1, piece.find(b"\xff"))]
        sent = super().write(escaped(piece))
        return len(piece) if sent >= len(escaped(piece)) else min(sent, len(piece))

    def set_baud(self, baud: int) -> None:
        """Change the baud rate of the serial port, and drop bytes received at the old one."""
        self._baud = baud
        self._command(SET_BAUD, baud.to_bytes(4, "big"))
        for command, value in (
            (SET_DATA_BITS, 8),
            (SET_PARITY, NO_PARITY),
            (SET_STOP_BITS, ONE_STOP_BIT),
            (SET_CONTROL, NO_FLOW_CONTROL),
            (SET_CONTROL, DTR_ON),
            (SET_CONTROL, RTS_ON),
            (PURGE, RECEIVED),
        ):
            self._command(command, bytes((value,)))
        self._content = b""

    def negotiate(self) -> None:
        """Wait until the server accepts RFC 2217.

        Raises
        ------
        LinkError
            It refuses, or does not answer.
        """
        until_s = time.monotonic() + ANSWER_S
        while self._is_accepted is None and (left_s := until_s - time.monotonic()) > 0.0:
            select.select([self._connection], [], [], left_s)
            try:
                self._take(self._stream.push(super().read()))
            except PortGoneError as error:
                raise LinkError(f"{self.path}: the server closed the connection; is the serial port in use?") from error
            self._content = self._content[-READ_BYTES:]
        if not self._is_accepted:
            address = self.path.partition("://")[2]
            raise LinkError(
                f"{self.path}: the server does not answer in RFC 2217; use tcp://{address}, and set the baud rate there"
            )

    def _take(self, received: TelnetReceived) -> None:
        self._content += received.content
        for verb, option in received.commands:
            if option == COM_PORT and verb in (DO, DONT):
                self._is_accepted = verb == DO
            elif option not in OFFERED and verb in (DO, WILL) and (verb, option) not in self._declined:
                self._declined.add((verb, option))  # an answer to each repetition could go on for ever (RFC 854)
                self._say(WONT if verb == DO else DONT, option)
        for content in received.subnegotiations:
            if content[:2] == bytes((COM_PORT, ANSWER + SET_BAUD)):
                self._check_baud(int.from_bytes(content[2:6], "big"))

    def _check_baud(self, baud: int) -> None:
        if self._baud and baud != self._baud:
            self.note("baud_differs", wanted=self._baud, of_server=baud)

    def _say(self, verb: int, option: int) -> None:
        super().write(bytes((IAC, verb, option)))

    def _command(self, command: int, value: bytes) -> None:
        super().write(bytes((IAC, SB, COM_PORT, command)) + escaped(value) + bytes((IAC, SE)))


def open_rfc2217(address: SourceAddress) -> Rfc2217Port:
    """Connect to a server, and wait until it accepts RFC 2217."""
    port = Rfc2217Port(address.text, connected(address))
    try:
        port.negotiate()
    except LinkError:
        port.close()
        raise
    return port


RFC2217 = ByteSource(
    "rfc2217",
    "rfc2217://HOST:PORT",
    "serial port of another machine, with its baud rate",
    open_rfc2217,
    has_baud=True,
    silence="the server has opened its serial port; check the power of the device and its cable there",
)
