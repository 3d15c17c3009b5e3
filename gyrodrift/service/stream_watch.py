"""Warnings about a stream without gaps: a rate that hangs, a device clock that changes its unit, and missing axes.

The first two are guesses, so the samples are still processed; the warning says that yaw is not reliable. A device of
three axes may stop sending its accelerations, or two of its rates. Yaw goes on by fewer measurements.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from math import hypot, inf, nan
from typing import Any

from gyrodrift.filters.restlevel.noise import FINE_DPS
from gyrodrift.filters.run import WITHOUT_AXES_S as LOST_S
from gyrodrift.link.unit_check import SLOWEST_PACE
from gyrodrift.values.sample import Sample

Tell = Callable[..., Any]
"""Called with the name of an event and its fields."""

LEAST_CHANGES = 200
"""Changes of the rate before it counts as noisy."""

HANGS_SAMPLES, HANGS_S = 50, 1.0
LONGER = 10
"""A rate hangs if it repeats for this many samples and seconds, and LONGER times as often as ever before."""

PACE_S, PACE_SAMPLES = 2.0, 10
PACE_WINDOWS = 2
"""Windows of host time in which a clock is compared. Two in a row must differ: in one the device may have slept, or the
clock of the host may have been set."""

WITHOUT_ACCELERATIONS = "the device sends three rates without accelerations: the tilt is by the gyro, or unknown"
WITHOUT_AXES = "the device sends one rate: yaw is right while this axis is vertical"


@dataclass(slots=True)
class RateWatch:
    """Reports `rate_hangs` and `rate_moves`.

    Zeros do not count: some devices send zero at rest. Sensors with steps coarser than FINE_DPS do not count: they
    repeat values at rest.

    hung_s
        Total time of reported hangs, s.
    """

    tell: Tell
    hung_s: float = 0.0
    _rate_dps: float = nan
    _since_s: float = 0.0
    _repeats: int = 0
    _longest: int = 0
    _changes: int = 0
    _finest_dps: float = inf
    _is_reported: bool = False

    def take(self, samples: list[Sample]) -> None:
        """Examine new samples."""
        for sample in samples:
            if sample.rate_dps == self._rate_dps:
                self._repeats += 1
            else:
                self._change(sample)
        if samples and self._repeats >= HANGS_SAMPLES and not self._is_reported:
            self._judge(samples[-1].t_device_s - self._since_s)

    def _change(self, sample: Sample) -> None:
        step_dps = abs(sample.rate_dps - self._rate_dps)
        if self._is_reported:
            self._is_reported = False
            seconds = sample.t_device_s - self._since_s
            self.hung_s += seconds
            self.tell("rate_moves", rate_dps=self._rate_dps, seconds=round(seconds, 3))
        else:
            self._longest = max(self._longest, self._repeats)
        self._finest_dps = min(self._finest_dps, step_dps)
        self._changes += 1
        self._rate_dps, self._since_s, self._repeats = sample.rate_dps, sample.t_device_s, 0

    def _judge(self, seconds: float) -> None:
        is_noisy = self._changes >= LEAST_CHANGES and self._finest_dps <= FINE_DPS
        if is_noisy and self._rate_dps != 0.0 and seconds >= HANGS_S and self._repeats > LONGER * self._longest:
            self._is_reported = True
            hint = "the sensor repeats one value although it has noise; yaw is not reliable"
            self.tell("rate_hangs", rate_dps=self._rate_dps, seconds=round(seconds, 3), hint=hint)


@dataclass(slots=True)
class PaceWatch:
    """Reports `clock_unit_differs` once, until the clock is right again. The link checks the first seconds itself."""

    tell: Tell
    _first: Sample | None = None
    _samples: int = 0
    _windows: int = 0

    def take(self, samples: list[Sample]) -> None:
        """Examine new samples."""
        if not samples:
            return
        first, last = self._first, samples[-1]
        if first is None or last.t_host_s < first.t_host_s or last.t_device_s <= first.t_device_s:
            self._first, self._samples = last, 0
            return
        self._samples += len(samples)
        if last.t_host_s - first.t_host_s >= PACE_S and self._samples >= PACE_SAMPLES:
            self._judge((last.t_host_s - first.t_host_s) / (last.t_device_s - first.t_device_s))
            self._first, self._samples = last, 0

    def _judge(self, pace: float) -> None:
        self._windows = self._windows + 1 if pace >= SLOWEST_PACE else 0
        if self._windows == PACE_WINDOWS:
            reason = f"a second of the device clock takes {pace:.3g} s: its unit has changed"
            self.tell("clock_unit_differs", reason=reason, hint="yaw hardly changes until the device is repaired")


@dataclass(slots=True)
class AxesWatch:
    """Reports `accelerations_missing` and `accelerations_back`, `axes_missing` and `axes_back`.

    Three zeros are no acceleration: a sensor has noise. A device that never sent three rates has one axis.
    """

    tell: Tell
    _axes_s: float = nan
    _accel_s: float = nan
    _has_axes: bool = True
    _has_accel: bool = True

    def take(self, samples: list[Sample]) -> None:
        """Examine new samples."""
        for sample in samples:
            if sample.inertial is not None:
                self._take_axes(sample.t_device_s, hypot(*sample.inertial[3:]) > 0.0)
            elif self._has_axes and sample.t_device_s - self._axes_s > LOST_S:
                self._has_axes = False
                self.tell("axes_missing", seconds=round(sample.t_device_s - self._axes_s, 3), hint=WITHOUT_AXES)

    def _take_axes(self, t_s: float, has_accel: bool) -> None:  # noqa: FBT001 - of the sample
        if not self._has_axes:
            self._has_axes = True
            self.tell("axes_back", seconds=round(t_s - self._axes_s, 3))
            self._accel_s = t_s
        if has_accel or self._axes_s != self._axes_s:  # or NaN, before the first sample
            if not self._has_accel:
                self._has_accel = True
                self.tell("accelerations_back", seconds=round(t_s - self._accel_s, 3))
            self._accel_s = t_s
        elif self._has_accel and t_s - self._accel_s > LOST_S:
            self._has_accel = False
            self.tell("accelerations_missing", seconds=round(t_s - self._accel_s, 3), hint=WITHOUT_ACCELERATIONS)
        self._axes_s = t_s


@dataclass(slots=True)
class StreamWatch:
    """Watches the rate, the axes and the clock."""

    tell: Tell
    _axes: AxesWatch = field(init=False)
    _rate: RateWatch = field(init=False)
    _pace: PaceWatch = field(init=False)

    def __post_init__(self) -> None:
        self._rate, self._pace, self._axes = RateWatch(self.tell), PaceWatch(self.tell), AxesWatch(self.tell)

    def take(self, samples: list[Sample]) -> None:
        """Examine new samples."""
        self._rate.take(samples)
        self._pace.take(samples)
        self._axes.take(samples)

    def stats(self) -> dict[str, Any]:
        """Fields for the log; empty without a hang."""
        return {"hung_s": round(self._rate.hung_s, 3)} if self._rate.hung_s else {}
