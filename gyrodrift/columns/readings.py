"""Readings that are no measurement: single impossible ones, a sensor that does not answer, and the end of its range.

One judge for ports and files. It sees every sample once, in order, and never a later one: an impossible sample
waits for the next one.
"""

from collections import deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from enum import Enum
from math import inf, isnan, nan
from typing import Any

from gyrodrift.columns.sizes import SENSITIVITIES, ST_FINEST
from gyrodrift.values.constants import INT16_COUNTS
from gyrodrift.values.sample import Sample

Tell = Callable[..., Any]
"""Called with the name of an event and its fields."""

Values = tuple[float, ...]
"""All numbers of a sample: the rates about one or three axes, then accelerations and temperature."""

FASTEST_DPS_S = 15_000.0
"""Largest angular acceleration of a device that returns at once, deg/s². Chosen: the wrist of a hand that throws
reaches it, rate tables of laboratories and robots less. Shocks are faster, and last for more than a sample, or less."""

LEAST_JUMP_DPS = 150.0
"""Smallest change of a rate that may be impossible, deg/s: taps on a case make smaller ones within a sample (BROAD,
trial 24, at 286 Hz)."""

ZERO_JUMP_DPS, ZERO_JUMP_ALONE_DPS = 0.5, 5.0
"""Smallest rate before a zero, or −1, of all three axes, and of the only axis, that a failed read may have caused.

A sensor with noise reads three exact zeros by chance once in some thousand samples at rest, and never amid a turn.
"""

RAIL_STAYS = 2
"""Further samples at the end of a range, reached in one impossible step, that a failed read may have caused."""

LONGEST_STEP_S = 0.2
"""Longest time between two samples of which one may be impossible, s; slower streams turn by as much."""

RETURN_SHARE = 0.5
"""Share of the jump within which the rate has returned."""

CALM_STEPS, CALM_SHARE = 2, 0.5
"""Steps before a jump that must be smaller than this share of it: a rate that shakes at every sample is real."""

LEAST_CHANGES = 200
FINE_DPS = 0.03
"""A sensor has noise if its rate changed LEAST_CHANGES times, by steps as fine as FINE_DPS. A coarser one repeats
values at rest."""

HELD_SAMPLES, LONGER_HELD = 4, 2
"""A rate is no measurement after this many repetitions, and LONGER_HELD times as many as ever before."""

HANGS_SAMPLES, HANGS_S, LONGER_HANGS = 20, 0.5, 10
"""A hang is reported after as many samples and seconds, and LONGER_HANGS times as many repetitions as ever before."""

SILENT_SAMPLES, SILENT_S = 10, 0.9
"""Repetitions and time from the first sample on that show a sensor that never answered."""

ABSURD = 4.0
"""Jump over the largest possible one above which the end of a range is no measurement even if it repeats."""

RAIL_MIN_DPS = 20.0
"""Smallest rate that may be the end of a range, deg/s."""

KNOWN_RAIL_SAMPLES, RAIL_SAMPLES = 3, 5
APPROACH_SAMPLES, RAIL_APPROACH_DPS, RAIL_APPROACH_SHARE = 5, 1.0, 0.7
"""A range ends where the largest rate repeats: KNOWN_RAIL_SAMPLES times at ±2¹⁵ counts of a known sensitivity, else
RAIL_SAMPLES times, and LONGER_HELD times as often as any other rate. A turn comes there on its way, by
RAIL_APPROACH_DPS within APPROACH_SAMPLES, and by at most RAIL_APPROACH_SHARE in one. A hang comes from anywhere."""

ONE_COUNT = 0.05
"""Largest distance from −1 count, in counts: a value is printed with some digits."""

RANGES_DPS = (125.0, 245.0, 250.0, 450.0, 500.0, 1000.0, 2000.0, 4000.0)
"""Ranges of MEMS gyros (InvenSense, Bosch, ST, Analog Devices), deg/s."""

RAIL_COUNTS = 1.5
"""Largest distance from ±2¹⁵ counts at the end of a range."""

NEVER_MOVED_S = 20.0
"""Time from the first sample on without a change after which the user is told: a start at rest seldom takes longer."""

DOES_NOT_ANSWER = "the sensor does not answer: check its wires, address and supply, and the pull-ups of I2C"
NEVER_MOVED = f"the rate has not changed since the start: it is at rest behind a dead band, or {DOES_NOT_ANSWER}"
HANGS = f"the sensor repeats one value although it has noise; yaw is held meanwhile; {DOES_NOT_ANSWER}"
IMPOSSIBLE = "the rate jumped and returned faster than a device can turn; yaw leaves such samples out"
CLIPPED = "the range of the sensor ends there: yaw loses the angle that is cut off; choose a wider range"


class ReadingVerdict(Enum):
    """Kind of a sample: a measurement, none, or undecided until the next sample."""

    GOOD = "good"
    MISSING = "missing"
    SUSPECT = "suspect"


RAILS_DPS = (*(INT16_COUNTS / counts for counts in (*SENSITIVITIES, ST_FINEST[1])), *RANGES_DPS)
"""Ends of ranges, deg/s: full scales of 16 bits at known sensitivities, and the names of ranges."""


def is_rail(rate_dps: float) -> bool:
    """Whether a rate is the end of a known range, ±2¹⁵ counts."""
    size_dps = abs(rate_dps)
    return any(abs(size_dps - rail_dps) * INT16_COUNTS <= RAIL_COUNTS * rail_dps for rail_dps in RAILS_DPS)


def no_answer(rates: Values, companions: Values) -> bool:
    """Whether constant numbers are those of a bus without a sensor.

    Three rates are the same number, or a single rate is one count below zero: a bus whose lines are high reads 0xFFFF,
    which is −1. Rates of zero count only if the accelerations are zero too: a sensor may report them at rest, but then
    it measures gravity.
    """
    if len(rates) == 1:
        return _are_ones(rates[0])
    return len(set(rates)) == 1 and (rates[0] != 0.0 or (len(companions) >= 3 and not any(companions[:3])))


def _are_ones(rate_dps: float) -> bool:
    """Whether a rate is one count below zero, in counts or in deg/s."""
    counts = (*SENSITIVITIES, ST_FINEST[1])
    return rate_dps == -1.0 or any(abs(rate_dps * count + 1.0) < ONE_COUNT for count in counts)


def _change(a: Values, b: Values) -> float:
    """Change of the yaw rate between two samples, deg/s. The filter of three axes judges the other axes itself."""
    return abs(a[-1] - b[-1])


@dataclass(slots=True)
class ReadingJudge:
    """Judge of samples in their order.

    tell
        Called with `impossible_reading`, `clipped`, `rate_hangs` and `rate_moves`.
    was_real
        Whether the sample that waited was a measurement, after the next `take`.
    impossible, clipped, hung_s
        Number of impossible and of clipped samples, and total time of reported hangs, s.
    """

    tell: Tell
    was_real: bool = True
    impossible: int = 0
    clipped: int = 0
    hung_s: float = 0.0
    _t_s: float = nan
    _rates: Values = ()
    _companions: Values = ()
    _calm: int = 0
    _suspect: Values | None = None
    _suspect_s: float = 0.0
    _may_stay: bool = False
    _bound_dps: float = inf
    _stays_max: float = inf
    _stays: int = 0
    _rate_dps: float = nan
    _since_s: float = 0.0
    _repeats: int = 0
    _all_repeats: int = 0
    _longest: int = 0
    _changes: int = 0
    _finest_dps: float = inf
    _before_dps: deque[float] = field(default_factory=lambda: deque([nan], APPROACH_SAMPLES))
    _largest_dps: float = 0.0
    _hung: tuple[float, float] | None = None
    _is_clipping: bool = False

    def take(self, t_s: float, rates: Values, companions: Values = ()) -> ReadingVerdict:
        """Judge a sample.

        rates
            Rates about one or three axes, the yaw rate last.
        companions
            Accelerations and temperature.
        """
        if isnan(rates[-1]):
            self.was_real, self._suspect, self._stays = not self._stays, None, 0
            return ReadingVerdict.GOOD
        if len(rates) != len(self._rates):  # the first sample, or another device
            self.was_real, self._suspect, self._stays, self._calm = not self._stays, None, 0, 0
            return self._accept(t_s, rates, companions)
        if self._suspect is not None and self._waits_on(self._suspect, t_s, rates):
            return ReadingVerdict.MISSING
        if -1.0 <= rates[-1] <= 0.0 and self._is_failed_read(t_s, rates):
            return self._suspend(t_s, rates, 0.0)
        change_dps = abs(rates[-1] - self._rates[-1])
        if change_dps <= CALM_SHARE * LEAST_JUMP_DPS:
            self._calm += 1
            return self._accept(t_s, rates, companions)
        return self._leap(t_s, rates, companions)

    def _leap(self, t_s: float, rates: Values, companions: Values) -> ReadingVerdict:
        """Judge a sample after a large change of the rate."""
        seconds, change_dps = t_s - self._t_s, _change(rates, self._rates)
        bound_dps = LEAST_JUMP_DPS if is_rail(rates[-1]) else _bound_dps(seconds)
        if change_dps > bound_dps and 0.0 < seconds <= LONGEST_STEP_S and self._calm >= CALM_STEPS:
            self._may_stay = self._is_noisy and change_dps > RAIL_APPROACH_SHARE * abs(rates[-1])
            may_be_clipped = is_rail(rates[-1]) and change_dps <= ABSURD * _bound_dps(seconds)
            return self._suspend(t_s, rates, bound_dps, RAIL_STAYS if may_be_clipped else inf)
        self._calm = self._calm + 1 if change_dps <= CALM_SHARE * bound_dps else 0
        return self._accept(t_s, rates, companions)

    def _is_failed_read(self, t_s: float, rates: Values) -> bool:
        """Whether zeros or ones of the bus follow a rate that a sensor with noise and no dead band cannot leave so."""
        is_alone, largest_dps = len(rates) == 1, max(map(abs, self._rates))
        if rates.count(rates[0]) < len(rates) or largest_dps < (ZERO_JUMP_ALONE_DPS if is_alone else ZERO_JUMP_DPS):
            return False
        self._may_stay = largest_dps >= ZERO_JUMP_ALONE_DPS
        is_usual = not self._is_noisy or self._longest >= HELD_SAMPLES or t_s - self._t_s > LONGEST_STEP_S
        return not is_usual and (self._calm > 0 or not is_alone) and (rates[0] == 0.0 or _are_ones(rates[0]))

    def _suspend(self, t_s: float, rates: Values, bound_dps: float, stays_max: float = inf) -> ReadingVerdict:
        """Let a sample wait for the next one; its repetitions up to a number are no measurement either."""
        self._suspect, self._suspect_s, self._bound_dps, self._calm = rates, t_s, bound_dps, 0
        self._stays_max = stays_max
        return ReadingVerdict.SUSPECT

    def end(self) -> None:
        """Report a hang that lasts to the end, and a rate that never changed."""
        if self._changes <= 1 and self._repeats >= SILENT_SAMPLES and self._t_s - self._since_s >= SILENT_S:
            self._report(self._rate_dps, self._since_s, self._t_s, NEVER_MOVED)
        self._move(self._t_s)

    def _waits_on(self, suspect: Values, t_s: float, rates: Values) -> bool:
        """Decide on the sample that waits; whether it goes on, because a sensor with noise repeats it exactly."""
        jump_dps, bound_dps = _change(suspect, self._rates), min(self._bound_dps, _bound_dps(t_s - self._suspect_s))
        if rates == suspect and self._may_stay and self._stays < self._stays_max:
            self._stays += 1
            self.was_real, self._t_s = False, t_s
            if self._stays >= HANGS_SAMPLES and t_s - self._suspect_s >= HANGS_S:
                self._report(suspect[-1], self._suspect_s, t_s, DOES_NOT_ANSWER)
            return True
        has_returned = _change(rates, self._rates) < RETURN_SHARE * jump_dps and _change(rates, suspect) > bound_dps
        self.was_real = not (has_returned or self._stays)
        if self.was_real:
            self._accept(self._suspect_s, suspect, ())
        elif self._hung is None:
            self.impossible += 1 + self._stays
            self.tell("impossible_reading", rate_dps=suspect[-1], count=self.impossible, hint=IMPOSSIBLE)
        else:
            self._move(t_s)
        self._suspect, self._stays = None, 0
        return False

    def _accept(self, t_s: float, rates: Values, companions: Values) -> ReadingVerdict:
        rate_dps = rates[-1]
        if rate_dps != self._rate_dps:
            self._change_rate(t_s, rate_dps)
            self._rates, self._companions, self._t_s = rates, companions, t_s
            return ReadingVerdict.GOOD
        self._all_repeats = self._all_repeats + 1 if rates == self._rates and companions == self._companions else 0
        self._rates, self._companions, self._t_s = rates, companions, t_s
        self._repeats += 1
        return ReadingVerdict.GOOD if self._is_clipped(rate_dps) else self._judge_repeated(t_s, rate_dps)

    def _change_rate(self, t_s: float, rate_dps: float) -> None:
        if self._repeats:
            if self._hung is None and not self._is_clipping:
                self._longest = max(self._longest, self._repeats)
            self._move(t_s)
            self._repeats, self._all_repeats, self._is_clipping = 0, 0, False
        size_dps, step_dps = abs(self._rate_dps), abs(rate_dps - self._rate_dps)
        self._largest_dps = max(self._largest_dps, size_dps)
        self._finest_dps = min(self._finest_dps, step_dps)
        self._before_dps.append(self._rate_dps)
        self._changes += 1
        self._rate_dps, self._since_s = rate_dps, t_s

    @property
    def _is_noisy(self) -> bool:
        return self._changes >= LEAST_CHANGES and self._finest_dps <= FINE_DPS

    def _is_clipped(self, rate_dps: float) -> bool:
        """Whether the rate is at the end of the range; counts its samples."""
        size_dps, samples = abs(rate_dps), self._repeats + 1
        if self._is_clipping:
            self.clipped += 1
        elif size_dps >= max(RAIL_MIN_DPS, self._largest_dps):
            is_plateau = (
                samples >= max(RAIL_SAMPLES, LONGER_HELD * self._longest + 1)
                and size_dps - abs(self._before_dps[0]) >= RAIL_APPROACH_DPS
                and size_dps - abs(self._before_dps[-1]) <= RAIL_APPROACH_SHARE * size_dps
                and self._changes >= LEAST_CHANGES
            )
            is_plain = rate_dps.is_integer() and self._changes < LEAST_CHANGES  # such as a simulated turn
            if is_plateau or (samples >= KNOWN_RAIL_SAMPLES and is_rail(rate_dps) and not is_plain):
                self._is_clipping = True
                self.clipped += samples
                self.tell("clipped", limit_dps=round(size_dps, 3), count=self.clipped, hint=CLIPPED)
        return self._is_clipping

    def _judge_repeated(self, t_s: float, rate_dps: float) -> ReadingVerdict:
        """ReadingVerdict on a rate that repeats."""
        seconds = t_s - self._since_s
        if self._changes <= 1:  # it never moved
            is_brief = self._all_repeats < SILENT_SAMPLES or seconds < SILENT_S
            if is_brief or not no_answer(self._rates, self._companions):
                if seconds >= NEVER_MOVED_S:
                    self._report(rate_dps, self._since_s, t_s, NEVER_MOVED)
                return ReadingVerdict.GOOD
            self._report(rate_dps, self._since_s, t_s, DOES_NOT_ANSWER)
            return ReadingVerdict.MISSING
        is_all = len(self._rates) + len(self._companions) > 1 and self._all_repeats >= self._repeats
        if not self._is_noisy or (rate_dps == 0.0 and not is_all):
            return ReadingVerdict.GOOD
        if self._repeats > LONGER_HANGS * self._longest and self._repeats >= HANGS_SAMPLES and seconds >= HANGS_S:
            self._report(rate_dps, self._since_s, t_s, HANGS)
        return (
            ReadingVerdict.MISSING
            if self._repeats > max(HELD_SAMPLES, LONGER_HELD * self._longest)
            else ReadingVerdict.GOOD
        )

    def _report(self, rate_dps: float, since_s: float, t_s: float, hint: str) -> None:
        if self._hung is None:
            self._hung = rate_dps, since_s
            self.tell("rate_hangs", rate_dps=rate_dps, seconds=round(t_s - since_s, 3), hint=hint)

    def _move(self, t_s: float) -> None:
        """Report the end of a hang, if there is one."""
        if self._hung is not None:
            (rate_dps, since_s), self._hung = self._hung, None
            self.hung_s += t_s - since_s
            self.tell("rate_moves", rate_dps=rate_dps, seconds=round(t_s - since_s, 3), since_s=round(since_s, 6))


def _bound_dps(seconds: float) -> float:
    """Largest possible change of a rate within a time, deg/s."""
    return max(LEAST_JUMP_DPS, FASTEST_DPS_S * seconds)


def values_of(sample: Sample) -> tuple[Values, Values]:
    """Rates of a sample, that about z last, and its other numbers; missing ones are left out."""
    inertial, rate_dps, temp_c = sample.inertial, sample.rate_dps, sample.temp_c
    temp = (temp_c,) if temp_c == temp_c else ()  # noqa: PLR0124 - not NaN
    if inertial is None:
        return (rate_dps,), temp
    x_dps, y_dps, _, ax_mps2, ay_mps2, az_mps2 = inertial
    if ax_mps2 != ax_mps2:  # noqa: PLR0124 - NaN
        return (x_dps, y_dps, rate_dps), temp
    return (x_dps, y_dps, rate_dps), (ax_mps2, ay_mps2, az_mps2, *temp)


@dataclass(slots=True)
class StreamJudge:
    """Judge of a stream: samples with their rates, or without them if they are no measurement.

    missing
        Number of samples that were passed on without their rates.
    """

    judge: ReadingJudge
    missing: int = 0
    _waiting: Sample | None = None

    def take(self, samples: Iterable[Sample]) -> list[Sample]:
        """The samples that are decided, in their order."""
        judged: list[Sample] = []
        for sample in samples:
            verdict = self.judge.take(sample.t_device_s, *values_of(sample))
            if self._waiting is not None:
                judged.append(self._waiting if self.judge.was_real else self._without_rate(self._waiting))
                self._waiting = None
            if verdict is ReadingVerdict.GOOD:
                judged.append(sample)
            elif verdict is ReadingVerdict.MISSING:
                judged.append(self._without_rate(sample))
            else:
                self._waiting = sample
        return judged

    def _without_rate(self, sample: Sample) -> Sample:
        """The sample without its rates, which a filter passes over."""
        self.missing += 1
        return sample._replace(rate_dps=nan, inertial=None)
