"""Bounded queue for one client; the oldest messages are dropped first."""

from collections import deque
from dataclasses import dataclass, field
from typing import Generic, TypeVar

Message = TypeVar("Message", str, bytes)


@dataclass(slots=True)
class Backlog(Generic[Message]):
    """Messages that a client has not taken yet.

    dropped
        Messages dropped so far; `untold` of them were not reported to the client.
    """

    longest_bytes: int
    dropped: int = 0
    untold: int = 0
    _waiting: deque[tuple[Message, int]] = field(default_factory=deque)
    _bytes: int = 0

    def __len__(self) -> int:
        """Number of pieces, not of messages."""
        return len(self._waiting)

    def append(self, piece: Message, messages: int = 1) -> None:
        """Queue a piece of some messages; the newest piece is kept whatever its length."""
        self._waiting.append((piece, messages))
        self._bytes += len(piece)
        while self._bytes > self.longest_bytes and len(self._waiting) > 1:
            oldest, count = self._waiting.popleft()
            self._bytes -= len(oldest)
            self.dropped += count
            self.untold += count

    def pop(self) -> tuple[Message, int]:
        """Remove the oldest piece; returns it with its number of messages."""
        piece, messages = self._waiting.popleft()
        self._bytes -= len(piece)
        return piece, messages

    def tell(self) -> int:
        """Number of messages dropped since the last call."""
        untold, self.untold = self.untold, 0
        return untold
