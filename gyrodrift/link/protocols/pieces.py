"""Base of all protocols whose frames or lines end with a delimiter: damage costs one of them, up to the next one."""

from abc import ABC, abstractmethod
from typing import ClassVar

from gyrodrift.link.protocols.decoder import CountingDecoder
from gyrodrift.values.sample import Reading


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
