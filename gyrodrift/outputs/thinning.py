"""Thinning of samples to a maximum rate in device time."""

from collections.abc import Sequence

from gyrodrift.values.sample import Corrected

SAME_TIME_S = 1e-6
"""Times closer than this are equal, s; device clocks count microseconds."""


class Thinning:
    """Keeps the samples that are due; gaps are not made up for, and a clock may restart.

    Parameters
    ----------
    rate_hz
        None for every sample.
    """

    def __init__(self, rate_hz: float | None = None) -> None:
        self._every_s = 1.0 / rate_hz if rate_hz else 0.0
        self._due_s = float("-inf")

    def due(self, samples: Sequence[Corrected]) -> Sequence[Corrected]:
        """Samples that are due."""
        return [corrected for corrected in samples if self._take(corrected[0][1])] if self._every_s else samples

    def _take(self, t_s: float) -> bool:
        """Take a sample if it is due, and note when the next one is."""
        since_s = t_s - self._due_s
        if -self._every_s <= since_s < -SAME_TIME_S:
            return False
        is_in_step = abs(since_s) < self._every_s
        self._due_s = (self._due_s if is_in_step else t_s) + self._every_s
        return True
