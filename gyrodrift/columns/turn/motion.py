"""Behavior of a column in a turn between two rests: a rate returns to its level, an angle stays at another one.

All thresholds are relative to the noise of the rest before the turn.
"""

from dataclasses import dataclass
from enum import StrEnum
from math import pi, sqrt

import numpy as np

from gyrodrift.columns.turn.series import Series
from gyrodrift.values.arrays import Floats, Mask

REACTION_S = 0.2
"""Time before the prompt at which a hand may begin already, s."""

AFTER_S = 1.0
REST_VALUES_MIN, MOVING_VALUES_MIN, SLOW_VALUES_MIN = 4, 4, 2
"""Smallest numbers of values of a rest, of a motion, and of the rest at the end for a slow device."""

CLEAR = 12.0
"""Standard deviations of the rest that a motion exceeds; noise alone does so once in 10^32 values."""

RETURNED, ONE_SIDED, MOVING = 0.1, 0.6, 0.1
"""A rate returns to within the first share of its largest deviation.

The second is the share of its motion in one direction. Deviations above the third share of the largest
one count as motion.
"""

FEW_STEPS = 0.02
"""Largest resolution, as a share of the range: a column with two values only has not shown its resolution."""

OVERSHOOT = 0.25
GROWS = 0.5
SPIKE = 1.5
MOVING_MIN_S = 0.15
"""Shortest quarter turn by hand, s."""


class Behavior(StrEnum):
    """Behavior of a column in the turn."""

    QUIET = "does not change"
    GROWS = "always grows, like a clock"
    RETURNS = "moves and returns"
    RATE = "moves one way and returns, like a rate"
    STAYS = "moves to another level and stays, like an angle"
    RESTLESS = "does not come to rest"


@dataclass(frozen=True, slots=True)
class TurnWindow:
    """Times of the turn: a rest from `begin_s`, the turn from `turn_s`, a rest before `end_s`."""

    begin_s: float
    turn_s: float
    end_s: float


@dataclass(frozen=True, slots=True, eq=False)
class ColumnMotion:
    """A column in the turn, in its own units.

    level, noise
        Median and standard deviation of the rest before the turn; the noise includes the resolution.
    clearness
        Largest deviation from the level over the noise.
    integral
        Integral of the deviation over time, units times s.
    change
        Level after the turn minus level before it.
    last_s
        Time of the last motion, s.
    t_s, deviation
        Times and deviations from the beginning of the turn, both of shape (n,).
    """

    series: Series
    behavior: Behavior
    level: float = 0.0
    noise: float = 0.0
    clearness: float = 0.0
    integral: float = 0.0
    change: float = 0.0
    last_s: float = 0.0
    t_s: Floats | None = None
    deviation: Floats | None = None


def motion_of(series: Series, window: TurnWindow, values: Floats | None = None) -> ColumnMotion:
    """Motion of a column; `values` replace its own, for unwrapped angles."""
    t_s = series.t_s
    y = without_spikes(series.values if values is None else values)
    before = (t_s >= window.begin_s) & (t_s < window.turn_s - REACTION_S)
    during = (t_s >= window.turn_s - REACTION_S) & (t_s <= window.end_s)
    if before.sum() < REST_VALUES_MIN or during.sum() < MOVING_VALUES_MIN:
        return ColumnMotion(series, Behavior.QUIET)
    after = during & (t_s > window.end_s - AFTER_S)
    if after.sum() < SLOW_VALUES_MIN:
        after = during & (t_s >= t_s[during][-SLOW_VALUES_MIN])
    slope = _slope(t_s[before], y[before])
    level, noise = float(np.median(y[before])), _noise(y, y[before] - slope * (t_s[before] - t_s[before][0]))
    if not noise > 0.0:
        return ColumnMotion(series, Behavior.QUIET, level)
    change = float(np.median(y[after])) - level
    grown = slope * float(t_s[after].mean() - t_s[before].mean())
    deviation = y[during] - level
    largest = float(np.abs(deviation).max())
    moving = np.abs(deviation) > max(MOVING * largest, CLEAR * noise)
    return ColumnMotion(
        series,
        _behavior_of(t_s[during], deviation, moving, y[after] - level, change=change, grown=grown, noise=noise),
        level=level,
        noise=noise,
        clearness=largest / noise,
        integral=float(np.trapezoid(deviation, t_s[during])),
        change=change,
        last_s=float(t_s[during][moving][-1]) if moving.any() else window.turn_s,
        t_s=t_s[during],
        deviation=deviation,
    )


def _behavior_of(
    t_s: Floats, deviation: Floats, moving: Mask, after: Floats, *, change: float, grown: float, noise: float
) -> Behavior:
    largest = float(np.abs(deviation).max())
    if largest < CLEAR * noise:
        return Behavior.QUIET
    if abs(change) > CLEAR * noise and abs(grown) > GROWS * abs(change) and grown * change > 0.0:
        return Behavior.GROWS
    if float(np.ptp(after)) > max(RETURNED * largest, CLEAR * noise):
        return Behavior.RESTLESS
    if abs(change) > max(RETURNED * largest, CLEAR * noise):
        outside = max(
            float((deviation * np.sign(change)).max()) - abs(change), float(-(deviation * np.sign(change)).min())
        )
        return Behavior.STAYS if outside < OVERSHOOT * abs(change) else Behavior.RESTLESS
    moved = np.where(moving, deviation, 0.0)
    whole = float(np.trapezoid(np.abs(moved), t_s))
    is_enough = moving.sum() >= MOVING_VALUES_MIN and float(np.ptp(t_s[moving])) >= MOVING_MIN_S
    is_one_way = whole > 0.0 and abs(float(np.trapezoid(moved, t_s))) > ONE_SIDED * whole
    return Behavior.RATE if is_enough and is_one_way else Behavior.RETURNS


def without_spikes(values: Floats) -> Floats:
    """Values without single spikes that exceed the range of all neighbors: damaged lines."""
    if len(values) < REST_VALUES_MIN:
        return values
    padded = np.concatenate([values[:1], values, values[-1:]])
    middle = np.median(np.stack([padded[:-2], padded[1:-1], padded[2:]]), axis=0)
    is_spike = np.abs(values - middle) > SPIKE * max(float(np.ptp(middle)), 1e-300)
    cleaned: Floats = np.where(is_spike & (np.ptp(middle) > 0.0), middle, values)
    return cleaned


def unwrapped(values: Floats, period: float) -> Floats:
    """Angle without jumps; the values themselves if they exceed the period."""
    if np.abs(values).max(initial=0.0) > 1.01 * period:
        return values
    angles: Floats = np.unwrap(values, period=period)
    return angles


def _slope(t_s: Floats, values: Floats) -> float:
    """Slope of a least-squares line; 0 if all times are equal."""
    from_middle_s = t_s - t_s.mean()
    spread = float(from_middle_s @ from_middle_s)
    return float(from_middle_s @ (values - values.mean())) / spread if spread > 0.0 else 0.0


def _noise(values: Floats, at_rest: Floats) -> float:
    """Standard deviation of a rest, at least that of the rounding; 0 if the values never change.

    It uses the mean absolute deviation: outliers count less than in squares, and whole numbers give no steps, as they
    do in a median.
    """
    steps = np.abs(np.diff(values))
    resolution = float(steps.min(initial=np.inf, where=steps > 0.0))
    if not np.isfinite(resolution):
        return 0.0
    scatter = sqrt(0.5 * pi) * float(np.mean(np.abs(at_rest - np.median(at_rest))))
    return max(scatter, min(resolution, FEW_STEPS * float(np.ptp(values))) / sqrt(12.0))
