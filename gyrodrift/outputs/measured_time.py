"""Time of measurement of a sample on a clock other than that of the device."""


class MeasuredTime:
    """Converts device time to another clock, s, without the variable part of the delay.

    The smallest difference between arrival and device time is the one without waiting. It may grow as fast as clocks
    drift apart. The delay of the fastest sample remains.
    """

    DRIFT = 5e-4
    """Largest drift of two clocks, s/s: ten times that of quartz."""

    def __init__(self) -> None:
        self._difference_s = float("inf")
        self._at_s = 0.0

    def note(self, t_device_s: float, arrived_s: float) -> None:
        """Note the arrival of a sample."""
        grown_s = self._difference_s + self.DRIFT * abs(t_device_s - self._at_s)
        self._difference_s, self._at_s = min(grown_s, arrived_s - t_device_s), t_device_s

    def of(self, t_device_s: float) -> float:
        """Time of measurement, s."""
        return t_device_s + self._difference_s
