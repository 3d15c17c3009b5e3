"""A line of a terminal that is rewritten in place, and a log above it."""

import io
import os
from bisect import bisect_right
from contextlib import suppress
from itertools import accumulate
from typing import TextIO

CLEAR = "\r\x1b[K"
"""Go to the begin of the line and clear it."""

FIRST_WIDE = "\u1100"
"""First character that takes two columns (Unicode Standard Annex 11)."""


def is_screen(stream: TextIO) -> bool:
    """Whether a stream is a terminal that can rewrite a line."""
    return stream.isatty() and os.environ.get("TERM") != "dumb"


def columns_of(fd: int) -> int | None:
    """Width of a terminal; None if it does not tell it."""
    try:
        return os.get_terminal_size(fd).columns or None
    except OSError:
        return None


def line_in_place(text: str, terminal: TextIO | int, otherwise: int | None = None) -> str:
    """Text that replaces the present line, cut to the width of the terminal: a line that wraps cannot be cleared.

    Parameters
    ----------
    terminal
        The terminal, or its descriptor.
    otherwise
        Columns of a terminal that does not tell its width; None to cut nothing.
    """
    try:
        columns = columns_of(terminal if isinstance(terminal, int) else terminal.fileno()) or otherwise
    except OSError:
        columns = otherwise
    return CLEAR + (text if columns is None else _cut(text, columns - 1))


def _cut(text: str, columns: int) -> str:
    """Cut a text to columns of a terminal; some characters, such as Chinese ones, take two."""
    if len(text) * 2 <= columns:
        return text
    if max(text) < FIRST_WIDE:
        return text[:columns]
    from unicodedata import east_asian_width  # noqa: PLC0415 - only for a line with such a character

    ends = list(accumulate(2 if east_asian_width(character) in "WF" else 1 for character in text))
    return text[: bisect_right(ends, columns)]


class AboveLine(io.TextIOBase):
    """A stream for the log that first clears the line."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def write(self, text: str) -> int:
        """Write in place of the line, which its next tick shows again."""
        with suppress(OSError):  # a closed terminal ends nothing
            self._stream.write(CLEAR + text)
        return len(text)

    def flush(self) -> None:
        """Flush the terminal."""
        with suppress(OSError):
            self._stream.flush()
