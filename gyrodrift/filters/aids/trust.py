"""Whether a second source is believed: it is left out while it contradicts the filter too often."""

from dataclasses import dataclass, field
from math import log
from statistics import median

from gyrodrift.filters.aids.reading import WRONG_SHARE, AidMoments, AidReading

MEMORY = 0.1
"""Weight of a measurement in the share of those that agree: about ten count."""

SURE_WRONG, SURE_RIGHT = -5.0, 10.0
"""Logarithm of the odds that a source measures against chance values, below which it is left out, and the largest that
is remembered. Chosen: 1 : 150 against it; a source that was right needs seven wrong values in a row."""

REMEMBERED = 5
"""Differences that are kept to tell how a source contradicts."""

AGREEING_READINGS, AGREEING_DEG = 20, 30.0
"""Measurements in a row that bring a source back, and turn within them, deg: a source that is stuck agrees with a
device that does not turn. Chosen."""


@dataclass(slots=True)
class Trust:
    """Trust in a source.

    weight, log_odds
        Share of the last measurements that agree, and logarithm of the odds that the source measures at all.
    differences
        Last differences to the filter.
    differs
        How it contradicts the filter, in words, while it is left out.
    agreed, from_deg
        Measurements in a row that agree again, and yaw where they began.
    is_proven
        Whether it has been right for long: what it does later cannot mislead the filter for long.
    """

    weight: float = 1.0
    log_odds: float = 0.0
    differences: list[float] = field(default_factory=list)
    differs: str = ""
    agreed: int = 0
    from_deg: float = 0.0
    is_proven: bool = False

    def judge(self, reading: AidReading, m: AidMoments, *, counts: bool) -> bool:
        """Whether a measurement counts for the filter; `counts` if it can show that the source is wrong."""
        odds, unit = reading.odds(m), "deg" if reading.is_heading else "deg/s"
        if self.differs == "":
            if counts:
                self.weight += MEMORY * (1.0 - WRONG_SHARE / odds - self.weight)
                self.log_odds = min(SURE_RIGHT, self.log_odds + log(odds))
                self.is_proven = self.is_proven or self.log_odds >= SURE_RIGHT
                self.differences = [*self.differences[1 - REMEMBERED :], reading.innovation(m)[0]]
            if self.log_odds < SURE_WRONG:
                self.leave_out(f"it differs by {median(self.differences):.3g} {unit}")
            return self.differs == ""
        if odds < 1.0:
            self.agreed = 0
        elif counts:
            self.from_deg = m.yaw_deg if self.agreed == 0 else self.from_deg
            self.agreed += 1
        is_moving = not reading.is_heading or abs(m.yaw_deg - self.from_deg) > AGREEING_DEG
        if self.agreed >= AGREEING_READINGS and is_moving:
            self.differs, self.weight, self.log_odds, self.differences = "", 1.0, 0.0, []
        return self.differs == ""

    def leave_out(self, why: str) -> None:
        """Leave the source out, for a reason in words."""
        self.differs, self.agreed = why, 0
