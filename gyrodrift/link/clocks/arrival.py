"""Clock for devices without one: a regression of arrival times against sample numbers.

A link delivers late and in bursts, so a single arrival is inaccurate, and a line through many is accurate. The first
samples wait until there is a line. Then time advances by one period per sample, and approaches the line slowly, so that
it never goes back.
"""

from gyrodrift.link.clocks.clock import Clock, SampleGap, rate_of_delta, timed_aids
from gyrodrift.values.sample import Reading, Sample

HOLD_S = 0.3
HOLD_SAMPLES = 8
HOLD_LONGEST_S = 3.0
HOLD_SAMPLES_MAX = 2000
"""Samples wait until there are HOLD_SAMPLES over HOLD_S, or HOLD_LONGEST_S have passed, or HOLD_SAMPLES_MAX wait."""

LEAN = 0.02
"""Share of the distance to the line by which time approaches it per sample."""

SILENCE_S = 0.25
SILENCE_PERIODS = 8.0
BURST_SHARE = 0.5
"""A silence longer than both was a delay if the next read has at least BURST_SHARE of the missing samples.

Otherwise samples were lost.
"""


class ArrivalClock(Clock):
    """Times of readings without a device clock; the first one is at 0 s."""

    def __init__(self, epoch_s: float) -> None:
        super().__init__(epoch_s)
        self._waiting: list[tuple[Reading, float]] = []
        self._number = 0
        self._time_s = 0.0
        self._origin_s = 0.0

    def reconnected(self) -> None:
        """Handle a reconnect: late samples count as lost."""
        super().reconnected()
        self._turning.forget()

    def stamp(self, readings: list[Reading], arrival_s: float) -> list[Sample]:
        """Samples with times along the line through the arrivals."""
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
        self._waiting += [(reading, arrival_s) for reading in readings]
        self._fit.add(len(self._waiting) - 1, arrival_s)
        span_s = arrival_s - self._waiting[0][1]
        is_brief = span_s < HOLD_S or (len(self._waiting) < HOLD_SAMPLES and span_s < HOLD_LONGEST_S)
        if is_brief and len(self._waiting) < HOLD_SAMPLES_MAX:
            return []
        self.period_s = self._fit.slope
        if self.period_s <= 0.0:
            return []
        waiting, self._waiting = self._waiting, []
        self._number = len(waiting)
        self._origin_s = self._fit.arrival_s(0)
        self._time_s = -self.period_s
        return [self._sample(i, reading, arrived_s) for i, (reading, arrived_s) in enumerate(waiting)]

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
        _, _, rate_dps, encoder_deg, temp_c, still, yaw_deg, inertial, device_yaw, delta_deg, aids = reading
        if yaw_deg == yaw_deg:  # noqa: PLR0124 - NaN alone differs from itself
            rate_dps = self._turning.rate_dps(self._time_s, yaw_deg)
        elif delta_deg == delta_deg:  # noqa: PLR0124 - as above
            rate_dps = rate_of_delta(delta_deg, self.period_s + lean_s, self.period_s)
        t_host_s = self.epoch_s + arrival_s
        aids = aids and timed_aids(aids, self._time_s)
        return Sample(number, self._time_s, t_host_s, rate_dps, encoder_deg, temp_c, still, inertial, device_yaw, aids)
