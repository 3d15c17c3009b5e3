r"""Send bytes to a device after its port was opened, if it waits for a key or a command (`--send '\r\n'`).

Opening the port resets many boards, and bytes that arrive while a board boots are lost. So they are sent again after
every silence until samples arrive. The silences double, since the board may be busy with a command.
"""

import re
from collections.abc import Callable
from typing import Any

from gyrodrift.link.sources.source import SourcePort

SEND_LONGEST_BYTES = 4096
"""Size of the input buffer of a Linux terminal (`N_TTY_BUF_SIZE`)."""

SILENCE_S = 2.0
"""Longer than the Arduino bootloader waits for an upload, 1 s."""

SILENCE_LONGEST_S = 16.0
QUOTED_BYTES = 40

ESCAPE = re.compile(r"\\(?:([0-7]{1,3})|x([0-9A-Fa-f]{2})|(.?))", re.DOTALL)
NAMED = {
    "\\": b"\\",
    "'": b"'",
    '"': b'"',
    "a": b"\a",
    "b": b"\b",
    "f": b"\f",
    "n": b"\n",
    "r": b"\r",
    "t": b"\t",
    "v": b"\v",
}
"""Named escapes of a bytes literal of Python."""


def bytes_to_send(text: str) -> bytes:
    r"""Bytes of a text with escapes, such as `r\n` or `\x1b[c`; other characters in UTF-8.

    Raises
    ------
    ValueError
        An escape is unknown, or there are too many bytes, or none.
    """
    content, end = b"", 0
    for match in ESCAPE.finditer(text):
        content += _utf8(text[end : match.start()]) + _escaped(match)
        end = match.end()
    content += _utf8(text[end:])
    if not 0 < len(content) <= SEND_LONGEST_BYTES:
        raise ValueError(f"is {len(content)} bytes; expected 1 to {SEND_LONGEST_BYTES}")
    return content


def _utf8(text: str) -> bytes:
    """Encode as UTF-8; invalid bytes of a command line are kept."""
    return text.encode("utf-8", "surrogateescape")


def _escaped(match: re.Match[str]) -> bytes:
    octal, hexadecimal, name = match.groups()
    value = int(octal, 8) if octal else int(hexadecimal, 16) if hexadecimal else None
    content = NAMED.get(name or "") if value is None else bytes((value,)) if value <= 0xFF else None
    if content is None:
        raise ValueError(rf"has the unknown escape {match[0]}; examples are \r, \n, \t, \\, \x1b (two digits)")
    return content


class Opening:
    """Sender of `content` after the port was opened, and again after silences, until the first samples."""

    def __init__(self, content: bytes, on_event: Callable[..., Any]) -> None:
        self.content = content
        self._on_event = on_event
        self._unsent = b""
        self._silence_s = SILENCE_S
        self._heard_s: float | None = None

    def begin(self, port: SourcePort, now_s: float) -> None:
        """Handle an opened port, or a new baud rate."""
        self._silence_s = SILENCE_S
        self._send(port, now_s)

    def hear(self, now_s: float) -> None:
        """Handle the arrival of bytes."""
        if self._heard_s is not None:
            self._heard_s = now_s

    def end(self) -> None:
        """Stop sending: samples have arrived."""
        self._heard_s, self._unsent = None, b""

    def wait(self, port: SourcePort, now_s: float) -> None:
        """Handle a read without bytes: send the rest, or everything again after a silence."""
        if self._unsent:
            self._unsent = self._unsent[port.write(self._unsent) :]
        elif self._heard_s is not None and now_s - self._heard_s >= self._silence_s:
            self._silence_s = min(2.0 * self._silence_s, SILENCE_LONGEST_S)
            self._send(port, now_s)

    def _send(self, port: SourcePort, now_s: float) -> None:
        if not self.content:
            return
        self._heard_s = now_s
        self._unsent = self.content[port.write(self.content) :]
        shown = self.content[:QUOTED_BYTES].decode("latin-1").encode("unicode_escape").decode("ascii")
        self._on_event("sent", bytes=len(self.content), content=shown)
