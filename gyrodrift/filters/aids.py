"""Measurements of second sources on their way into a filter."""

from math import isnan, nan

from gyrodrift.values.aid import Aid, AidStatus


class Aids:
    """Second sources of one filter.

    status
        How each source agrees, by its name.
    """

    def __init__(self) -> None:
        self.status: dict[str, AidStatus] = {}

    def take(self, aid: Aid, now_s: float) -> None:
        """Add a measurement; `now_s` is the time of the last sample."""
        age_s = 0.0 if isnan(aid.t_s) else now_s - aid.t_s
        self.status[aid.name] = AidStatus(age_s, nan)
