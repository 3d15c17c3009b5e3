"""Queue of a link: pieces to decode, readings with their arrival times, and samples beyond the budget of a turn.

A turn of a link has a budget of time and samples, so that no source delays another. The rest keeps its arrival time
and is worked off in the next turns; until then the source is not read, and its own buffer fills. Readings that waited
in a decoder for their scale keep their arrival time too.
"""

from collections import deque
from dataclasses import dataclass, field
from itertools import islice

from gyrodrift.link.protocols.batch import ReadingBatch
from gyrodrift.link.protocols.decoder import WAITING_MAX, DecoderCounters
from gyrodrift.values.sample import Reading, Sample

PIECE_BYTES = 1024
"""Bytes that are decoded between two looks at the clock: about 2 ms of the slowest text on a small board."""

TURN_S = 0.02
"""Time to decode in a turn, shared by all sources of a loop, s: a tenth of the 0.2 s in which a gyro of 1 kHz fills the
4 KiB buffer of a serial port."""

TURN_SAMPLES = 1024
"""Samples of a turn, shared in the same way: a filter and a JSON line take about 20 µs a sample, which is TURN_S."""

Arrived = tuple[float, list[Reading]]
"""Arrival time, s on the monotonic host clock, and its readings."""


@dataclass(slots=True)
class TurnQueue:
    """Queue of one link.

    turn_s, turn_samples
        Budget of a turn.
    arrival_s
        Time of the read that is being decoded, s on the monotonic clock.
    readings
        Its readings so far.
    """

    turn_s: float = TURN_S
    turn_samples: int = TURN_SAMPLES
    arrival_s: float = 0.0
    readings: list[Reading] = field(default_factory=list)
    _pieces: deque[bytes | ReadingBatch] = field(default_factory=deque)
    _samples: deque[Sample] = field(default_factory=deque)

    @property
    def is_empty(self) -> bool:
        """Whether everything that was read has been handed over."""
        return not self._pieces and not self._samples

    @property
    def has_pieces(self) -> bool:
        """Whether a piece waits to be decoded."""
        return bool(self._pieces)

    @property
    def has_samples(self) -> bool:
        """Whether samples wait for a turn."""
        return bool(self._samples)

    def share(self, sources: int) -> None:
        """Take one part of the budget of a loop with so many sources."""
        self.turn_s, self.turn_samples = TURN_S / sources, max(1, TURN_SAMPLES // sources)

    def add(self, received: bytes | ReadingBatch, arrival_s: float) -> None:
        """Add the content of a read."""
        self.arrival_s = arrival_s
        if isinstance(received, ReadingBatch) or len(received) <= PIECE_BYTES:
            self._pieces.append(received)
        else:
            self._pieces += (received[start : start + PIECE_BYTES] for start in range(0, len(received), PIECE_BYTES))

    def next_piece(self) -> bytes | ReadingBatch:
        """The next piece to decode; no bytes if the decoder itself has more."""
        return self._pieces.popleft() if self._pieces else b""

    def take_readings(self) -> list[Reading]:
        """Readings of the read, which are now decoded."""
        readings, self.readings = self.readings, []
        return readings

    def within_budget(self, samples: list[Sample]) -> list[Sample]:
        """Samples of this turn, the oldest first; the rest waits."""
        if not self._samples and len(samples) <= self.turn_samples:
            return samples
        self._samples += samples
        turn = list(islice(self._samples, self.turn_samples))
        for _ in turn:
            self._samples.popleft()
        return turn


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
