"""What is odd in a stream that arrives whole: a rate that hangs, and a clock that begins to count something else.

Samples are handed on all the same, since both are guesses; they are told, so that nobody relies on yaw meanwhile.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from math import inf, nan
from typing import Any

from gyrodrift.filters.restlevel.noise import FINE_DPS
from gyrodrift.link.units.clock_unit import SLOWEST_PACE
from gyrodrift.sample import Sample

Tell = Callable[..., Any]
"""Called with the name of an event and its fields."""

LEAST_CHANGES = 200
"""Of the rate, before it is known that it has noise."""

HANGS_SAMPLES, HANGS_S = 50, 1.0
LONGER = 10
"""A rate hangs that is the same for so many samples and for so long, and ten times as often as ever before."""

PACE_S, PACE_SAMPLES = 2.0, 10
PACE_WINDOWS = 2
"""A clock is judged over so much of the host's time, and by two such windows in a row: in one of them the device may
have slept, or the host's clock may have been set."""


@dataclass(slots=True)
class RateWatch:
    """Tells `rate_hangs` and `rate_moves`. Zeros are no sign: some devices say zero at rest.

    Nor is anything that a part of coarser steps than FINE_DPS repeats, which may stand still between two of them.

    hung_s
        How long rates have hung in all, s, as far as it was told.
    """

    tell: Tell
    hung_s: float = 0.0
    _rate_dps: float = nan
    _since_s: float = 0.0
    _alike: int = 0
    _longest: int = 0
    _changes: int = 0
    _finest_dps: float = inf
    _is_told: bool = False

    def take(self, samples: list[Sample]) -> None:
        """Look at the samples of a turn."""
        for sample in samples:
            if sample.rate_dps == self._rate_dps:
                self._alike += 1
            else:
                self._change(sample)
        if samples and self._alike >= HANGS_SAMPLES and not self._is_told:
            self._judge(samples[-1].t_device_s - self._since_s)

    def _change(self, sample: Sample) -> None:
        step_dps = abs(sample.rate_dps - self._rate_dps)
        if self._is_told:
            self._is_told = False
            seconds = sample.t_device_s - self._since_s
            self.hung_s += seconds
            self.tell("rate_moves", rate_dps=self._rate_dps, seconds=round(seconds, 3))
        else:
            self._longest = max(self._longest, self._alike)
        self._finest_dps = min(self._finest_dps, step_dps)
        self._changes += 1
        self._rate_dps, self._since_s, self._alike = sample.rate_dps, sample.t_device_s, 0

    def _judge(self, seconds: float) -> None:
        is_noisy = self._changes >= LEAST_CHANGES and self._finest_dps <= FINE_DPS
        if is_noisy and self._rate_dps != 0.0 and seconds >= HANGS_S and self._alike > LONGER * self._longest:
            self._is_told = True
            hint = "the sensor repeats one value though it has noise: yaw is not to be relied on"
            self.tell("rate_hangs", rate_dps=self._rate_dps, seconds=round(seconds, 3), hint=hint)


@dataclass(slots=True)
class PaceWatch:
    """Tells `clock_unit_differs`, once until the clock is right again; in the first seconds the link refuses such."""

    tell: Tell
    _first: Sample | None = None
    _samples: int = 0
    _windows: int = 0

    def take(self, samples: list[Sample]) -> None:
        """Look at the samples of a turn."""
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
            reason = f"a second of the device clock takes {pace:.3g} s: it counts something else than before"
            self.tell(
                "clock_unit_differs", reason=reason, hint="yaw all but stands still until the device is put right"
            )


@dataclass(slots=True)
class StreamWatch:
    """Both, as the service has them."""

    tell: Tell
    _rate: RateWatch = field(init=False)
    _pace: PaceWatch = field(init=False)

    def __post_init__(self) -> None:
        self._rate, self._pace = RateWatch(self.tell), PaceWatch(self.tell)

    def take(self, samples: list[Sample]) -> None:
        """Look at the samples of a turn."""
        self._rate.take(samples)
        self._pace.take(samples)

    def stats(self) -> dict[str, Any]:
        """For the log; nothing while nothing was odd."""
        return {"hung_s": round(self._rate.hung_s, 3)} if self._rate.hung_s else {}
