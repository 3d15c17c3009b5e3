"""When readings came that waited in a decoder for their scale: they are stamped as if they had been read at once."""

from collections import deque

from gyrodrift.link.protocols.decoder import MOST_HELD, DecoderCounters
from gyrodrift.sample import Reading

Arrived = tuple[float, list[Reading]]
"""Arrival (monotonic host clock, s) and the readings of that moment."""


class LateArrivals:
    """Follows the counters of a decoder from push to push."""

    def __init__(self) -> None:
        self._waiting: deque[tuple[float, int]] = deque(maxlen=MOST_HELD)
        self._came = 0
        self._late = 0

    def by_arrival(self, counters: DecoderCounters, readings: list[Reading], arrival_s: float) -> list[Arrived]:
        """The readings that a push at `arrival_s` gave, with their own arrivals; those that waited are the first."""
        came, late = counters.before_hello + counters.late, counters.late - self._late
        if came > self._came:
            self._waiting.append((arrival_s, came - self._came))
        self._came, self._late = came, counters.late
        if not late:
            return [(arrival_s, readings)] if readings else []
        return [*self._released(readings[:late], arrival_s), (arrival_s, readings[late:])]

    def _released(self, readings: list[Reading], arrival_s: float) -> list[Arrived]:
        """The newest of those that waited, whatever of the oldest was dropped."""
        groups: list[Arrived] = []
        end = len(readings)
        while end and self._waiting:
            came_s, count = self._waiting.pop()
            begin = max(0, end - count)
            groups.append((came_s, readings[begin:end]))
            end = begin
        self._waiting.clear()
        if end:
            groups.append((arrival_s, readings[:end]))
        return groups[::-1]
