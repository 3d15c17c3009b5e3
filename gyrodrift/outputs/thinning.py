"""At most so many samples a second, in device time."""

from collections.abc import Sequence

from gyrodrift.sample import Corrected

SAME_TIME_S = 1e-6
"""Device clocks count microseconds; closer than this is the same time."""


class Thinning:
    """Keeps samples that are due, and does not make up for those that were not there; a clock may begin again.

    Parameters
    ----------
    rate_hz
        None for every sample.
    """

    def __init__(self, rate_hz: float | None = None) -> None:
        self._every_s = 1.0 / rate_hz if rate_hz else 0.0
        self._due_s = float("-inf")

    def due(self, samples: Sequence[Corrected]) -> Sequence[Corrected]:
        """Those of the samples that are due."""
        return [each for each in samples if self._is_due(each[0][1])] if self._every_s else samples

    def _is_due(self, t_s: float) -> bool:
        since_s = t_s - self._due_s
        if -self._every_s <= since_s < -SAME_TIME_S:
            return False
        is_in_step = abs(since_s) < self._every_s
        self._due_s = (self._due_s if is_in_step else t_s) + self._every_s
        return True
