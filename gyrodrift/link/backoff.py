"""Times at which a lost port is opened again: soon at first, then less often."""

from dataclasses import dataclass

FIRST_S = 0.05
LONGEST_S = 2.0
"""First and longest wait between two attempts, s; the wait doubles after a failure."""


@dataclass(slots=True)
class Backoff:
    """Wait before the next attempt, on the monotonic clock, s."""

    _wait_s: float = FIRST_S
    _due_s: float = 0.0

    def begin(self, now_s: float) -> None:
        """Start with the shortest wait, after the port was lost."""
        self._wait_s = FIRST_S
        self._due_s = now_s + self._wait_s

    def fail(self, now_s: float) -> None:
        """Wait longer, after an attempt has failed."""
        self._wait_s = min(2.0 * self._wait_s, LONGEST_S)
        self._due_s = now_s + self._wait_s

    def remaining_s(self, now_s: float) -> float:
        """Time until the next attempt, s; 0 if it is due."""
        return max(0.0, self._due_s - now_s)
