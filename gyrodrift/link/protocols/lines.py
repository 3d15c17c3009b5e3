"""Base of all protocols of text lines.

Lines without a checksum may be damaged and still parse. Two properties of real sketches detect most damage: the number
of columns is constant, and a reader that starts inside a line gets a shortened first line. So the first line waits for
two more, and a line with another number of columns counts as damaged until three in a row have it.
"""

from abc import abstractmethod

from gyrodrift.link.protocols.frames import PieceDecoder
from gyrodrift.values.constants import CLOCK_MASK
from gyrodrift.values.sample import Reading

COLUMN_CHANGE_LINES = 3
JOIN_GAP_US = 1_000_000
"""A first time step above this, and above four times the second one, means a shortened first line."""

WITHOUT_RATE = (0, Reading(None, None, 0.0))
"""Result for a good line without a rate."""


class LineDecoder(PieceDecoder):
    """Decoder of lines that end with LF, CRLF or CR; comments start with `#`."""

    def __init__(self) -> None:
        super().__init__()
        self._columns = 0
        self._column_change: list[tuple[int, Reading]] = []
        self._first: list[tuple[int, Reading]] | None = []

    @abstractmethod
    def parse(self, text: bytes) -> tuple[int, Reading] | None:
        """Number of columns and reading of a line; WITHOUT_RATE without a rate, None if it is damaged."""

    def is_comment(self, text: bytes) -> bool:
        """Whether a line is ignored and not counted."""
        return text.startswith(b"#")

    def push(self, chunk: bytes) -> list[Reading]:
        """Split at line ends, and parse complete lines."""
        return super().push(chunk.replace(b"\r", b"\n"))

    def take(self, piece: bytes, readings: list[Reading]) -> None:
        """Parse a line."""
        text = piece.strip()
        if not text or self.is_comment(text):
            return
        parsed = self.parse(text)
        if parsed is None:
            self.counters.damaged += 1
            return
        self.counters.frames += 1
        if parsed is WITHOUT_RATE:
            self.counters.other_frames += 1
        elif self._first is None:
            self._accept(*parsed, readings)
        else:
            self._join(*parsed, readings)

    def _join(self, columns: int, reading: Reading, readings: list[Reading]) -> None:
        first_lines = self._first or []
        first_lines.append((columns, reading))
        if len(first_lines) < 3:
            self._first = first_lines
            return
        self._first = None
        if not _first_line_is_whole(first_lines):
            first_lines.pop(0)
            self.counters.frames -= 1
            self.counters.damaged += 1
        self._columns = first_lines[0][0]
        for entry in first_lines:
            self._accept(*entry, readings)

    def _accept(self, columns: int, reading: Reading, readings: list[Reading]) -> None:
        if columns == self._columns:
            self._reject_column_change()
            readings.append(reading)
            return
        self._column_change = [entry for entry in self._column_change if entry[0] == columns]
        self._column_change.append((columns, reading))
        if len(self._column_change) == COLUMN_CHANGE_LINES:
            self._columns = columns
            readings.extend(changed for _, changed in self._column_change)
            self._column_change = []

    def _reject_column_change(self) -> None:
        self.counters.frames -= len(self._column_change)
        self.counters.damaged += len(self._column_change)
        self._column_change.clear()


def _first_line_is_whole(first_lines: list[tuple[int, Reading]]) -> bool:
    (columns, first), (columns_next, second), (_, third) = first_lines
    step_us = ((second.t_us or 0) - (first.t_us or 0)) & CLOCK_MASK
    step_next_us = ((third.t_us or 0) - (second.t_us or 0)) & CLOCK_MASK
    return columns == columns_next and (step_us <= JOIN_GAP_US or step_us <= 4 * step_next_us)
