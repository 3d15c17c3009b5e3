"""Telnet as RFC 2217 uses it: data, commands and subnegotiations of one stream (RFC 854, RFC 855)."""

import re
from dataclasses import dataclass, field

IAC, DONT, DO, WONT, WILL, SB, SE = 255, 254, 253, 252, 251, 250, 240
COMMAND = re.compile(
    rb"\xff(?:(?P<doubled>\xff)|(?P<verb>[\xfb-\xfe])(?P<option>.)"
    rb"|\xfa(?P<content>(?:[^\xff]++|\xff[^\xf0])*+)\xff\xf0|[^\xfa-\xff])",
    re.DOTALL,
)
"""A doubled 255, a verb with its option, a subnegotiation, or another command."""

LONGEST_SUBNEGOTIATION = 512
"""A signature of RFC 2217 is the longest one, at most 255 characters; longer ones are dropped. Chosen: twice that."""


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
