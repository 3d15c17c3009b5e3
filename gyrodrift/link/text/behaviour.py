"""How columns without names are told: a clock grows, an acceleration keeps its length, a rate moves about zero."""

from collections.abc import Sequence
from itertools import pairwise
from math import hypot
from statistics import fmean, median, pstdev

from gyrodrift.columns.names import SeenColumn
from gyrodrift.link.text.fields import is_whole

GRAVITIES = (1.0, 9.81, 1000.0, 2048.0, 4096.0, 8192.0, 16384.0)
"""What a level accelerometer says: in g, m/s², mg, and in counts at ±16, 8, 4 and 2 g over 16 bits."""

STEADY_NORM = 0.15
"""Relative: how far the length of an acceleration may be from one of GRAVITIES, and how much it may vary."""

GROWING_STEPS = 0.9
STEP_SPREAD = 0.5
"""A clock grows with nine steps in ten, and half of the steps are within this share of the median step."""

MOVES_MORE = 5.0

SURROUNDINGS_C = (5.0, 70.0)
WARMTH_RANGE_C = 2.0

LEAST_LINES = 3


def find_clock(columns: list[SeenColumn], lines_per_s: float | None) -> None:
    """The leftmost column that grows evenly; one that grows by one is a counter, unless a line comes each ms."""
    if any(column.kind == "clock" for column in columns):
        return
    for column in columns:
        if column.kind or not _is_growing(column.numbers):
            continue
        step = step_of(column.numbers)
        if step == 1.0 and not (lines_per_s and 850.0 < lines_per_s < 1150.0):
            if not any(each.kind == "seq" for each in columns):
                column.kind, column.why = "seq", "counts one by one"
            continue
        column.kind, column.why = "clock", f"grows by {step:g} with each line"
        return


def _is_growing(numbers: Sequence[float]) -> bool:
    if len(numbers) < LEAST_LINES:
        return False
    steps = [after - before for before, after in pairwise(numbers)]
    middle = median(steps)
    near = sum(abs(step - middle) <= STEP_SPREAD * middle for step in steps)
    return middle > 0.0 and sum(step > 0.0 for step in steps) >= GROWING_STEPS * len(steps) and near >= 0.5 * len(steps)


def step_of(numbers: Sequence[float]) -> float:
    """Median step from line to line."""
    return median(after - before for before, after in pairwise(numbers))


def find_accelerometer(columns: list[SeenColumn]) -> None:
    """Three columns beside each other whose length is that of gravity, however they turn."""
    if any(column.kind == "ax" for column in columns):
        return
    for three in zip(columns, columns[1:], columns[2:], strict=False):
        if any(column.kind or not column.is_numeric for column in three):
            continue
        lengths = [hypot(*vector) for vector in zip(*(column.numbers for column in three), strict=True)]
        mean = fmean(lengths)
        is_gravity = any(abs(mean - known) <= STEADY_NORM * known for known in GRAVITIES)
        if is_gravity and pstdev(lengths) <= STEADY_NORM * mean and any(column.moves for column in three):
            for column, kind in zip(three, ("ax", "ay", "az"), strict=True):
                column.kind, column.why = kind, f"the three have the length of gravity, {mean:.4g}"
            return


def find_temperature(columns: list[SeenColumn]) -> None:
    """The last of several columns, where it hardly moves and is as warm as a room."""
    unknown = [column for column in columns if not column.kind and column.is_numeric]
    if any(column.kind == "temp" for column in columns) or len(unknown) < 2:
        return
    last = unknown[-1]
    is_warm = all(SURROUNDINGS_C[0] < number < SURROUNDINGS_C[1] for number in last.numbers)
    if is_warm and last.moves <= WARMTH_RANGE_C and not all(map(is_whole, last.texts)):
        last.kind, last.why = "temp", "hardly moves and is as warm as a room"


def find_rate(columns: list[SeenColumn]) -> None:
    """Of three axes the one that moves most, else the third; of one or two columns the first."""
    if any(column.kind == "rate" for column in columns):
        return
    unknown = [column for column in columns if not column.kind and column.is_numeric]
    if len(unknown) >= 3:
        three = unknown[:3]
        moving = max(three, key=lambda column: column.moves)
        still = sorted(column.moves for column in three)[1]
        at = three.index(moving) if moving.moves > MOVES_MORE * still else 2
        for column, kind in zip(three, ("gx", "gy", "gz"), strict=True):
            column.kind, column.why = kind, "is one of three axes"
        why = "moves most of three axes" if at != 2 or moving is three[2] else "is the third of three axes"
        three[at].kind, three[at].why = ("rate", why)
        for column, name in zip(three, ("gx", "gy", "gz"), strict=True):
            column.label = column.label or name
    elif unknown:
        unknown[0].kind, unknown[0].why = "rate", "is the first number that is no clock"
        if len(unknown) == 2 and _is_integral(unknown[1].numbers, unknown[0].numbers):
            unknown[1].kind, unknown[1].why = "encoder", "is what the rate adds up to"


def _is_integral(angle: Sequence[float], rate: Sequence[float]) -> bool:
    """Whether the steps of the one go with the other."""
    steps = [after - before for before, after in pairwise(angle)]
    rates = [0.5 * (before + after) for before, after in pairwise(rate)]
    spread = pstdev(steps) * pstdev(rates)
    if not spread:
        return False
    mean_step, mean_rate = fmean(steps), fmean(rates)
    together = fmean((a - mean_step) * (b - mean_rate) for a, b in zip(steps, rates, strict=True))
    return together / spread > 0.9
