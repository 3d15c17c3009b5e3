"""Unix time of arrivals from the monotonic clock of the host.

A user or NTP may set the system clock while samples arrive. The time of a recording does not follow at once; the caller
of `follow` decides when the new time begins.
"""

import time
from collections.abc import Callable

CLOCK_SET = "host_clock_set"
"""Event that reports a step of the system clock."""

STEP_MIN_S = 0.5
"""Smallest step that starts another file; slewing changes both clocks, and is not a step."""


class Calendar:
    """Unix time without steps; `epoch_s` is the Unix time at zero of the monotonic clock."""

    def __init__(self, monotonic: Callable[[], float]) -> None:
        self._monotonic = monotonic
        self.epoch_s = self._epoch_now_s()

    def unix_s(self) -> float:
        """Present Unix time, s."""
        return self.epoch_s + self._monotonic()

    def step_s(self) -> float:
        """Step of the system clock since, s; 0 without one."""
        step_s = self._epoch_now_s() - self.epoch_s
        return step_s if abs(step_s) >= STEP_MIN_S else 0.0

    def follow(self) -> None:
        """Use the present system clock from now on."""
        self.epoch_s = self._epoch_now_s()

    def _epoch_now_s(self) -> float:
        return time.time() - self._monotonic()
