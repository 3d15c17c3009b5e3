"""When a sample was measured, on a clock that is not the device's."""


class MeasuredTime:
    """Turns device time into the time of measurement on another clock, s, without the delays that vary.

    The smallest difference that was seen between arrival and device time is the one without waiting; it may grow as
    fast as clocks drift apart. What the fastest sample takes remains.
    """

    DRIFT = 5e-4
    """Of two clocks against each other, s/s: ten times what quartz does."""

    def __init__(self) -> None:
        self._difference_s = float("inf")
        self._at_s = 0.0

    def note(self, t_device_s: float, arrived_s: float) -> None:
        """A sample that arrived now."""
        grown_s = self._difference_s + self.DRIFT * abs(t_device_s - self._at_s)
        self._difference_s, self._at_s = min(grown_s, arrived_s - t_device_s), t_device_s

    def of(self, t_device_s: float) -> float:
        """When it was measured."""
        return t_device_s + self._difference_s
