"""Unix time of arrivals: the monotonic clock of the host, and where it stands on the calendar.

The system's clock may be set while samples come in, by a person or once the network is there. Within a recording time
goes on as it was; who calls `follow` decides when the new calendar begins.
"""

import time
from collections.abc import Callable

CLOCK_SET = "host_clock_set"
"""The event that tells of it."""

LEAST_STEP_S = 0.5
"""Less than that is not worth another file; slewing moves both clocks alike, and is no step."""


class Calendar:
    """Unix time that no setting of the system's clock bends; `epoch_s` is that of the monotonic clock's zero."""

    def __init__(self, monotonic: Callable[[], float]) -> None:
        self._monotonic = monotonic
        self.epoch_s = self._epoch_now_s()

    def unix_s(self) -> float:
        """Now."""
        return self.epoch_s + self._monotonic()

    def step_s(self) -> float:
        """How far the system's clock was set since, s; 0 where it was not."""
        step_s = self._epoch_now_s() - self.epoch_s
        return step_s if abs(step_s) >= LEAST_STEP_S else 0.0

    def follow(self) -> None:
        """Take over the calendar as it is now."""
        self.epoch_s = self._epoch_now_s()

    def _epoch_now_s(self) -> float:
        return time.time() - self._monotonic()
