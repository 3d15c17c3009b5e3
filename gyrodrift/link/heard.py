"""Last bytes of a stream whose protocol is unknown, whether they are text, and line ends for messages of text.

Boards and phones often send one line of text per message, without its end.
"""

import re

from gyrodrift.io.plain_text import decoded, plain_text

BYTES_MAX = 32_768
"""Several of the longest lines, JSON of 4 KiB."""

BEGINNING_BYTES = 1024
"""Bytes of the beginning, which a board that prints its header once has there."""

LINE_END, CELL_END, CELL = re.compile(r"[\r\n]+"), re.compile(r"[,;\t|]"), re.compile(r"^[^,;\t|]*")
CELLS_MIN = 2
"""Least number of separators in a header."""

TEXT_BYTES_MIN = 16
"""At a wrong baud rate a third of the bytes are printable: 16 in a row happen by chance once in 10^7."""

TEXT_SHARE, ASCII_SHARE = 0.97, 0.8
"""Smallest shares of printable characters, and of ASCII characters, in a text."""

PRINTABLE = frozenset((*range(0x20, 0x7F), *b"\t\r\n"))

LONGEST_QUOTE = 80


class Heard:
    """Last kilobytes of a stream, and the rate of its lines."""

    def __init__(self) -> None:
        self.content = self._beginning = b""
        self._lines = self._bytes = 0
        self._first_s = self._last_s = 0.0

    def add(self, chunk: bytes, arrival_s: float) -> None:
        """Add bytes with their arrival time, s, monotonic."""
        if not self._bytes:
            self._first_s = arrival_s
        self._lines += max(chunk.count(b"\n"), chunk.count(b"\r"))
        self._last_s = arrival_s
        self._bytes += len(chunk)
        self._beginning = (self._beginning + chunk)[:BEGINNING_BYTES]
        self.content = (self.content + chunk)[-BYTES_MAX:]

    @property
    def lines_per_s(self) -> float | None:
        """Lines per second; None before half a second of lines."""
        return self._per_s(self._lines)

    @property
    def bytes_per_s(self) -> float | None:
        """Bytes per second; None before half a second."""
        return self._per_s(self._bytes)

    def _per_s(self, count: int) -> float | None:
        elapsed_s = self._last_s - self._first_s
        return count / elapsed_s if elapsed_s >= 0.5 else None

    @property
    def is_text(self) -> bool:
        """Whether the bytes are printable text, so that the baud rate is right."""
        text = plain_text(self.content)
        if len(text) < TEXT_BYTES_MIN:
            return False
        characters = decoded(text)
        printable = sum(character.isprintable() or character in "\t\r\n" for character in characters)
        ascii_characters = sum(character < "\x80" for character in characters)
        return printable >= TEXT_SHARE * len(characters) and ascii_characters >= ASCII_SHARE * len(characters)

    @property
    def may_be_text(self) -> bool:
        """Whether the bytes are printable so far, but too few: a board may print slowly."""
        text = plain_text(self.content)
        return 0 < len(text) < TEXT_BYTES_MIN and all(byte in PRINTABLE for byte in text)

    def lines(self) -> list[str]:
        """Complete lines that are not empty: the last ones, after the header from the beginning of the stream.

        The first line may be cut, so it is left out, and a header there has no first name.
        """
        *whole, _ = self._all_lines()
        lines = [line.strip() for line in (whole[1:] or whole) if line.strip()]
        *beginning, _ = LINE_END.split(decoded(plain_text(self._beginning)))
        header = next((line for line in beginning if line.strip()), "")
        is_header = len(CELL_END.findall(header)) >= CELLS_MIN and not any(map(str.isdigit, CELL_END.split(header)))
        return [CELL.sub("_", header.strip(), count=1), *lines] if is_header else lines

    def last_words(self) -> str:
        """Last text, also of an incomplete line."""
        return next((line.strip() for line in reversed(self._all_lines()) if line.strip()), "")

    def _all_lines(self) -> list[str]:
        return LINE_END.split(decoded(plain_text(self.content)))


def quoted(line: str) -> str:
    """Line for a message: printable, at most LONGEST_QUOTE characters."""
    shown = "".join(character if character.isprintable() else " " for character in line.replace('"', "'"))
    return f'"{shown}"' if len(shown) <= LONGEST_QUOTE else f'"{shown[: LONGEST_QUOTE - 1]}…"'


class LineEnds:
    """Adds a line end to each text without one, until a binary message comes."""

    def __init__(self, *, is_text: bool = True) -> None:
        self._is_binary = not is_text

    def add(self, content: bytes) -> bytes:
        """Message as a part of a stream; a frame may look like text by chance, so binary streams stay as they are."""
        if self._is_binary or content.endswith((b"\n", b"\r")):
            return content
        if all(byte in PRINTABLE or byte >= 0x80 for byte in content):
            return content + b"\n"
        self._is_binary = True
        return content
