"""Reports of rest by a second source: standing, or a speed of 0."""

from dataclasses import dataclass
from math import inf, isfinite, nan

from gyrodrift.values.aid import Aid

SLOW_MPS = 0.3
"""Speed that is motion, and least speed beside 0 of a source whose 0 may hide motion, m/s. Chosen: a car that rolls at
0.3 m/s around a bend of 6 m turns at 3 deg/s."""

SLOW_SHARE = 0.2
"""Share of the largest speed so far that is motion for wheels in any unit. Chosen."""

RESTED_S = 5.0
"""Time of told rests after which a speed also tells motion, s: before, a straight drive is all that shows the bias.
Chosen."""

HELD_PERIODS = 3.0
"""Time for which a report holds, in the longest periods of its source so far. Chosen: two may be lost."""

LONGEST_PERIOD_S = 10.0
"""Longest pause between two reports that is a period, s. Chosen."""


@dataclass(slots=True)
class RestReports:
    """A source that knows of rest.

    report
        Last report: 1 at rest, 0 in motion, NaN if unknown.
    t_s, period_s
        Time of the report, and longest time between two, s; 0 before the second.
    least, most
        Least speed beside 0, and largest, so far, in the unit of the source.
    rested_s
        Time of its reports of rest, s.
    """

    report: float = nan
    t_s: float = -inf
    period_s: float = 0.0
    least: float = inf
    most: float = 0.0
    rested_s: float = 0.0

    def hear(self, aid: Aid) -> None:
        """Take a report of rest, a speed, or the difference of two wheels beside their mean."""
        seconds = aid.t_s - self.t_s
        if isfinite(seconds):
            self.period_s = max(self.period_s, min(seconds, LONGEST_PERIOD_S))
            self.rested_s += seconds if self.report == 1.0 else 0.0
        self.t_s = aid.t_s
        self.report = aid.value if aid.kind == "standing" else self._by_speed(aid)

    def report_at(self, t_s: float) -> float:
        """Report that holds at a time; a single one holds until the next."""
        has_ended = self.period_s > 0.0 and t_s - self.t_s > HELD_PERIODS * self.period_s
        return nan if has_ended else self.report

    def _by_speed(self, aid: Aid) -> float:
        """Report by a speed: 0 is rest unless the source shows no slow motion; motion is told by one that rested."""
        speed, is_wheels = abs(aid.value), aid.kind == "wheels"
        if is_wheels and isfinite(aid.speed):
            speed = max(speed, abs(aid.speed))
        self.most = max(self.most, speed)
        slow = SLOW_SHARE * self.most if is_wheels else SLOW_MPS
        is_zero = speed <= 2.0 * aid.sigma if aid.sigma > 0.0 and not is_wheels else speed == 0.0
        if is_zero:
            return 1.0 if self.least < slow or self.least == inf else nan
        self.least = min(self.least, speed)
        return 0.0 if speed > slow and self.rested_s > RESTED_S else nan
