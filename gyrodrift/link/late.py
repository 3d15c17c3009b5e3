"""Arrival times of readings that waited in a decoder for their scale."""

from collections import deque

from gyrodrift.link.protocols.decoder import WAITING_MAX, DecoderCounters
from gyrodrift.values.sample import Reading

Arrived = tuple[float, list[Reading]]
"""Arrival time, s on the monotonic host clock, and its readings."""


class LateArrivals:
    """Arrival times from the counters of a decoder."""

    def __init__(self) -> None:
        self._waiting: deque[tuple[float, int]] = deque(maxlen=WAITING_MAX)
        self._came = 0
        self._late = 0

    def by_arrival(self, counters: DecoderCounters, readings: list[Reading], arrival_s: float) -> list[Arrived]:
        """Readings of a push at `arrival_s` with their own arrival times; readings that waited come first."""
        came, late = counters.before_hello + counters.late, counters.late - self._late
        if came > self._came:
            self._waiting.append((arrival_s, came - self._came))
        self._came, self._late = came, counters.late
        if not late:
            return [(arrival_s, readings)] if readings else []
        return [*self._released(readings[:late], arrival_s), (arrival_s, readings[late:])]

    def _released(self, readings: list[Reading], arrival_s: float) -> list[Arrived]:
        """Readings that waited, grouped by arrival; the oldest may have been dropped."""
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
