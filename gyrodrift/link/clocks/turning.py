"""The rate of a device that sends an angle: how far it turned since the sample before."""

from math import nan

TURN_DEG = 360.0
FASTEST_DPS = 2000.0
"""Range of the gyros on such boards; an angle that moves faster was set anew."""


class TurningRate:
    """Differences of an angle that wraps, each over the time since the one before."""

    def __init__(self) -> None:
        self._before: tuple[float, float] | None = None

    def forget(self) -> None:
        """The clock or the angle begins anew."""
        self._before = None

    def rate_dps(self, t_s: float, angle_deg: float) -> float:
        """Mean rate in deg/s since the last time; NaN for the first angle, one of the same time, and one set anew."""
        before, self._before = self._before, (t_s, angle_deg)
        if before is None:
            return nan
        step_s = t_s - before[0]
        if step_s <= 0.0:
            self._before = before
            return nan
        turned_deg = (angle_deg - before[1] + 0.5 * TURN_DEG) % TURN_DEG - 0.5 * TURN_DEG
        rate_dps = turned_deg / step_s
        return rate_dps if abs(rate_dps) <= FASTEST_DPS else nan
