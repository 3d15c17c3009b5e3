"""The last bytes that came while it is not clear yet what they are, and whether they are text."""

import re

MOST_BYTES = 8192
LEAST_LINES = 3
LEAST_TEXT_BYTES = 24
TEXT_SHARE = 0.97
"""Of printable characters; bytes at a wrong line rate have a third of them."""

COLOUR = re.compile(rb"\x1b\[[0-9;]*+m")
"""What tells a terminal in which colour to show a log."""

LONGEST_QUOTE = 80
PRINTABLE = frozenset((*range(0x20, 0x7F), *b"\t\r\n"))


class Heard:
    """Holds a few kilobytes; `lines_per_s` is the pace of all lines that came."""

    def __init__(self) -> None:
        self.content = b""
        self._lines = 0
        self._first_s = self._last_s = 0.0

    def add(self, chunk: bytes, arrival_s: float) -> None:
        """What has come, and when (s, monotonic)."""
        if not self._lines:
            self._first_s = arrival_s
        self._lines += chunk.count(b"\n")
        self._last_s = arrival_s
        self.content = (self.content + chunk)[-MOST_BYTES:]

    @property
    def lines_per_s(self) -> float | None:
        """None before lines have come for half a second."""
        elapsed_s = self._last_s - self._first_s
        return self._lines / elapsed_s if elapsed_s >= 0.5 else None

    @property
    def is_text(self) -> bool:
        """Whether it is lines of printable characters: then the line rate is right, whatever they say."""
        text = self._whole_lines()
        if len(text) < LEAST_TEXT_BYTES or text.count(b"\n") < LEAST_LINES:
            return False
        decoded = text.decode("utf-8", "replace")
        printable = sum(ord(character) in PRINTABLE or "\xa0" <= character < "\ufffd" for character in decoded)
        return printable >= TEXT_SHARE * len(decoded)

    def lines(self) -> list[str]:
        """Whole lines, the one at which listening began left out, without comments and empty ones."""
        whole = self._whole_lines().decode("utf-8", "replace").splitlines()
        return [line.strip() for line in whole[1:] if line.strip() and not line.startswith("#")]

    def _whole_lines(self) -> bytes:
        return COLOUR.sub(b"", self.content[: self.content.rfind(b"\n") + 1])


def quoted(line: str) -> str:
    """A line for a message: printable, and of no more than LONGEST_QUOTE characters."""
    shown = "".join(character if character.isprintable() else " " for character in line.replace('"', "'"))
    return f'"{shown}"' if len(shown) <= LONGEST_QUOTE else f'"{shown[: LONGEST_QUOTE - 1]}…"'
