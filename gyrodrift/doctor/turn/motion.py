"""How a column behaves in a turn between two rests: it returns to its level, as a rate does, or it stays, as an angle.

The noise of the rest before the turn is the measure of everything: a column that moves by less says nothing.
"""

from dataclasses import dataclass
from enum import StrEnum
from math import pi, sqrt

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.describe.arrays import Flags
from gyrodrift.doctor.turn.series import Series

REACTION_S = 0.2
"""Before the prompt, in which a hand may already begin."""

AFTER_S = 1.0
LEAST_REST, LEAST_MOVING, LEAST_SLOW = 4, 4, 2
"""Values of a rest, and of a motion: fewer say nothing. At the end a slow device may have fewer."""

CLEAR = 12.0
"""Standard deviations of the rest that a motion exceeds; of noise alone one value in 10^32 does."""

RETURNED, ONE_SIDED, MOVING = 0.1, 0.6, 0.1
"""Shares of the largest deviation and of the whole motion: how near its level a rate comes back, how much of its motion
is in one direction, and from where on it counts as moving."""

FEW_STEPS = 0.02
"""Of its range: a column that says two values alone, as slow ones do, has not shown its resolution."""

OVERSHOOT = 0.25
GROWS = 0.5
SPIKE = 1.5
LEAST_MOVING_S = 0.15
"""No hand turns a quarter in less."""


class Behaviour(StrEnum):
    """What a column does in the turn."""

    QUIET = "stays as it is"
    GROWS = "grows all the time, as a clock"
    RETURNS = "moves and returns"
    RATE = "moves one way and returns, as a rate"
    STAYS = "moves to another level and stays, as an angle"
    RESTLESS = "does not come to rest"


@dataclass(frozen=True, slots=True)
class TurnWindow:
    """When the turn was: a rest from `begin_s`, the turn from `turn_s`, a rest again before `end_s`."""

    begin_s: float
    turn_s: float
    end_s: float


@dataclass(frozen=True, slots=True, eq=False)
class ColumnMotion:
    """A column in the turn, in its own units.

    level, noise
        Of the rest before the turn; the noise is at least that of its resolution.
    clearness
        Largest deviation from the level over the noise.
    integral
        Of the deviation over the time, units times s.
    change
        Level after the turn less that before it.
    last_s
        When it moved last.
    t_s, deviation
        From the turn's beginning on, shape (n,) each.
    """

    series: Series
    behaviour: Behaviour
    level: float = 0.0
    noise: float = 0.0
    clearness: float = 0.0
    integral: float = 0.0
    change: float = 0.0
    last_s: float = 0.0
    t_s: Floats | None = None
    deviation: Floats | None = None


def motion_of(series: Series, window: TurnWindow, values: Floats | None = None) -> ColumnMotion:
    """What a column does; `values` takes the place of its own, as where angles are unwrapped."""
    t_s = series.t_s
    y = without_spikes(series.values if values is None else values)
    before = (t_s >= window.begin_s) & (t_s < window.turn_s - REACTION_S)
    during = (t_s >= window.turn_s - REACTION_S) & (t_s <= window.end_s)
    if before.sum() < LEAST_REST or during.sum() < LEAST_MOVING:
        return ColumnMotion(series, Behaviour.QUIET)
    after = during & (t_s > window.end_s - AFTER_S)
    if after.sum() < LEAST_SLOW:
        after = during & (t_s >= t_s[during][-LEAST_SLOW])
    slope = _slope(t_s[before], y[before])
    level, noise = float(np.median(y[before])), _noise(y, y[before] - slope * (t_s[before] - t_s[before][0]))
    if not noise > 0.0:
        return ColumnMotion(series, Behaviour.QUIET, level)
    change = float(np.median(y[after])) - level
    grown = slope * float(t_s[after].mean() - t_s[before].mean())
    deviation = y[during] - level
    largest = float(np.abs(deviation).max())
    moving = np.abs(deviation) > max(MOVING * largest, CLEAR * noise)
    return ColumnMotion(
        series,
        _behaviour(t_s[during], deviation, moving, y[after] - level, change=change, grown=grown, noise=noise),
        level=level,
        noise=noise,
        clearness=largest / noise,
        integral=float(np.trapezoid(deviation, t_s[during])),
        change=change,
        last_s=float(t_s[during][moving][-1]) if moving.any() else window.turn_s,
        t_s=t_s[during],
        deviation=deviation,
    )


def _behaviour(
    t_s: Floats, deviation: Floats, moving: Flags, after: Floats, *, change: float, grown: float, noise: float
) -> Behaviour:
    largest = float(np.abs(deviation).max())
    if largest < CLEAR * noise:
        return Behaviour.QUIET
    if abs(change) > CLEAR * noise and abs(grown) > GROWS * abs(change) and grown * change > 0.0:
        return Behaviour.GROWS
    if float(np.ptp(after)) > max(RETURNED * largest, CLEAR * noise):
        return Behaviour.RESTLESS
    if abs(change) > max(RETURNED * largest, CLEAR * noise):
        outside = max(
            float((deviation * np.sign(change)).max()) - abs(change), float(-(deviation * np.sign(change)).min())
        )
        return Behaviour.STAYS if outside < OVERSHOOT * abs(change) else Behaviour.RESTLESS
    moved = np.where(moving, deviation, 0.0)
    whole = float(np.trapezoid(np.abs(moved), t_s))
    is_enough = moving.sum() >= LEAST_MOVING and float(np.ptp(t_s[moving])) >= LEAST_MOVING_S
    is_one_way = whole > 0.0 and abs(float(np.trapezoid(moved, t_s))) > ONE_SIDED * whole
    return Behaviour.RATE if is_enough and is_one_way else Behaviour.RETURNS


def without_spikes(values: Floats) -> Floats:
    """Values with those replaced that stand out alone by more than all others move: damaged lines."""
    if len(values) < LEAST_REST:
        return values
    padded = np.concatenate([values[:1], values, values[-1:]])
    middle = np.median(np.stack([padded[:-2], padded[1:-1], padded[2:]]), axis=0)
    is_spike = np.abs(values - middle) > SPIKE * max(float(np.ptp(middle)), 1e-300)
    cleaned: Floats = np.where(is_spike & (np.ptp(middle) > 0.0), middle, values)
    return cleaned


def unwrapped(values: Floats, period: float) -> Floats:
    """An angle without its jumps; the same values where they are no angle of that period."""
    if np.abs(values).max(initial=0.0) > 1.01 * period:
        return values
    angles: Floats = np.unwrap(values, period=period)
    return angles


def _slope(t_s: Floats, values: Floats) -> float:
    """Of the line through values, by least squares; 0 where all came at once."""
    from_middle_s = t_s - t_s.mean()
    spread = float(from_middle_s @ from_middle_s)
    return float(from_middle_s @ (values - values.mean())) / spread if spread > 0.0 else 0.0


def _noise(values: Floats, at_rest: Floats) -> float:
    """Standard deviation of a rest, at least that of the rounding; 0 where nothing ever changes.

    By the mean absolute deviation: a few odd values matter less than in squares, and whole numbers have no steps in it,
    as they have in a median.
    """
    steps = np.abs(np.diff(values))
    resolution = float(steps.min(initial=np.inf, where=steps > 0.0))
    if not np.isfinite(resolution):
        return 0.0
    scatter = sqrt(0.5 * pi) * float(np.mean(np.abs(at_rest - np.median(at_rest))))
    return max(scatter, min(resolution, FEW_STEPS * float(np.ptp(values))) / sqrt(12.0))
