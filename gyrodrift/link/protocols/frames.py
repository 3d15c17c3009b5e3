"""Bases of all protocols: binary frames with a head, a length and a checksum, and pieces between delimiters.

Frames follow each other directly, so bytes between them are damage. After a damaged frame the search goes on behind the
first byte of its head. So a damaged length costs one frame only. Damage of frames or lines that end with a delimiter
costs one of them, up to the next delimiter.
"""

import re
from abc import ABC, abstractmethod
from typing import ClassVar

from gyrodrift.link.protocols.decoder import CountingDecoder
from gyrodrift.values.sample import Reading


class FrameDecoder(CountingDecoder, ABC):
    """Decoder that searches for heads.

    head
        First bytes of every frame.
    header, header_bytes
        Pattern of the beginning of a frame, and its largest length; noise has many heads.
    filler
        First byte of other output between frames, which is not counted as damage.
    needs_two
        Whether a frame after damage counts only if the next frame follows directly.
    """

    head: ClassVar[bytes]
    header: ClassVar[re.Pattern[bytes]]
    header_bytes: ClassVar[int]
    filler: ClassVar[bytes] = b""
    needs_two: ClassVar[bool] = False

    def __init__(self) -> None:
        super().__init__()
        self._pending = b""
        self._in_step = False

    @abstractmethod
    def length(self, buffer: bytes, position: int) -> int | None:
        """Length of the frame at a position; 0 if it is not a frame, None if more bytes are needed."""

    @abstractmethod
    def is_whole(self, frame: bytes) -> bool:
        """Whether the checksum is right."""

    @abstractmethod
    def read(self, frame: bytes) -> Reading | None:
        """Reading of a frame; None without a rate."""

    def push(self, chunk: bytes) -> list[Reading]:
        """Decode complete frames, and keep the rest."""
        readings: list[Reading] = []
        buffer, position = self._pending + chunk, 0
        while (position := self._find(buffer, position)) < len(buffer):
            end = self._believed_end(buffer, position)
            if end is None:
                break
            if end:
                self._in_step = True
                self.count(self.read(buffer[position:end]), readings)
            else:
                self._lose_step()
            position = end or position + 1
        self._pending = buffer[position:]
        return readings

    def _find(self, buffer: bytes, position: int) -> int:
        """Position of the next head, or of its possible beginning at the end of the buffer."""
        remaining = buffer[position : position + len(self.head)]
        if self.head.startswith(remaining):
            return position
        self._lose_step(remaining[:1])
        match = self.header.search(buffer, position + 1)
        cut = buffer.find(self.head[:1], max(position + 1, len(buffer) - self.header_bytes + 1))
        candidate = len(buffer) if cut < 0 else cut
        return candidate if match is None else min(candidate, match.start())

    def _end(self, buffer: bytes, position: int) -> int | None:
        """End of the frame at a position; 0 if it is not a frame, None if more bytes are needed."""
        remaining = buffer[position : position + len(self.head)]
        if not self.head.startswith(remaining):
            return 0
        length = self.length(buffer, position) if len(remaining) == len(self.head) else None
        if length is None or len(buffer) - position < length:
            return None
        return position + length if length and self.is_whole(buffer[position : position + length]) else 0

    def _believed_end(self, buffer: bytes, position: int) -> int | None:
        """End of a frame as `_end`; 0 also if a frame after damage is not followed by another one."""
        end = self._end(buffer, position)
        if not end or self._in_step or not self.needs_two:
            return end
        next_end = self._end(buffer, end)
        return next_end and end

    def _lose_step(self, first: bytes = b"") -> None:
        if self._in_step and not (first and first == self.filler):
            self.counters.damaged += 1
        self._in_step = False


class PieceDecoder(CountingDecoder, ABC):
    """Decoder of the pieces between delimiters.

    delimiter
        End of a piece; an empty piece is ignored.
    longest_bytes
        Largest length of a piece; a longer one is damaged, and is not kept.
    """

    delimiter: ClassVar[bytes] = b"\n"
    longest_bytes: ClassVar[int] = 256

    def __init__(self) -> None:
        super().__init__()
        self._pending = b""
        self._is_overlong = False

    @abstractmethod
    def take(self, piece: bytes, readings: list[Reading]) -> None:
        """Decode a piece that is not too long."""

    def push(self, chunk: bytes) -> list[Reading]:
        """Split at the delimiters, and decode complete pieces."""
        readings: list[Reading] = []
        *pieces, pending = (self._pending + chunk).split(self.delimiter)
        for piece in pieces:
            if self._is_overlong or len(piece) > self.longest_bytes:
                self.counters.damaged += 1
            elif piece:
                self.take(piece, readings)
            self._is_overlong = False
        if len(pending) > self.longest_bytes:
            self._is_overlong = True
            pending = pending[:1]  # enough to remember that the piece is not empty
        self._pending = pending
        return readings
