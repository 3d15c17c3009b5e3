"""Telnet as RFC 2217 uses it: data, commands and subnegotiations of one stream (RFC 854, RFC 855)."""

from dataclasses import dataclass, field

IAC, DONT, DO, WONT, WILL, SB, SE = 255, 254, 253, 252, 251, 250, 240
VERBS = frozenset({DONT, DO, WONT, WILL})

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
        """Content of the next bytes; an incomplete command waits."""
        content, received = self._pending + chunk, TelnetReceived()
        self._pending = b""
        parts: list[bytes] = []
        position = 0
        while (mark := content.find(IAC, position)) >= 0:
            parts.append(content[position:mark])
            end = self._command(content, mark, parts, received)
            if not end:
                self._wait(content[mark:])
                position = len(content)
                break
            position = end
        received.content = b"".join([*parts, content[position:]])
        return received

    def _wait(self, rest: bytes) -> None:
        """Keep an incomplete command; a subnegotiation that is too long is dropped."""
        self._pending = rest if len(rest) <= LONGEST_SUBNEGOTIATION else b""

    def _command(self, content: bytes, mark: int, parts: list[bytes], received: TelnetReceived) -> int:
        """Position after the command at `mark`; 0 if it is incomplete."""
        verb = content[mark + 1 : mark + 2]
        if not verb:
            return 0
        if verb[0] == IAC:
            parts.append(verb)
        elif verb[0] in VERBS:
            if len(content) < mark + 3:
                return 0
            received.commands.append((verb[0], content[mark + 2]))
            return mark + 3
        elif verb[0] == SB:
            end = content.find(bytes((IAC, SE)), mark + 2)
            if end < 0:
                return 0
            received.subnegotiations.append(unescaped(content[mark + 2 : end]))
            return end + 2
        return mark + 2


def unescaped(content: bytes) -> bytes:
    """Content without the doubling of 255."""
    return content.replace(b"\xff\xff", b"\xff")


def escaped(content: bytes) -> bytes:
    """Content with 255 doubled."""
    return content.replace(b"\xff", b"\xff\xff")
