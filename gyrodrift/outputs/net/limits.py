"""Limits for the clients of a server, and the bounded queue of one client, which drops its oldest messages first."""

import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Generic, TypeVar

Message = TypeVar("Message", str, bytes)


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits of one server.

    clients
        Most connected clients; those in a handshake count.
    message_bytes
        Longest line or message of a client.
    messages_per_s
        Most messages of a client a second on average, and most at once.
    handshake_s
        Longest handshake, s.
    queue_bytes
        Longest queue for a slow client; then the oldest messages are dropped.
    """

    clients: int = 64
    message_bytes: int = 64 << 10
    messages_per_s: float = 200.0
    handshake_s: float = 10.0
    queue_bytes: int = 1 << 20


DEFAULT_LIMITS = Limits()


class Allowance:
    """Token bucket of the messages of a client: it holds the messages of one second."""

    def __init__(self, per_s: float, monotonic: Callable[[], float] = time.monotonic) -> None:
        self._per_s = self._tokens = per_s
        self._monotonic = monotonic
        self._filled_s = monotonic()

    def take(self) -> bool:
        """Take a token; False without one."""
        now_s = self._monotonic()
        self._tokens = min(self._per_s, self._tokens + (now_s - self._filled_s) * self._per_s)
        self._filled_s = now_s
        if self._tokens < 1.0:
            return False
        self._tokens -= 1.0
        return True


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
