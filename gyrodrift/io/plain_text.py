"""Bytes of a device as text: without terminal control sequences, in the encoding of its editor."""

import re

CONTROL = re.compile(rb"\x1b\[[0-9;?]*+[A-Za-z]|\x1b[@-Z\\-_]|\x00")
"""Terminal control sequences (ECMA-48), and the zero bytes that some programs send with text."""


SIGNS = str.maketrans("\u2212\ufe63\uff0d", "---")
"""Minus signs of typography, which spreadsheets of some languages and documents write."""


def plain_text(text: bytes) -> bytes:
    """Text without terminal control sequences."""
    return CONTROL.sub(b"", text) if b"\x1b" in text or b"\x00" in text else text


def decoded(text: bytes) -> str:
    """Decode as UTF-8, else as Latin-1, in which an editor may have written a degree sign.

    A character that is cut at either end is ignored.
    """
    for begin in range(4):
        for end in range(4):
            try:
                return text[begin : len(text) - end].decode().translate(SIGNS)
            except UnicodeDecodeError:
                continue
    return text.decode("latin-1")
