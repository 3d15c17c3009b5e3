"""Binary frames with a head, a length and a checksum: what holds for every protocol of them.

Frames stand right behind each other, so bytes that are none of a frame are damage. The search goes on behind the first
byte of a head that led nowhere, not behind the frame that it promised: a damaged length costs no frame but its own.
"""

import re
from abc import ABC, abstractmethod
from typing import ClassVar

from gyrodrift.link.protocols.decoder import DecoderCounters, DeviceDescription
from gyrodrift.sample import Reading


class FrameDecoder(ABC):
    """Walks from head to head.

    head
        The bytes that each frame begins with.
    header, header_bytes
        What a frame begins with, as a pattern, and the most bytes that this takes: in noise heads are many.
    beside
        A first byte of what a device may say between frames; that is passed over and not counted as damage.
    needs_two
        Whether out of step a frame is only believed when the next one stands right behind it.
    """

    name: str
    head: ClassVar[bytes]
    header: ClassVar[re.Pattern[bytes]]
    header_bytes: ClassVar[int]
    beside: ClassVar[bytes] = b""
    needs_two: ClassVar[bool] = False

    def __init__(self) -> None:
        self.counters = DecoderCounters()
        self.device = DeviceDescription()
        self._pending = b""
        self._in_step = False

    @abstractmethod
    def length(self, buffer: bytes, at: int) -> int | None:
        """Bytes of the frame whose head is at that place; 0 where it can be none, None before enough of it came."""

    @abstractmethod
    def is_whole(self, frame: bytes) -> bool:
        """Whether its checksum is right."""

    @abstractmethod
    def read(self, frame: bytes) -> Reading | None:
        """What a frame holds; None where that is no rate."""

    def push(self, chunk: bytes) -> list[Reading]:
        """Take what is whole and keep the rest."""
        readings: list[Reading] = []
        buffer, at = self._pending + chunk, 0
        while (at := self._find(buffer, at)) < len(buffer):
            end = self._believed_end(buffer, at)
            if end is None:
                break
            if end:
                self._in_step = True
                self._take(buffer[at:end], readings)
            else:
                self._lose_step()
            at = end or at + 1
        self._pending = buffer[at:]
        return readings

    def _find(self, buffer: bytes, at: int) -> int:
        """The next place of a head, or of what may become one with the bytes to come."""
        left = buffer[at : at + len(self.head)]
        if self.head.startswith(left):
            return at
        self._lose_step(left[:1])
        found = self.header.search(buffer, at + 1)
        cut = buffer.find(self.head[:1], max(at + 1, len(buffer) - self.header_bytes + 1))
        place = len(buffer) if cut < 0 else cut
        return place if found is None else min(place, found.start())

    def _end(self, buffer: bytes, at: int) -> int | None:
        """Where the frame at that place ends; 0 where it is none, None where more bytes have to tell."""
        left = buffer[at : at + len(self.head)]
        if not self.head.startswith(left):
            return 0
        length = self.length(buffer, at) if len(left) == len(self.head) else None
        if length is None or len(buffer) - at < length:
            return None
        return at + length if length and self.is_whole(buffer[at : at + length]) else 0

    def _believed_end(self, buffer: bytes, at: int) -> int | None:
        """As `_end`, but 0 too where a frame out of step has none behind it."""
        end = self._end(buffer, at)
        if not end or self._in_step or not self.needs_two:
            return end
        next_end = self._end(buffer, end)
        return next_end and end

    def _lose_step(self, first: bytes = b"") -> None:
        if self._in_step and not (first and first == self.beside):
            self.counters.damaged += 1
        self._in_step = False

    def _take(self, frame: bytes, readings: list[Reading]) -> None:
        self.counters.frames += 1
        reading = self.read(frame)
        if reading is None:
            self.counters.other += 1
        else:
            readings.append(reading)
