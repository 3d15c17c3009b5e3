"""The last seconds of a filter's motion, for measurements that come late."""

from bisect import bisect_left
from math import inf

HISTORY_S = 10.0
"""Age of the oldest measurement that is used, s. Chosen: positioning receivers answer within seconds."""


class RecentMotion:
    """Turn by the filter without its corrections, and integral of the measured rate, deg, at the times of samples.

    rate_dps
        Last measured rate, deg/s.
    broken_s
        Time of the last gap in the samples: no integral goes over it.
    """

    def __init__(self) -> None:
        self.rate_dps = 0.0
        self.broken_s = -inf
        self._times: list[float] = []
        self._turns: list[tuple[float, float]] = []

    @property
    def from_s(self) -> float:
        """Earliest time that is known."""
        return self._times[0] if self._times else -inf

    @property
    def turn_deg(self) -> float:
        """Turn by the filter so far."""
        return self._turns[-1][0]

    def add(self, t_s: float, rate_dps: float, turn_deg: float, *, is_gap: bool) -> None:
        """Add a sample: its time, the measured rate, and the turn since the sample before."""
        motion_deg, angle_deg = self._turns[-1] if self._turns else (0.0, 0.0)
        if self._times and t_s > self._times[-1]:
            motion_deg += turn_deg
            angle_deg += 0.5 * (rate_dps + self.rate_dps) * (t_s - self._times[-1])
        elif self._times:  # the clock has restarted
            self._times, self._turns, is_gap = [], [], True
        self.broken_s = t_s if is_gap else self.broken_s
        self.rate_dps = rate_dps
        self._times.append(t_s)
        self._turns.append((motion_deg, angle_deg))
        if t_s - self._times[0] > 2.0 * HISTORY_S:
            first = bisect_left(self._times, t_s - HISTORY_S)
            del self._times[:first], self._turns[:first]

    def since(self, t_s: float) -> float:
        """Turn by the filter since a time, deg."""
        return self.turn_deg - self._turns_at(t_s)[0]

    def angle_deg(self, from_s: float, to_s: float) -> float:
        """Integral of the measured rate between two times, deg."""
        return self._turns_at(to_s)[1] - self._turns_at(from_s)[1]

    def _turns_at(self, t_s: float) -> tuple[float, float]:
        i = bisect_left(self._times, t_s)
        if i == 0 or i == len(self._times):
            return self._turns[min(i, len(self._times) - 1)]
        begin_s, end_s = self._times[i - 1], self._times[i]
        share = (t_s - begin_s) / (end_s - begin_s)
        (turn, angle), (next_turn, next_angle) = self._turns[i - 1], self._turns[i]
        return turn + share * (next_turn - turn), angle + share * (next_angle - angle)
