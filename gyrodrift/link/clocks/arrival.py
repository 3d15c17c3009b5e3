"""Time for devices that have no clock: sample numbers, regressed against arrival.

A link delivers late and in bunches, so the arrival of one sample says little and the line through many says a
lot. The first samples are held until there is a line; after that time runs along it, one period a sample, and
leans towards it gently, so that it never goes back.
"""

from gyrodrift.link.clocks.clock import ArrivalFit, ClockEvent, SampleGap
from gyrodrift.link.clocks.turning import TurningRate
from gyrodrift.sample import Reading, Sample

HOLD_S = 0.3
HOLD_SAMPLES = 8
HOLD_LONGEST_S = 3.0
HOLD_MOST_SAMPLES = 2000
"""Samples are held until they span HOLD_S and number HOLD_SAMPLES, or span HOLD_LONGEST_S, or are very many."""

LEAN = 0.02
"""Share of the distance to the line that time moves towards it with each sample."""

SILENCE_S = 0.25
SILENCE_PERIODS = 8.0
BURST_SHARE = 0.5
"""After a silence longer than both, a read that brings at least BURST_SHARE of the samples that were due is a
stall that is being made up for; less than that, and samples were lost."""


class ArrivalClock:
    """Times readings without a clock of their own; 0 s is the first of them."""

    def __init__(self, epoch_s: float) -> None:
        self.events: list[ClockEvent] = []
        self.period_s = 0.0
        self.epoch_s = epoch_s
        self._fit = ArrivalFit()
        self._held: list[tuple[Reading, float]] = []
        self._number = 0
        self._time_s = 0.0
        self._origin_s = 0.0
        self._has_reconnected = False
        self._turning = TurningRate()

    @property
    def drift_ppm(self) -> float | None:
        """None: there is no device clock that could drift."""
        return None

    @property
    def pace(self) -> float:
        """1: time is that of the host."""
        return 1.0

    def reconnected(self) -> None:
        """After an outage whatever is late was lost, not delayed."""
        self._has_reconnected = True
        self._turning.forget()

    def stamp(self, readings: list[Reading], arrival_s: float) -> list[Sample]:
        """Samples along the line through arrivals."""
        if not readings:
            return []
        if not self.period_s:
            return self._hold(readings, arrival_s)
        self._look_for_gap(len(readings), arrival_s)
        self._number += len(readings)
        self._fit.add(self._number - 1, arrival_s)
        self.period_s = self._fit.slope if self._fit.is_warm else self.period_s
        first = self._number - len(readings)
        return [self._sample(first + i, reading, arrival_s) for i, reading in enumerate(readings)]

    def _hold(self, readings: list[Reading], arrival_s: float) -> list[Sample]:
        self._held += [(reading, arrival_s) for reading in readings]
        self._fit.add(len(self._held) - 1, arrival_s)
        span_s = arrival_s - self._held[0][1]
        is_brief = span_s < HOLD_S or (len(self._held) < HOLD_SAMPLES and span_s < HOLD_LONGEST_S)
        if is_brief and len(self._held) < HOLD_MOST_SAMPLES:
            return []
        self.period_s = self._fit.slope
        if self.period_s <= 0.0:
            return []
        held, self._held = self._held, []
        self._number = len(held)
        self._origin_s = self._fit.arrival_s(0)
        self._time_s = -self.period_s
        return [self._sample(i, reading, arrived_s) for i, (reading, arrived_s) in enumerate(held)]

    def _look_for_gap(self, arrived: int, arrival_s: float) -> None:
        late_s = arrival_s - self._fit.arrival_s(self._number + arrived - 1)
        silence_s = max(SILENCE_S, SILENCE_PERIODS * self.period_s)
        if late_s <= silence_s:
            self._has_reconnected = False
            return
        due = round(late_s / self.period_s)
        if arrived < BURST_SHARE * due or self._has_reconnected:
            self.events.append(SampleGap(due, late_s + self.period_s))
            self._number += due
            self._time_s += due * self.period_s
        self._has_reconnected = False

    def _sample(self, number: int, reading: Reading, arrival_s: float) -> Sample:
        expected_s = self._time_s + self.period_s
        on_line_s = self._fit.arrival_s(number) - self._origin_s
        lean_s = min(max(LEAN * (on_line_s - expected_s), -0.5 * self.period_s), 0.5 * self.period_s)
        self._time_s = expected_s + lean_s
        _, _, rate_dps, encoder_deg, temp_c, still, yaw_deg = reading
        if yaw_deg == yaw_deg:  # noqa: PLR0124 - NaN alone differs from itself
            rate_dps = self._turning.rate_dps(self._time_s, yaw_deg)
        return Sample(number, self._time_s, self.epoch_s + arrival_s, rate_dps, encoder_deg, temp_c, still)
