"""The last bytes that came while it is not clear yet what they are, and whether they are text."""

import re

MOST_BYTES = 32_768
"""Some lines of the longest kind, JSON of 4 KiB."""

LEAST_TEXT_BYTES = 16
"""At a wrong line rate a third of the bytes are printable: so many in a row are by chance in one of 10^7 tries."""

TEXT_SHARE, ASCII_SHARE = 0.97, 0.8
"""Of printable characters, and of those of ASCII: a degree sign is rare in a line."""

CONTROL = re.compile(rb"\x1b\[[0-9;?]*+[A-Za-z]|\x1b[@-Z\\-_]|\x00")
"""What tells a terminal a colour or a place (ECMA-48), and the zero that some programs send with their texts."""

PRINTABLE = frozenset((*range(0x20, 0x7F), *b"\t\r\n"))

LONGEST_QUOTE = 80


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
        self._lines += max(chunk.count(b"\n"), chunk.count(b"\r"))
        self._last_s = arrival_s
        self.content = (self.content + chunk)[-MOST_BYTES:]

    @property
    def lines_per_s(self) -> float | None:
        """None before lines have come for half a second."""
        elapsed_s = self._last_s - self._first_s
        return self._lines / elapsed_s if elapsed_s >= 0.5 else None

    @property
    def is_text(self) -> bool:
        """Whether it is printable characters: then the line rate is right, whatever they say."""
        text = plain_text(self.content)
        if len(text) < LEAST_TEXT_BYTES:
            return False
        characters = decoded(text)
        printable = sum(character.isprintable() or character in "\t\r\n" for character in characters)
        ascii_characters = sum(character < "\x80" for character in characters)
        return printable >= TEXT_SHARE * len(characters) and ascii_characters >= ASCII_SHARE * len(characters)

    @property
    def may_be_text(self) -> bool:
        """Whether it is too little to tell, and printable so far: a board that prints slowly needs a longer look."""
        text = plain_text(self.content)
        return 0 < len(text) < LEAST_TEXT_BYTES and all(byte in PRINTABLE for byte in text)

    def lines(self) -> list[str]:
        """Whole lines without empty ones; the one at which listening began is left out where others are left."""
        *whole, _ = re.split(r"[\r\n]+", decoded(plain_text(self.content)))
        return [line.strip() for line in (whole[1:] or whole) if line.strip()]

    def last_words(self) -> str:
        """The last text that came, whether its line has ended or not."""
        return next((line.strip() for line in reversed(self._all_lines()) if line.strip()), "")

    def _all_lines(self) -> list[str]:
        return re.split(r"[\r\n]+", decoded(plain_text(self.content)))


def plain_text(text: bytes) -> bytes:
    """The text without what steers a terminal."""
    return CONTROL.sub(b"", text) if b"\x1b" in text or b"\x00" in text else text


def decoded(text: bytes) -> str:
    """As UTF-8, else as Latin-1, in which a sketch or its editor may have written a degree sign.

    A character that is cut at either end, where listening began or ended, does not count.
    """
    for begin in range(4):
        for end in range(4):
            try:
                return text[begin : len(text) - end].decode()
            except UnicodeDecodeError:
                continue
    return text.decode("latin-1")


def quoted(line: str) -> str:
    """A line for a message: printable, and of no more than LONGEST_QUOTE characters."""
    shown = "".join(character if character.isprintable() else " " for character in line.replace('"', "'"))
    return f'"{shown}"' if len(shown) <= LONGEST_QUOTE else f'"{shown[: LONGEST_QUOTE - 1]}…"'
