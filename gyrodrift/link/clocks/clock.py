"""Base of both clocks, their events, the fading regression line that they use, and the calendar of the host.

The arrival is never the time of a sample: a serial link delivers late and in bursts, never early. The device clock uses
the line only to cross-check and to measure its drift; the arrival clock takes its times from it.

A user or NTP may set the system clock while samples arrive. The Unix time of a recording does not follow at once; the
caller of `Calendar.follow` decides when the new time begins.
"""

import time
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from math import exp, nan

from gyrodrift.values.aid import Aid
from gyrodrift.values.constants import DELTA_GAP_PERIODS, DELTA_GAP_S, FULL_TURN_DEG
from gyrodrift.values.sample import Reading, Sample

FASTEST_DPS = 2000.0
"""Range of the gyros on these boards; an angle that moves faster was reset."""

CLOCK_SET = "host_clock_set"
"""Event that reports a step of the system clock."""

STEP_MIN_S = 0.5
"""Smallest step that starts another file; slewing changes both clocks, and is not a step."""


class TurningRate:
    """Rate from differences of a wrapping angle."""

    def __init__(self) -> None:
        self._before: tuple[float, float] | None = None

    def forget(self) -> None:
        """Restart after a reset of the clock or the angle."""
        self._before = None

    def rate_dps(self, t_s: float, angle_deg: float) -> float:
        """Mean rate since the last time, deg/s; NaN for the first angle, for equal times, and after a reset."""
        before, self._before = self._before, (t_s, angle_deg)
        if before is None:
            return nan
        step_s = t_s - before[0]
        if step_s <= 0.0:
            self._before = before
            return nan
        step_deg = (angle_deg - before[1] + 0.5 * FULL_TURN_DEG) % FULL_TURN_DEG - 0.5 * FULL_TURN_DEG
        rate_dps = step_deg / step_s
        return rate_dps if abs(rate_dps) <= FASTEST_DPS else nan


def rate_of_delta(delta_deg: float, step_s: float, usual_s: float) -> float:
    """Mean rate over a step, deg/s, of an angle since the last sample; NaN before the first step.

    After a gap the angle is that of one sample.
    """
    is_gap = step_s <= 0.0 or (usual_s > 0.0 and step_s > max(DELTA_GAP_S, DELTA_GAP_PERIODS * usual_s))
    over_s = usual_s if is_gap else step_s
    return delta_deg / over_s if over_s > 0.0 else nan


@dataclass(frozen=True, slots=True)
class SampleGap:
    """Gap in the counter, or in time without a counter; the time step across it is true.

    `missing` samples in a step of `seconds`.
    """

    missing: int
    seconds: float


@dataclass(frozen=True, slots=True)
class ClockRestart:
    """Reset or step of the device clock; device time continues one period after the last sample.

    `step_s` is the step of the raw clock, `silent_s` the host time without samples before it.
    """

    step_s: float
    silent_s: float


ClockEvent = SampleGap | ClockRestart


class ArrivalFit:
    """Exponentially weighted line through (x, arrival), with a gate against late arrivals.

    x is device time in s or a sample number. The line ignores arrivals that differ by more than `GATE_SCATTERS` mean
    deviations and by more than `GATE_FLOOR_S`. After `GATE_PATIENCE` of them in a row it restarts.
    """

    MEMORY_S = 30.0
    WARM_S = 0.5
    SCATTER_MEMORY = 50.0
    GATE_SCATTERS = 10.0
    GATE_FLOOR_S = 0.005
    GATE_PATIENCE = 50

    def __init__(self) -> None:
        self.restart()

    def restart(self) -> None:
        """Forget everything."""
        self._weight = 0.0
        self._x = self._y = self._xx = self._xy = 0.0
        self._first_s = self._last_s = 0.0
        self._scatter_s = 0.0
        self._refused = 0

    def shift(self, seconds: float) -> None:
        """Shift the line by `seconds`; its slope does not change."""
        self._y += seconds

    @property
    def is_warm(self) -> bool:
        """Whether it covers enough host time."""
        return self._last_s - self._first_s >= self.WARM_S and self._xx > 0.0

    @property
    def slope(self) -> float:
        """Host seconds per unit of x; 0 while unknown."""
        return self._xy / self._xx if self._xx > 0.0 else 0.0

    def arrival_s(self, x: float) -> float:
        """Expected arrival of x, monotonic host clock, s."""
        return self._y + self.slope * (x - self._x)

    def add(self, x: float, arrival_s: float) -> None:
        """Add an arrival."""
        if self.is_warm and self._refuses(abs(arrival_s - self.arrival_s(x))):
            self._refused += 1
            if self._refused < self.GATE_PATIENCE:
                return
            self.restart()
        self._refused = 0
        if self._weight == 0.0:
            self._first_s = self._last_s = arrival_s
        fade = exp((self._last_s - arrival_s) / self.MEMORY_S)
        self._last_s = arrival_s
        self._weight = self._weight * fade + 1.0
        dx, dy = x - self._x, arrival_s - self._y
        self._x += dx / self._weight
        self._y += dy / self._weight
        self._xx = self._xx * fade + dx * (x - self._x)
        self._xy = self._xy * fade + dx * (arrival_s - self._y)

    def _refuses(self, residual_s: float) -> bool:
        if residual_s > max(self.GATE_FLOOR_S, self.GATE_SCATTERS * self._scatter_s):
            return True
        self._scatter_s += (residual_s - self._scatter_s) / self.SCATTER_MEMORY
        return False


def timed_aids(aids: tuple[Aid, ...], t_s: float) -> tuple[Aid, ...]:
    """Measurements that count from a reading, on the clock of its sample; a time of NaN stays."""
    return tuple(aid._replace(t_s=aid.t_s + t_s) for aid in aids)


class Clock(ABC):
    """Times of readings; `events` collects its events for the link.

    epoch_s
        Unix time at zero of the monotonic host clock, s.
    period_s
        Typical step between samples, s; 0 while unknown.
    """

    def __init__(self, epoch_s: float) -> None:
        self.events: list[ClockEvent] = []
        self.epoch_s = epoch_s
        self.period_s = 0.0
        self._fit = ArrivalFit()
        self._turning = TurningRate()
        self._has_reconnected = False

    @property
    def drift_ppm(self) -> float | None:
        """Drift of the device clock against the host clock, ppm; None if unknown, or without a device clock."""
        return None

    @property
    def pace(self) -> float:
        """Host seconds per second of the device clock; 0 while unknown, 1 for times of the host."""
        return 1.0

    @abstractmethod
    def stamp(self, readings: list[Reading], arrival_s: float) -> list[Sample]:
        """Samples from readings that arrived together at `arrival_s`, s on the monotonic host clock."""

    def reconnected(self) -> None:
        """Handle a reconnect: the clock of the next reading may have restarted."""
        self._has_reconnected = True


class Calendar:
    """Unix time without steps; `epoch_s` is the Unix time at zero of the monotonic clock."""

    def __init__(self, monotonic: Callable[[], float]) -> None:
        self._monotonic = monotonic
        self.epoch_s = self._epoch_now_s()

    def unix_s(self) -> float:
        """Present Unix time, s."""
        return self.epoch_s + self._monotonic()

    def step_s(self) -> float:
        """Step of the system clock since, s; 0 without one."""
        step_s = self._epoch_now_s() - self.epoch_s
        return step_s if abs(step_s) >= STEP_MIN_S else 0.0

    def follow(self) -> None:
        """Use the present system clock from now on."""
        self.epoch_s = self._epoch_now_s()

    def _epoch_now_s(self) -> float:
        return time.time() - self._monotonic()
