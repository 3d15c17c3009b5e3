"""What a client may take up before it is told to go."""

import time
from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Limits:
    """Of one server.

    clients
        That may be connected at a time; those in the middle of a handshake count.
    message_bytes
        Longest line or message that a client may send.
    messages_per_s
        That a client may send in the long run, with as many at once.
    handshake_s
        For what a protocol demands before anything is sent.
    queue_bytes
        That wait for a client who does not read; beyond it the oldest are dropped.
    """

    clients: int = 64
    message_bytes: int = 64 << 10
    messages_per_s: float = 200.0
    handshake_s: float = 10.0
    queue_bytes: int = 1 << 20


DEFAULT_LIMITS = Limits()


class Allowance:
    """Messages that a client may still send: a bucket that fills at a steady rate and holds a second of it."""

    def __init__(self, per_s: float, monotonic: Callable[[], float] = time.monotonic) -> None:
        self._per_s = self._left = per_s
        self._monotonic = monotonic
        self._seen_s = monotonic()

    def take(self) -> bool:
        """Use one up; False where none is left."""
        now_s = self._monotonic()
        self._left = min(self._per_s, self._left + (now_s - self._seen_s) * self._per_s)
        self._seen_s = now_s
        if self._left < 1.0:
            return False
        self._left -= 1.0
        return True
