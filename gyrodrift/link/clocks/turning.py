"""Rate of a device that sends an angle, from differences."""

from math import nan

from gyrodrift.values.constants import FULL_TURN_DEG

FASTEST_DPS = 2000.0
"""Range of the gyros on these boards; an angle that moves faster was reset."""


class TurningRate:
    """Rate from differences of a wrapping angle."""

    def __init__(self) -> None:
        self._before: tuple[float, float] | None = None

    def forget(self) -> None:
        """Restart after a reset of the clock or the angle."""
        self._before = None

    def rate_dps(self, t_s: float, angle_deg: float) -> float:
        """Mean rate since the last time, deg/s; NaN for the first angle, for equal times, and after a reset."""
        before, self._before = self._before, (t_s, angle_deg)
        if before is None:
            return nan
        step_s = t_s - before[0]
        if step_s <= 0.0:
            self._before = before
            return nan
        step_deg = (angle_deg - before[1] + 0.5 * FULL_TURN_DEG) % FULL_TURN_DEG - 0.5 * FULL_TURN_DEG
        rate_dps = step_deg / step_s
        return rate_dps if abs(rate_dps) <= FASTEST_DPS else nan
