"""Columns without labels by their behavior: a clock grows, an acceleration has constant length; never a rate."""

from collections.abc import Sequence
from itertools import pairwise
from math import hypot
from statistics import fmean, median, pstdev

from gyrodrift.columns.fields import is_whole
from gyrodrift.columns.names import SeenColumn
from gyrodrift.columns.sizes import gravity_unit
from gyrodrift.columns.spec import CLOCK_US

TILT_MIN = 0.5
"""Smallest motion of an axis, relative to the length, before the length identifies an acceleration."""

STEADY_NORM = 0.15
"""Largest relative error and scatter of the length of an acceleration."""

GROWING_STEPS = 0.9
PACE_FACTOR = 2.0
"""Largest factor between the growth of a clock and the arrival of its lines."""

STEP_SPREAD = 0.5
FORWARD_MIN, STANDING = 0.2, 0.2
"""A clock advances or stands still in GROWING_STEPS of its steps, half of them within STEP_SPREAD of their median.

A clock with too few digits advances with FORWARD_MIN of the lines.
"""

LINES_TO_JUDGE = 10
SURROUNDINGS_C = (5.0, 70.0)
WARMTH_RANGE_C = 2.0

LINES_MIN = 3


def goes_on(numbers: Sequence[float], lines_per_s: float | None) -> bool:
    """Whether numbers almost never go back, and grow with enough lines, or as fast as a clock in some unit.

    `T: 25.1` is a temperature and `us: 9980` a duration. Few numbers say nothing.
    """
    if len(numbers) < LINES_TO_JUDGE:
        return True
    steps = [after - before for before, after in pairwise(numbers)]
    if sum(step >= 0.0 for step in steps) < GROWING_STEPS * len(steps):
        return False
    forward = [step for step in steps if step > 0.0]
    if len(forward) >= FORWARD_MIN * len(steps):
        return True
    return bool(forward) and _fits(sum(forward) / len(steps), lines_per_s)


def grows(numbers: Sequence[float], lines_per_s: float | None) -> bool:
    """Whether numbers grow evenly from line to line, like a counter or a clock in some unit."""
    step = step_of(numbers) if _is_growing(numbers) else 0.0
    return step > 0.0 and _fits(step, lines_per_s)


def _fits(step: float, lines_per_s: float | None) -> bool:
    """Whether the step fits the lines in some unit, or is a counter."""
    if lines_per_s is None or step == 1.0:
        return True
    return any(1.0 / PACE_FACTOR < step * us * 1e-6 * lines_per_s < PACE_FACTOR for us in CLOCK_US.values())


def _is_growing(numbers: Sequence[float]) -> bool:
    """Whether numbers almost never go back, and grow evenly; steps of 0 by too few digits are ignored."""
    if len(numbers) < LINES_MIN:
        return False
    steps = [after - before for before, after in pairwise(numbers)]
    forward = [step for step in steps if step > 0.0]
    if len(forward) < max(2, FORWARD_MIN * len(steps)) or sum(step >= 0.0 for step in steps) < GROWING_STEPS * len(
        steps
    ):
        return False
    middle = median(forward)
    return sum(abs(step - middle) <= STEP_SPREAD * middle for step in forward) >= 0.5 * len(forward)


def step_of(numbers: Sequence[float]) -> float:
    """Typical step between lines: the median, or the mean if too few digits hide most steps."""
    steps = [after - before for before, after in pairwise(numbers)]
    forward = [step for step in steps if step >= 0.0]
    return median(steps) if steps.count(0.0) < STANDING * len(steps) else fmean(forward)


def lengths_of(three: Sequence[SeenColumn]) -> list[float]:
    """Length of the vector in each line; empty if the columns have different numbers of values."""
    is_whole_table = len({len(column.numbers) for column in three}) == 1
    return [hypot(*vector) for vector in zip(*(c.numbers for c in three), strict=True)] if is_whole_table else []


def find_accelerometer(columns: list[SeenColumn]) -> None:
    """Name three adjacent columns whose length is gravity during motion."""
    if any(column.kind == "ax" for column in columns):
        return
    for three in zip(columns, columns[1:], columns[2:], strict=False):
        are_rows = len({len(column.numbers) for column in three}) == 1
        if not are_rows or any(column.kind or not column.is_numeric for column in three):
            continue
        lengths = lengths_of(three)
        mean = fmean(lengths or [0.0])
        is_gravity = gravity_unit(mean, STEADY_NORM)
        has_moved = (
            max(column.moves for column in three) > TILT_MIN * mean
        )  # at rest, biases have a constant length, too
        if is_gravity and has_moved and pstdev(lengths) <= STEADY_NORM * mean:
            for column, kind in zip(three, ("ax", "ay", "az"), strict=True):
                column.kind, column.why = kind, f"the three have the length of gravity, {mean:.4g}"
            return


def find_temperature(columns: list[SeenColumn]) -> None:
    """Name the last of several columns without labels if it is almost constant, at room temperature."""
    unknown = [column for column in columns if not column.kind and not column.label and column.is_numeric]
    if any(column.kind == "temp" for column in columns) or len(unknown) < 2:
        return
    last = unknown[-1]
    is_warm = all(SURROUNDINGS_C[0] < number < SURROUNDINGS_C[1] for number in last.numbers)
    if is_warm and last.moves <= WARMTH_RANGE_C and not all(map(is_whole, last.texts)):
        last.kind, last.why = "temp", "is almost constant, at room temperature"


ANGLE_MIN_SHARE = 0.05
"""Smallest turn of an angle, as a share of a full turn, that is compared with a rate: more than noise and drift."""

SAME_TURN = 0.95
"""Squared correlation from which an angle and the integral of a rate are of one axis."""

WINDOWS = 24


def angle_per_rate(rate: Sequence[float], angle: Sequence[float], t_s: Sequence[float], full_turn: float) -> float:
    """Change of an angle per integral of a rate over the same time; 0 unless they are of one axis and turn.

    Both are taken over WINDOWS parts, against their means, so that the bias of the rate does not count.
    """
    if not len(rate) == len(angle) == len(t_s) or len(rate) < 2 * WINDOWS:
        return 0.0
    edges = [index * (len(rate) - 1) // WINDOWS for index in range(WINDOWS + 1)]
    steps = [(b - a + 0.5 * full_turn) % full_turn - 0.5 * full_turn for a, b in pairwise(angle)]
    turns = [
        0.5 * (a + b) * (after - before) for (a, b), (before, after) in zip(pairwise(rate), pairwise(t_s), strict=True)
    ]
    moved, summed = ([sum(values[a:b]) for a, b in pairwise(edges)] for values in (steps, turns))
    if sum(map(abs, moved)) < ANGLE_MIN_SHARE * full_turn:
        return 0.0
    moved, summed = ([value - fmean(values) for value in values] for values in (moved, summed))
    together = sum(a * b for a, b in zip(moved, summed, strict=True))
    of_angle, of_rate = (sum(value * value for value in values) for values in (moved, summed))
    return together / of_rate if together * together > SAME_TURN * of_angle * of_rate else 0.0
