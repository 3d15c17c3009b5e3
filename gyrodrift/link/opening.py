r"""What a device is sent after its port was opened, where it waits for a key or a command (`--send '\r\n'`).

Opening the port resets many a board, and what is sent while it boots is lost. So the bytes are sent once more after
each silence until samples come; the silences double, since a board may be busy with what it was told.
"""

import re
from collections.abc import Callable
from typing import Any

from gyrodrift.link.port import Port

SEND_LONGEST_BYTES = 4096
"""What the input buffer of a Linux terminal takes at once (`N_TTY_BUF_SIZE`)."""

SILENCE_S = 2.0
"""Longer than a bootloader of Arduino waits for an upload, 1 s."""

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
"""Escapes of a bytes literal of Python; those by number are octal or `x` with two digits."""


def bytes_to_send(text: str) -> bytes:
    r"""The bytes that a text with escapes stands for, such as `r\n` or `\x1b[c`; other characters in UTF-8.

    Raises
    ------
    ValueError
        Where an escape is none of Python's, the bytes are too many, or there are none.
    """
    content, end = b"", 0
    for found in ESCAPE.finditer(text):
        content += _utf8(text[end : found.start()]) + _escaped(found)
        end = found.end()
    content += _utf8(text[end:])
    if not 0 < len(content) <= SEND_LONGEST_BYTES:
        raise ValueError(f"is {len(content)} bytes; expected 1 to {SEND_LONGEST_BYTES}")
    return content


def _utf8(text: str) -> bytes:
    """Bytes of a command line that are no UTF-8 stay what they were."""
    return text.encode("utf-8", "surrogateescape")


def _escaped(found: re.Match[str]) -> bytes:
    octal, hexadecimal, name = found.groups()
    value = int(octal, 8) if octal else int(hexadecimal, 16) if hexadecimal else None
    content = NAMED.get(name or "") if value is None else bytes((value,)) if value <= 0xFF else None
    if content is None:
        raise ValueError(rf"has the escape {found[0]}; expected one of \r, \n, \t, \\, \x1b (two digits) and the like")
    return content


class Opening:
    """Sends `content` after the port was opened, and again after silences, until the first samples."""

    def __init__(self, content: bytes, on_event: Callable[..., Any]) -> None:
        self.content = content
        self._on_event = on_event
        self._left = b""
        self._silence_s = SILENCE_S
        self._heard_s: float | None = None

    def begin(self, port: Port, now_s: float) -> None:
        """The port was opened, or listens at another rate."""
        self._silence_s = SILENCE_S
        self._send(port, now_s)

    def hear(self, now_s: float) -> None:
        """Something came."""
        if self._heard_s is not None:
            self._heard_s = now_s

    def end(self) -> None:
        """Samples came: the device waits for nothing."""
        self._heard_s, self._left = None, b""

    def wait(self, port: Port, now_s: float) -> None:
        """Nothing came now; send what the port did not take yet, or all of it once more."""
        if self._left:
            self._left = self._left[port.write(self._left) :]
        elif self._heard_s is not None and now_s - self._heard_s >= self._silence_s:
            self._silence_s = min(2.0 * self._silence_s, SILENCE_LONGEST_S)
            self._send(port, now_s)

    def _send(self, port: Port, now_s: float) -> None:
        if not self.content:
            return
        self._heard_s = now_s
        self._left = self.content[port.write(self.content) :]
        shown = self.content[:QUOTED_BYTES].decode("latin-1").encode("unicode_escape").decode("ascii")
        self._on_event("sent", bytes=len(self.content), content=shown)
