"""Warnings about a stream without gaps: readings that are none, a device clock that changes its unit, and missing axes.

The clock is a guess, so its samples are still processed; the warning says that yaw is not reliable. A device of
three axes may stop sending its accelerations, or two of its rates. Yaw goes on by fewer measurements.
"""

from dataclasses import dataclass, field
from math import hypot, nan
from typing import Any

from gyrodrift.columns.readings import ReadingJudge, StreamJudge, Tell
from gyrodrift.filters.run import WITHOUT_AXES_S as LOST_S
from gyrodrift.link.options import LinkCounters
from gyrodrift.link.unit_check import SLOWEST_PACE
from gyrodrift.values.sample import Sample

PACE_S, PACE_SAMPLES = 2.0, 10
PACE_WINDOWS = 2
"""Windows of host time in which a clock is compared. Two in a row must differ: in one the device may have slept, or the
clock of the host may have been set."""

WITHOUT_ACCELERATIONS = "the device sends three rates without accelerations: the tilt is by the gyro, or unknown"
WITHOUT_AXES = "the device sends one rate: yaw is right while this axis is vertical"


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
    """Watches the readings, the axes and the clock.

    counters
        Counters of the link, which get the impossible, the clipped and the unmeasured samples.
    """

    tell: Tell
    counters: LinkCounters
    _judge: StreamJudge = field(init=False)
    _axes: AxesWatch = field(init=False)
    _pace: PaceWatch = field(init=False)

    def __post_init__(self) -> None:
        self._judge = StreamJudge(ReadingJudge(self.tell))
        self._pace, self._axes = PaceWatch(self.tell), AxesWatch(self.tell)

    def take(self, samples: list[Sample]) -> list[Sample]:
        """Examine new samples; those that are decided, without the rates that are no measurement."""
        self._pace.take(samples)
        self._axes.take(samples)
        judged, judge = self._judge.take(samples), self._judge.judge
        self.counters.impossible, self.counters.clipped = judge.impossible, judge.clipped
        self.counters.unmeasured = self._judge.missing
        return judged

    def stats(self) -> dict[str, Any]:
        """Fields for the log; empty without a hang."""
        hung_s = self._judge.judge.hung_s
        return {"hung_s": round(hung_s, 3)} if hung_s else {}
