"""Shape of lines without a header, `t_us, rate[, encoder[, temp[, still]]]`: what contradicts it, as values come.

Two to ten numbers may mean anything. The first lines show a clock; whether the second number is a rate shows when the
device turns. A rate returns to its level and has noise, an angle stays at another level, and wraps. Noise, in
which gyros differ, never decides alone: a fiber-optic gyro, or a turntable that spins for minutes, contradicts nothing.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from math import hypot, inf, isfinite, isnan, nan, pi, sqrt
from operator import mul
from statistics import fmean, median, pstdev

from gyrodrift.columns.sizes import TEMPERATURES_C, is_gravity
from gyrodrift.values.constants import CLOCK_MASK, FULL_TURN_DEG
from gyrodrift.values.sample import Reading, Sample

MOST_DPS = 4400.0
"""Largest range of cheap gyros and 10 %, as in `rate_unit`; a column that stays above is no rate."""

JUDGED_LINES, JUDGED_S = 10, 1.0
"""Number of lines for a judgment, or their time for slow devices, s."""

ODD_SHARE = 0.1
"""Largest share of steps in which a clock stands still or goes back; other numbers have at least half.

A device may repeat a line or restart.
"""

ENCODER_STEPS = 3.0
"""Largest difference of an angle and its integrated rate, in steps; rounding causes less than two."""

ENCODER_SHARE = 0.5
"""Largest part of the angle that the rate does not explain; for another quantity it is nearly all."""

WINDOW_S, WINDOW_SAMPLES = 0.5, 10
"""Least length of a window: a turn by hand fills several, and a scatter needs some samples."""

WRAPS = (FULL_TURN_DEG, 2.0 * pi)
"""Ranges of an angle that wraps, deg and rad."""

STEEP = 0.2
"""Largest step of an angle around a jump, as a share of half a turn: larger ones are a sawtooth."""

WRAP_STEPS = 4
"""Steps on each side of a jump that must go on in one direction; the noise of a rate does so once in 2^8 times."""

FROZEN = 0.005
"""Scatter below that of any cheap gyro (0.03 deg/s), in the unit of the column."""

FROZEN_STEP = 0.02
"""Largest resolution that can show such a scatter."""

REPEATS, SMOOTH = 0.5, 1.2
"""Share of repeated values, or scatter over that of the steps, of values that hardly change; white noise has 0.7."""

MOVE_MIN, MOVE_WITHIN_S = 0.5, 15.0
"""Least change from a level to the next, and its longest time; a drift is slower."""

HELD_WINDOWS = 4
"""Windows of two seconds at a new level: nobody turns a device evenly to a hundredth of a deg/s for that long."""

WHOLE_DISTINCT = 8
"""Distinct whole numbers from which on they are counts, degrees or another quantity."""

PATH_DEG, MOVED_DEG, MOVED_WINDOWS = 30.0, 3.0, 5
"""Path of an angle that shows whether it belongs to a rate, and number of windows with at least MOVED_DEG of it."""

FOLLOWS, UNLIKE = 0.9, 0.5
"""Correlation of an angle with its rate over windows; of other quantities it is below the second."""

DERIVES = 0.98
"""Correlation of an angle with the integral of its own rate; a rate beside an angle reaches 0.95 in short motions."""

SAME_SCALE = 2.0
"""Factor within which the integral of a rate in deg/s is the angle, although a steady spin has no correlation."""

OUTLIER = 5.0
"""Windows that exceed the usual motion by this factor hold a jump: a counter that wraps."""

WARMS_C = 5.0
"""Largest change of a temperature from one window to the next, °C."""

AT_LEVEL_DPS = 20.0
"""A rate at rest is within this of 0: data sheets state ±1 to ±20 deg/s."""

AWAY_S = 30.0
"""Time away from 0 after which the user is told."""

DRIFT_DPS, LEVEL_NOISES = 5.0, 6.0
"""Largest change of a bias during a recording, deg/s, or in multiples of the noise; data sheets state less than 5."""

RETURNS = 3
"""Returns to the level of rest that prove a rate: an angle that turns back does so once or twice."""

SMOOTH_STEPS, SMOOTH_SHARE = 20, 0.1
"""Steps that show whether a column is smooth, and the share of changes of direction below which it is.

White noise changes it at two of three steps.
"""

WINDOWS_MAX = 600
"""Number of windows that are kept: five minutes."""


def has_csv_shape(readings: Sequence[Reading]) -> bool:
    """Whether the first lines can be those of csv: a growing clock, a temperature, an angle that follows the rate.

    Without a header, two to five numbers with commas may also be raw counts, three axes, or an angle.
    """
    times_us = [reading.t_us or 0 for reading in readings]
    steps_us = [(after - before) & CLOCK_MASK for before, after in pairwise(times_us)]
    forward_us = [step_us for step_us in steps_us if 0 < step_us < CLOCK_MASK // 2]
    is_enough = len(readings) >= JUDGED_LINES or sum(forward_us) >= JUDGED_S * 1e6
    is_clock = len(steps_us) - len(forward_us) <= max(1.0, ODD_SHARE * len(steps_us))
    is_warm = all(TEMPERATURES_C[0] <= r.temp_c <= TEMPERATURES_C[1] for r in readings if not isnan(r.temp_c))
    return is_enough and is_clock and is_warm and _follows_rate(readings) and _feels_gravity(readings)


def _feels_gravity(readings: Sequence[Reading]) -> bool:
    """Whether accelerations have the length of gravity; True without any, or while all are NaN."""
    sizes = [hypot(*reading.inertial[3:]) for reading in readings if reading.inertial]
    lengths = [size for size in sizes if not isnan(size)]
    return not lengths or is_gravity(median(lengths))


def _follows_rate(readings: Sequence[Reading]) -> bool:
    """Whether the encoder follows the integrated rate, at any scale; True without an encoder."""
    valid = [reading for reading in readings if not isnan(reading.encoder_deg) and isfinite(reading.rate_dps)]
    moved = [after.encoder_deg - before.encoder_deg for before, after in pairwise(valid)]
    turns = [
        0.5e-6 * (after.rate_dps + before.rate_dps) * (((after.t_us or 0) - (before.t_us or 0)) & CLOCK_MASK)
        for before, after in pairwise(valid)
    ]
    step_deg = min((abs(step) for step in moved if step), default=0.0)
    if not step_deg:
        return True
    squares = sum(angle * angle for angle in turns)
    scale = sum(a * b for a, b in zip(moved, turns, strict=True)) / squares if squares else 0.0
    apart = sorted(abs(a - scale * b) for a, b in zip(moved, turns, strict=True))
    usual = sorted(map(abs, moved))[len(moved) // 2]
    return apart[len(apart) // 2] <= max(ENCODER_STEPS * step_deg, ENCODER_SHARE * usual)


@dataclass(slots=True)
class _Values:
    """One column that is taken for a rate: jumps of an angle that wraps, and levels that do not return."""

    name: str
    unit: str = ""
    _tail: list[float] = field(default_factory=list)
    _step: float = inf
    _level: float | None = None
    _moved_s: float = nan
    _still_windows: int = 0
    _last: float = nan

    def wraps(self, values: Sequence[float]) -> str:
        """Contradiction by a jump from one end of a circle to the other, amid steady motion; empty without."""
        joined = [*self._tail, *values]
        steps = [after - before for before, after in pairwise(joined)]
        self._tail = joined[-2 * WRAP_STEPS - 1 :]
        for index in range(WRAP_STEPS, len(steps) - WRAP_STEPS):
            jump = steps[index]
            if abs(jump) < WRAPS[1] - 1.0:
                continue
            around = [*steps[index - WRAP_STEPS : index], *steps[index + 1 : index + 1 + WRAP_STEPS]]
            if _is_steady([-step if jump > 0.0 else step for step in around]):
                largest = max(map(abs, around))
                ends = (joined[index], joined[index + 1])
                period = next((period for period in WRAPS if _is_wrap(ends, period, largest)), 0.0)
                if period:
                    self.unit = "deg" if period == FULL_TURN_DEG else "rad"
                    return f"{self.name} wraps from {ends[0]:g} to {ends[1]:g} like an angle, which no rate does"
        return ""

    def stays(self, t_s: float, values: Sequence[float]) -> str:
        """Contradiction by a level that the column reaches by a motion and holds without noise; empty without."""
        steps = [after - before for before, after in pairwise(values)]
        self._step = min([self._step, *(abs(step) for step in steps if step)])
        level, before = median(values), self._last
        self._last = level
        if not self._is_frozen(values, steps):
            self._still_windows = 0
            self._moved_s = t_s
            return ""
        if self._level is None:
            self._level = level
        if abs(level - before) > FROZEN * HELD_WINDOWS:
            self._moved_s = t_s
        is_new = abs(level - self._level) > MOVE_MIN and t_s - self._moved_s < MOVE_WITHIN_S
        self._still_windows = self._still_windows + 1 if is_new else 0
        if self._still_windows < HELD_WINDOWS:
            if not is_new:
                self._level = level
            return ""
        return (
            f"{self.name} was {self._level:.4g} at rest and stays at {level:.4g} after a motion, with less noise than a"
            " gyro has in deg/s: an angle, or another quantity or unit"
        )

    def _is_frozen(self, values: Sequence[float], steps: Sequence[float]) -> bool:
        scatter = pstdev(values)
        if scatter > FROZEN or FROZEN_STEP < self._step < inf:
            return False
        walk = sqrt(fmean(step * step for step in steps))
        return steps.count(0.0) >= REPEATS * len(steps) or scatter > SMOOTH * walk


def _is_steady(steps: Sequence[float]) -> bool:
    """Whether all steps go forward, hardly any of them by 0."""
    forward = [[step > 0.0 for step in side] for side in (steps[:WRAP_STEPS], steps[WRAP_STEPS:])]
    return min(steps) >= 0.0 and all(sum(side) >= WRAP_STEPS - 1 for side in forward)


def _is_wrap(ends: tuple[float, float], period: float, largest: float) -> bool:
    """Whether both ends are those of a circle, up to a step or two."""
    before, after = ends
    near = 2.0 * largest
    is_whole = abs(abs(after - before) - period) <= near < STEEP * period
    limits = (0.5 * period, period, 0.0)
    return is_whole and all(min(abs(abs(end) - limit) for limit in limits) <= near for end in ends)


@dataclass(frozen=True, slots=True)
class _Window:
    """Motion in a window: integral of column 2, its change, and integral and change of column 3."""

    rate_sum: float
    rate_change: float
    encoder_sum: float
    encoder_change: float


class RateShape:
    """Judges samples until `is_over`: the encoder proves the rate, or it has returned from turns.

    `contradiction` says why the column is no rate, `is_impossible` whether no gyro at all does so; `doubt` is something
    that only the user can decide, and is told once.
    """

    def __init__(self) -> None:
        self.is_over = False
        self.contradiction = self.doubt = ""
        self.is_impossible = False
        self._pending: list[Sample] = []
        self._columns: list[_Values] = []
        self._windows: list[_Window] = []
        self._distinct: set[float] = set()
        self._is_whole = True
        self._temp_c = nan
        self._near_s = nan
        self._noise = inf
        self._rest = self._last = nan
        self._was_near = self._away = False
        self._returns = 0
        self._steps = self._bends = 0

    def take(self, samples: Sequence[Sample]) -> None:
        """Add samples in their order."""
        for sample in samples:
            if isfinite(sample.rate_dps):
                self._pending.append(sample)
        while not (self.is_over or self.contradiction):
            size = self._window_size()
            if not size:
                return
            window, self._pending = self._pending[:size], self._pending[size:]
            self._judge(window)

    @property
    def is_smooth(self) -> bool:
        """Whether the column moves and goes on in its direction nearly always: a rate has noise, an angle has none."""
        return not self.is_over and self._steps >= SMOOTH_STEPS and self._bends < SMOOTH_SHARE * self._steps

    def _window_size(self) -> int:
        pending = self._pending
        if len(pending) < WINDOW_SAMPLES or pending[-1].t_device_s - pending[0].t_device_s < WINDOW_S:
            return 0
        first_s = pending[0].t_device_s
        size = WINDOW_SAMPLES
        while size < len(pending) and pending[size - 1].t_device_s - first_s < WINDOW_S:
            size += 1
        return size

    def _judge(self, window: Sequence[Sample]) -> None:
        rates = [sample.rate_dps for sample in window]
        steps = [after - before for before, after in pairwise(rates) if after != before]
        self._steps += len(steps)
        self._bends += sum(before * after < 0.0 for before, after in pairwise(steps))
        axes = list(zip(*(sample.inertial[:3] for sample in window if sample.inertial), strict=True)) or [rates]
        if not self._columns:
            names = ("column 2",) if len(axes) == 1 else ("column 2", "column 3", "column 4")
            self._columns = [_Values(name) for name in names]
        if len(axes) != len(self._columns):
            return
        self.contradiction = next(filter(None, (c.wraps(v) for c, v in zip(self._columns, axes, strict=True))), "")
        self.is_impossible = bool(self.contradiction)
        self.contradiction = self.contradiction or next(filter(None, self._checks(window, rates, axes)), "")
        if not self.contradiction and len(axes) == 1:
            self._notice_rest(window[-1].t_device_s, rates)

    def _checks(
        self, window: Sequence[Sample], rates: Sequence[float], axes: Sequence[Sequence[float]]
    ) -> Iterator[str]:
        level, t_s = median(rates), window[-1].t_device_s
        if abs(level) > MOST_DPS:
            yield f"column 2 is {level:.5g}: no cheap gyro measures that many deg/s"
        yield self._temperature(window)
        encoder = self._encoder(window, rates) if len(axes) == 1 else None
        if encoder is not None:
            yield encoder
        if encoder == "":  # an encoder that has not moved yet proves nothing
            return
        stays = [column.stays(t_s, values) for column, values in zip(self._columns, axes, strict=True)]
        yield from stays
        self._is_whole = self._is_whole and all(rate == round(rate) for rate in rates)
        if self._is_whole:
            self._distinct.update(rates)
            if len(self._distinct) >= WHOLE_DISTINCT:
                yield "column 2 holds whole numbers: counts of a sensor, or no rate at all"

    def _temperature(self, window: Sequence[Sample]) -> str:
        temps = [sample.temp_c for sample in window if not isnan(sample.temp_c)]
        if not temps:
            return ""
        before, self._temp_c = self._temp_c, median(temps)
        is_cold = not TEMPERATURES_C[0] <= self._temp_c <= TEMPERATURES_C[1]
        if is_cold or abs(self._temp_c - before) > WARMS_C:
            return f"column 4 changes from {before:.4g} to {self._temp_c:.4g}: no temperature does so"
        return ""

    def _encoder(self, window: Sequence[Sample], rates: Sequence[float]) -> str | None:
        """Contradiction by an angle in column 3; empty while it is not known; None without one, or if it stands."""
        angles = [sample.encoder_deg for sample in window]
        if not all(map(isfinite, angles)):
            return None
        times_s = [sample.t_device_s for sample in window]
        self._windows.append(
            _Window(_integral(times_s, rates), _change(rates), _integral(times_s, angles), _change(angles))
        )
        del self._windows[:-WINDOWS_MAX]
        likeness = abs(_likeness([(window.rate_sum, window.encoder_change) for window in self._windows]))
        if likeness > FOLLOWS:
            self.is_over = True
            return ""
        is_unlike = not likeness >= UNLIKE  # or not known
        if is_unlike and _likeness([(window.encoder_sum, window.rate_change) for window in self._windows]) > DERIVES:
            return "column 2 changes as the integral of column 3: an angle and its rate"
        if likeness < UNLIKE:
            return "column 3 turns, and column 2 does not follow it: it is not the rate of this angle"
        sums = [abs(window.rate_sum) for window in self._windows]
        is_turning = sum(sums) - len(sums) * median(sums) > PATH_DEG
        return None if is_turning else ""

    def _notice_rest(self, t_s: float, rates: Sequence[float]) -> None:
        """Count returns to the level of the first rest, and note a level that is far from 0 for long."""
        level, noise = median(rates), pstdev(rates)
        self._noise = min(self._noise, max(noise, FROZEN))
        is_quiet = noise < 3.0 * self._noise
        if is_quiet:
            self._rest, self._last = level if isnan(self._rest) else self._rest, level
        if isnan(self._near_s) or abs(level) < AT_LEVEL_DPS:
            self._near_s = t_s
        self._was_near = self._was_near or abs(level) < AT_LEVEL_DPS
        if abs(level - self._rest) > AT_LEVEL_DPS:
            self._away = True
        elif is_quiet and self._away:
            self._away = False
            self._returns += 1
        self.is_over = self.is_over or self._returns >= RETURNS
        if not self.doubt and t_s - self._near_s > AWAY_S:
            self.doubt = f"column 2 has been away from 0 for {AWAY_S:g} s, and is {level:.4g}"

    @property
    def spec(self) -> str:
        """SPEC of the lines if an angle wraps, which may be yaw; empty otherwise."""
        index, unit = next(((i, c.unit) for i, c in enumerate(self._columns) if c.unit), (0, ""))
        return ", ".join(("t_us", *("_",) * index, f"yaw:{unit}")) if unit else ""

    @property
    def unreturned(self) -> str:
        """Contradiction at the end of a recording, which a turn without an end is, too; empty without one."""
        if self.is_over or self.contradiction or isnan(self._rest):
            return self.contradiction
        if not self._was_near:
            return f"column 2 is never near 0, but {self._rest:.4g}: a rate at rest is"
        if abs(self._last - self._rest) > max(DRIFT_DPS, LEVEL_NOISES * self._noise):
            return (
                f"column 2 is {self._rest:.4g} at the first rest and {self._last:.4g} at the last: a rate returns to"
                " its level"
            )
        return ""


def _integral(times_s: Sequence[float], values: Sequence[float]) -> float:
    return sum(0.5 * (b + a) * (d - c) for (a, b), (c, d) in zip(pairwise(values), pairwise(times_s), strict=True))


def _change(values: Sequence[float]) -> float:
    """Change of a column that may be an angle; single turns of 360 deg are undone."""
    steps = (after - before for before, after in pairwise(values))
    return sum(
        step - FULL_TURN_DEG * (1 if step > 0.0 else -1) if 0.5 < abs(step) / FULL_TURN_DEG <= 1.0 else step
        for step in steps
    )


def _likeness(motions: Sequence[tuple[float, float]]) -> float:
    """Correlation of an integrated rate with the change of an angle; NaN before the angle has turned.

    Its sign tells a rate from the angle of an oscillation, whose acceleration is opposite to it.
    """
    moving = sorted(abs(change) for _, change in motions if abs(change) >= MOVED_DEG)
    if len(moving) < MOVED_WINDOWS or sum(moving) < PATH_DEG:
        return nan
    most = OUTLIER * moving[len(moving) // 2]
    turns, changes = zip(*((turn, change) for turn, change in motions if abs(change) <= most), strict=True)
    scale = abs(sum(map(mul, turns, changes))) / sum(map(mul, changes, changes))
    is_same_scale = 1.0 / SAME_SCALE < scale < SAME_SCALE
    together = _cosine(turns, changes) if is_same_scale else 0.0
    return max(_cosine(_centered(turns), _centered(changes)), together, key=abs)


def _centered(values: Sequence[float]) -> list[float]:
    middle = fmean(values)
    return [value - middle for value in values]


def _cosine(first: Sequence[float], second: Sequence[float]) -> float:
    size = sqrt(sum(map(mul, first, first)) * sum(map(mul, second, second)))
    return sum(map(mul, first, second)) / size if size > 0.0 else 0.0
