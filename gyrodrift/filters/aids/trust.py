"""Whether a second source is believed: it is left out while it contradicts the filter too often."""

from dataclasses import dataclass, field
from math import inf, log
from statistics import median

from gyrodrift.filters.aids.reading import WRONG_SHARE, AidMoments, AidReading

MEMORY = 0.1
"""Weight of a measurement in the share of those that agree. Chosen: about ten count."""

BAD_SHARE = 0.5
"""Share of agreeing measurements of a wrong source. Chosen: one that sticks agrees with a device that pauses."""

SURE_WRONG, SURE_RIGHT = -5.0, 5.0
"""Logarithm of the odds of a right source against a wrong one, below which it is left out, and the largest that is
remembered. Chosen: 1 : 150 against it; a source that was right needs seven wrong values in a row."""

REMEMBERED = 5
"""Differences that are kept to tell how a source contradicts. Chosen: their median ignores two outliers."""

AGREEING_DEG = 30.0
"""Range of yaw over which a heading has to agree before it is proven, deg: one that is stuck agrees with a device that
does not turn. Chosen."""

TELLING_DEG = 10.0
"""Largest standard deviation of a difference of headings that tells whether the source is right. Chosen: a third of the
range."""


@dataclass(slots=True)
class Trust:
    """Trust in a source.

    weight, log_odds
        Share of the last measurements that agree, and logarithm of the odds that the source measures at all.
    differences
        Last differences to the filter.
    differs
        How it contradicts the filter, in words, while it is left out.
    least_deg, most_deg
        Range of yaw over which its headings have agreed.
    is_proven
        Whether it has been right for long: what it does later cannot mislead the filter for long.
    """

    weight: float = 1.0
    log_odds: float = 0.0
    differences: list[float] = field(default_factory=list)
    differs: str = ""
    least_deg: float = inf
    most_deg: float = -inf
    is_proven: bool = False

    @property
    def is_on_trial(self) -> bool:
        """Whether it is used, and may mislead the filter."""
        return not (self.is_proven or self.differs)

    def judge(self, reading: AidReading, m: AidMoments, *, counts: bool) -> bool:
        """Whether a measurement counts for the filter; `counts` if it can show that the source is wrong."""
        was_used, unit = self.differs == "", "deg" if reading.is_heading else "deg/s"
        difference, variance = reading.innovation(m)
        if counts and (not reading.is_heading or variance < TELLING_DEG * TELLING_DEG):
            right = 1.0 - WRONG_SHARE / reading.odds(m)
            self.weight += MEMORY * (right - self.weight)
            agreeing, wrong = log((1.0 - WRONG_SHARE) / BAD_SHARE), log(WRONG_SHARE / (1.0 - BAD_SHARE))
            self.log_odds = min(SURE_RIGHT, self.log_odds + right * agreeing + (1.0 - right) * wrong)
            self.differences = [*self.differences[1 - REMEMBERED :], difference]
            if right > BAD_SHARE:
                self.least_deg, self.most_deg = min(self.least_deg, m.yaw_deg), max(self.most_deg, m.yaw_deg)
        is_wide = not reading.is_heading or self.most_deg - self.least_deg > AGREEING_DEG
        is_right = self.log_odds >= SURE_RIGHT and is_wide
        if was_used:
            self.is_proven = self.is_proven or is_right
            if self.log_odds < SURE_WRONG:
                self.leave_out(f"it differs by {median(self.differences):.3g} {unit}")
        elif is_right or self.log_odds < 0.0:
            self.differs, self.is_proven = "" if is_right else self.differs, False
            self._begin_again()
        return was_used and self.differs == ""

    def leave_out(self, why: str) -> None:
        """Leave the source out, for a reason in words."""
        self.differs = why
        self._begin_again()

    def _begin_again(self) -> None:
        self.log_odds, self.least_deg, self.most_deg = 0.0, inf, -inf
