"""Limits for the clients of a server."""

import time
from collections.abc import Callable
from dataclasses import dataclass


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
