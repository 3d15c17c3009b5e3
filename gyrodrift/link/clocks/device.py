"""Clock of the device: unwrapped over 32 bits, with gaps, restarts and glitches told apart by its counter."""

from collections import deque
from statistics import median

from gyrodrift.link.clocks.clock import Clock, ClockRestart, SampleGap, rate_of_delta, timed_aids
from gyrodrift.values.constants import CLOCK_WRAP_US, COUNTER_WRAP, REPEATED_PERIODS
from gyrodrift.values.sample import Reading, Sample

ODD_US = 100_000
ODD_SHARE = 0.1
"""Largest difference of clock and counter over a step, in µs, and as a share of the step."""

STEP_US = 1_000_000
"""Longest step that counts before the period is known, µs."""

FORWARD_SAMPLES = 64
"""Longest gap after an odd step that still confirms it, in samples; the counter may have restarted, too."""

ODD_PERIODS = 4.0
RETURN_PERIODS = 2.5
"""Without a counter, a step of more than ODD_PERIODS waits for the next reading.

If that is within RETURN_PERIODS of the last one before, the odd reading was a glitch.
"""

CROSS_CHECK_SLACK_S = 0.5
"""Largest difference of host and device clock over one step, s."""

REAL_TIME = (0.9, 1.1)
"""Range of host seconds per device second in which the host clock is a cross-check; a fast replay is outside."""

PERIOD_STEPS = 33
HOLE_PERIODS = 1.5
"""Without a counter, a step of more than HOLE_PERIODS times the median of PERIOD_STEPS steps is a gap."""

NEW_PACE_STEPS, NEW_PACE_WITHIN = 5, 0.1
"""So many long steps in a row, equal to this share, are a new sample rate and no gaps."""

FALLBACK_PERIOD_S = 0.01

FIT_EVERY_S = 0.02
"""Interval of points for the line through (device time, arrival), s; more points would cost too much time."""


def clock_step(last: Reading, reading: Reading) -> int:
    """Signed step of the wrapping clock, µs."""
    half = CLOCK_WRAP_US // 2
    return ((reading.t_us or 0) - (last.t_us or 0) + half) % CLOCK_WRAP_US - half


def counter_step(last_seq: int, seq: int) -> int:
    """Step of the wrapping counter."""
    return (seq - last_seq) % COUNTER_WRAP


def step_between(last: Reading, reading: Reading) -> tuple[int, int]:
    """Steps of the clock, µs, and of the counter; 0 without a counter."""
    counted = 0 if last.seq is None or reading.seq is None else counter_step(last.seq, reading.seq)
    return clock_step(last, reading), counted


def agree(counted_us: float, step_us: int) -> bool:
    """Whether counter and clock agree on a step."""
    return abs(counted_us - step_us) <= max(ODD_US, ODD_SHARE * abs(step_us))


def is_one_pace(before: tuple[int, int], after: tuple[int, int]) -> bool:
    """Whether the period is the same over two forward steps, by the counter.

    It confirms the steps of a device with a new sample rate, before its period is known.
    """
    (before_us, counted_before), (after_us, counted) = before, after
    if before_us <= 0 or after_us <= 0 or not all(0 < count < COUNTER_WRAP // 2 for count in (counted_before, counted)):
        return False
    expected = before_us * counted
    return abs(after_us * counted_before - expected) <= ODD_SHARE * expected


class DeviceClock(Clock):
    """Unwrapped microsecond clock and 16-bit counter.

    A step of about one period counts at once. So does a longer one that the counter confirms, or whose samples are as
    far apart as those before. Any other step waits for the next reading:

    - If that continues from the step, the step was real. It is a gap if it leads forward and the host clock agrees:
      a sample cannot arrive before it was taken. Else the clock has restarted, and device time continues one period
      after the last sample.
    - If that continues from before the step, the step was a glitch of one reading.

    A reading whose time stands still, or that repeats an older one with its counter, is passed on. The filter counts
    and ignores it.
    """

    def __init__(self, epoch_s: float) -> None:
        super().__init__(epoch_s)
        self.glitches = 0
        self._steps_s: deque[float] = deque(maxlen=PERIOD_STEPS)
        self._long_s: deque[float] = deque(maxlen=NEW_PACE_STEPS)
        self._last: Reading | None = None
        self._time_us = 0
        self._seq = 0
        self._step = 0, 0
        self._arrival_s = 0.0
        self._suspect: Reading | None = None
        self._usual_us = 0.0
        self._fit_due_s = float("-inf")

    @property
    def drift_ppm(self) -> float | None:
        """Drift, ppm, positive if the device clock is fast; None if the host clock is not a cross-check."""
        return (1.0 / self._fit.slope - 1.0) * 1e6 if self._host_can_cross_check() else None

    @property
    def pace(self) -> float:
        """Host seconds per device second: about 1, except for a fast replay, or a clock in another unit."""
        return self._fit.slope if self._fit.is_warm else 0.0

    def stamp(self, readings: list[Reading], arrival_s: float) -> list[Sample]:
        """Samples with unwrapped device times."""
        samples: list[Sample] = []
        for reading in readings:
            last = self._last
            if last is None:
                self._time_us, self._seq = reading.t_us or 0, reading.seq or 0
                self._move(reading, 0, 0, arrival_s, samples)
            elif self._is_next(last, reading):
                self._move(reading, (reading.t_us or 0) - (last.t_us or 0), 1, arrival_s, samples)
            else:
                self._classify(last, reading, arrival_s, samples)
        if samples:
            self._arrival_s = arrival_s
            if arrival_s >= self._fit_due_s:
                self._fit.add(self._time_us * 1e-6, arrival_s)
                self._fit_due_s = arrival_s + FIT_EVERY_S
        return samples

    def _is_next(self, last: Reading, reading: Reading) -> bool:
        """Fast check of the common case: counter plus one, clock plus about one period."""
        t_us, seq, last_us, last_seq = reading.t_us, reading.seq, last.t_us, last.seq
        return (
            seq is not None
            and last_seq is not None
            and t_us is not None
            and last_us is not None
            and seq - last_seq == 1
            and 0 < t_us - last_us < self._usual_us
            and self._suspect is None
            and not self._has_reconnected
        )

    def _classify(self, last: Reading, reading: Reading, arrival_s: float, samples: list[Sample]) -> None:
        step_us = clock_step(last, reading)
        suspect, self._suspect = self._suspect, None
        is_usual = self._is_usual(last, reading, step_us)
        if suspect is None and not is_usual:
            self._suspect = reading
        elif suspect is None or (is_usual and step_us <= RETURN_PERIODS * self.period_s * 1e6):
            self.glitches += suspect is not None
            self._accept(last, reading, step_us, arrival_s, samples)
        elif self._continues(suspect, reading) or (not is_usual and _is_forward(suspect, reading)):
            self._resolve_step(last, suspect, arrival_s, samples)
            self._classify(suspect, reading, arrival_s, samples)
        else:
            self.glitches += 1
            self._suspect = reading

    def _accept(self, last: Reading, reading: Reading, step_us: int, arrival_s: float, samples: list[Sample]) -> None:
        if step_us > 0:
            self._move(reading, step_us, self._counted(last, reading, step_us), arrival_s, samples)
        else:
            samples.append(self._sample(reading, self._time_us + step_us, self._seq, arrival_s))

    def _is_usual(self, last: Reading, reading: Reading, step_us: int) -> bool:
        """Whether a step is plausible, and confirmed by the counter, so that it needs no second reading."""
        if self._has_reconnected:
            return False
        counted_us = self._counted_us(last, reading)
        if counted_us is not None and step_us >= -REPEATED_PERIODS * self.period_s * 1e6:
            is_borne_out = counted_us < COUNTER_WRAP // 2 * self.period_s * 1e6  # without guessing the number of wraps
            return (is_borne_out and agree(counted_us, step_us)) or is_one_pace(self._step, step_between(last, reading))
        if not self.period_s:
            return 0 <= step_us <= STEP_US
        return 0 <= step_us <= ODD_PERIODS * self.period_s * 1e6

    def _counted_us(self, last: Reading, reading: Reading) -> float | None:
        """Expected time step from the counter, signed, µs; None without counter or period."""
        if reading.seq is None or last.seq is None or not self.period_s:
            return None
        half = COUNTER_WRAP // 2
        counted = (reading.seq - last.seq + half) % COUNTER_WRAP - half
        # A gap of more than half a wrap looks like a step back; the clock gives the number of wraps.
        wraps = round((clock_step(last, reading) / (self.period_s * 1e6) - counted) / COUNTER_WRAP)
        return (counted + max(0, wraps) * COUNTER_WRAP) * self.period_s * 1e6

    def _resolve_step(self, last: Reading, first: Reading, arrival_s: float, samples: list[Sample]) -> None:
        """Handle an odd step that the next reading confirms: a gap, or a restart."""
        step_us = clock_step(last, first)
        if step_us > 0 and self._is_hole(last, first, step_us, arrival_s):
            self._move(first, step_us, self._counted(last, first, step_us), arrival_s, samples)
        else:
            self._restart(last, first, arrival_s, samples)

    def _is_hole(self, last: Reading, first: Reading, step_us: int, arrival_s: float) -> bool:
        expected_s = self._fit.arrival_s((self._time_us + step_us) * 1e-6)
        if self._host_can_cross_check():
            if self._has_reconnected:
                return abs(expected_s - arrival_s) < CROSS_CHECK_SLACK_S
            return expected_s < arrival_s + CROSS_CHECK_SLACK_S
        counted_us = self._counted_us(last, first)
        return counted_us is None or agree(counted_us, step_us)

    def _host_can_cross_check(self) -> bool:
        return self._fit.is_warm and REAL_TIME[0] < self._fit.slope < REAL_TIME[1]

    def _continues(self, suspect: Reading, reading: Reading) -> bool:
        return 0 < clock_step(suspect, reading) <= max(STEP_US, ODD_PERIODS * self.period_s * 1e6)

    def _counted(self, last: Reading, reading: Reading, step_us: int) -> int:
        """Step of the counter over a confirmed step of time; reports a gap."""
        step_s = step_us * 1e-6
        expected = step_s / self.period_s if self.period_s else 1.0
        if reading.seq is None or last.seq is None:
            moved = round(expected) if expected > HOLE_PERIODS and not self._is_new_pace(step_s) else 1
        else:
            moved = counter_step(last.seq, reading.seq)
            moved += COUNTER_WRAP * round((expected - moved) / COUNTER_WRAP)
            if moved > 4.0 * expected + 8.0:  # only the counter jumped: nothing is missing
                return moved
        if moved <= 1:
            self._long_s.clear()
        else:
            self.events.append(SampleGap(moved - 1, step_s))
        if moved <= 1 or not self.period_s:  # a device may lose samples from its first one on
            self._learn_period(step_s / max(1, moved))
        return moved

    def _is_new_pace(self, step_s: float) -> bool:
        """Whether long steps have become usual; then they are the period."""
        self._long_s.append(step_s)
        usual_s = median(self._long_s)
        if len(self._long_s) < NEW_PACE_STEPS or any(
            abs(long_s - usual_s) > NEW_PACE_WITHIN * usual_s for long_s in self._long_s
        ):
            return False
        self.period_s, self._usual_us = usual_s, HOLE_PERIODS * usual_s * 1e6
        self._steps_s.clear()
        return True

    def _learn_period(self, step_s: float) -> None:
        self._steps_s.append(step_s)
        if len(self._steps_s) == PERIOD_STEPS or (not self.period_s and len(self._steps_s) == 3):
            self.period_s = median(self._steps_s)
            self._usual_us = HOLE_PERIODS * self.period_s * 1e6
            self._steps_s.clear()

    def _restart(self, last: Reading, first: Reading, arrival_s: float, samples: list[Sample]) -> None:
        self._turning.forget()
        self.events.append(ClockRestart(clock_step(last, first) * 1e-6, arrival_s - self._arrival_s))
        period_us = round((self.period_s or FALLBACK_PERIOD_S) * 1e6)
        if self._host_can_cross_check():  # it remains a cross-check, since the clock may restart again
            self._fit.shift(arrival_s - self._fit.arrival_s((self._time_us + period_us) * 1e-6))
        else:
            self._fit.restart()
        self._move(first, period_us, 1, arrival_s, samples)

    def _move(self, reading: Reading, step_us: int, counted: int, arrival_s: float, samples: list[Sample]) -> None:
        self._has_reconnected = False
        self._last = reading
        self._step = step_us, counted
        self._time_us += step_us
        self._seq += counted
        samples.append(self._sample(reading, self._time_us, self._seq, arrival_s))

    def _sample(self, reading: Reading, time_us: int, seq: int, arrival_s: float) -> Sample:
        # An integer divided by 10^6 is the double nearest to the decimal fraction in a csv.
        _, _, rate_dps, encoder_deg, temp_c, still, yaw_deg, inertial, device_yaw, delta_deg, aids = reading
        if yaw_deg == yaw_deg:  # noqa: PLR0124 - NaN alone differs from itself
            rate_dps = self._turning.rate_dps(time_us * 1e-6, yaw_deg)
        elif delta_deg == delta_deg:  # noqa: PLR0124 - as above
            step_us, counted = self._step
            rate_dps = rate_of_delta(
                delta_deg, step_us * 1e-6 / max(1, counted if reading.seq is not None else 1), self.period_s
            )
        t_host_s = self.epoch_s + arrival_s
        aids, t_s = aids and timed_aids(aids, time_us / 1e6), time_us / 1e6
        return Sample(seq, t_s, t_host_s, rate_dps, encoder_deg, temp_c, still, inertial, device_yaw, aids)


def _is_forward(suspect: Reading, reading: Reading) -> bool:
    """Whether counter and clock both advanced from a suspect step, by at most STEP_US per sample.

    If frames are lost while the device changes to a slower rate, steps of both rates occur.
    """
    step_us, counted = step_between(suspect, reading)
    return 0 < counted < FORWARD_SAMPLES and 0 < step_us <= STEP_US * counted
