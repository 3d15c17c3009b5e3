"""The last samples of a filter, to filter them again after a change of its parameters.

A filter that weighs several explanations of the past cannot use new parameters for a past that it has already judged.
So the samples since the zero of yaw are kept, with the state before the first of them. A second run of the filter takes
them in steps that delay no sample. Memory is bounded: two parts are kept, each with the state at its beginning.
"""

from array import array
from copy import copy, deepcopy
from dataclasses import dataclass, field
from math import inf, isfinite
from typing import Any

from gyrodrift.filters.filter import Filter
from gyrodrift.filters.run import FilterRun
from gyrodrift.values.aid import Aid
from gyrodrift.values.sample import Inertial, Sample

PART_SAMPLES = 50_000
"""Samples of a part. Chosen: 8 minutes at 100 Hz in 1.6 MB, or in 4 MB with three axes; one to two are kept."""

STEPS_AT_ONCE = 2000
"""Samples that a second run takes at once. Chosen: about 10 ms, less than what any receive buffer holds."""

NO_AXES = (inf,) * 6
"""Inertial values of a sample without them; a filter accepts no infinite rate."""


@dataclass(slots=True)
class HistoryPart:
    """Accepted samples from a known state of the filter on.

    beginning
        The run before the first sample, with a state of its own.
    times
        Device time, rate, rest by a sensor and temperature of each sample: s, deg/s, 1 or 0 or NaN, °C.
    inertials
        Three rates and three accelerations of each sample; empty if no sample has them.
    aids
        Measurements of second sources by the index of their sample.
    following
        The part after this one; None for the newest.
    """

    beginning: FilterRun
    has_axes: bool
    times: "array[float]" = field(default_factory=lambda: array("d"))
    inertials: "array[float]" = field(default_factory=lambda: array("d"))
    aids: dict[int, tuple[Aid, ...]] = field(default_factory=dict)
    following: "HistoryPart | None" = None

    def __len__(self) -> int:
        return len(self.times) // 4

    def keep(self, sample: Sample) -> None:
        """Append a sample."""
        if sample.aids:
            self.aids[len(self)] = sample.aids
        self.times.extend((sample.t_device_s, sample.rate_dps, sample.still, sample.temp_c))
        if self.has_axes:
            self.inertials.extend(sample.inertial or NO_AXES)

    def step(self, run: FilterRun, index: int) -> None:
        """Let a run take the sample at an index."""
        t_s, rate_dps, still, temp_c = self.times[4 * index : 4 * index + 4]
        inertial = Inertial(*self.inertials[6 * index : 6 * index + 6]) if self.has_axes else None
        run.step(t_s, rate_dps, inertial if inertial and isfinite(inertial.gyro_x_dps) else None, still, temp_c)
        for aid in self.aids.get(index, ()):
            run.aid(aid)


class History:
    """The last one or two parts of samples."""

    def __init__(self) -> None:
        self.oldest: HistoryPart | None = None
        self._newest: HistoryPart | None = None

    def forget(self) -> None:
        """Begin again with the next sample: yaw was set, or the samples before differ from later ones."""
        self.oldest = self._newest = None

    def expect(self, run: FilterRun, sample: Sample) -> HistoryPart:
        """The part for the next sample; a new one begins with the present state of the run."""
        newest = self._newest
        has_axes = sample.inertial is not None or (newest is not None and newest.has_axes)
        if newest is None or len(newest) >= PART_SAMPLES or has_axes > newest.has_axes:
            before = copy(run)
            before.state, before.watch = deepcopy(run.state), deepcopy(run.watch)
            self._newest = HistoryPart(before, has_axes)
            if newest is not None:
                newest.following, self.oldest = self._newest, newest
            else:
                self.oldest = self._newest
            newest = self._newest
        return newest


class SecondRun:
    """A run of a filter over the history, which catches up with the first run.

    run
        The run, which may replace the first one once `catch_up` says so.
    is_other
        Whether it runs another filter than the one that the history begins with.
    begun_s
        Device time of its first sample, s.
    """

    def __init__(self, part: HistoryPart, chosen: Filter, params: Any, axes_params: Any) -> None:
        before = part.beginning
        self.run = FilterRun(chosen, params, before.axes, before.mount)
        self.is_other = chosen is not before.filter
        if not self.is_other:
            self.run.state, self.run.watch = deepcopy(before.state), deepcopy(before.watch)
            self.run.three_axes = before.three_axes
        else:
            self.run.state.yaw_deg = before.state.yaw_deg
        self.run.use(params, axes_params)
        self._part, self._index = part, 0
        self.begun_s = part.times[0] if part.times else inf

    def catch_up(self, steps: int) -> bool:
        """Take the next samples; whether the run has taken all of them."""
        for _ in range(steps):
            while self._index == len(self._part):
                if self._part.following is None:
                    return True
                self._part, self._index = self._part.following, 0
            self._part.step(self.run, self._index)
            self._index += 1
        return False
