"""How columns without names are told: a clock grows, an acceleration keeps its length. No behaviour makes a rate."""

from collections.abc import Sequence
from itertools import pairwise
from math import hypot
from statistics import fmean, median, pstdev

from gyrodrift.columns.names import SeenColumn
from gyrodrift.columns.spec import CLOCK_US
from gyrodrift.columns.units import Dimension
from gyrodrift.link.text.fields import is_whole

GRAVITIES = (1.0, 9.81, 64.0, 128.0, 256.0, 512.0, 1000.0, 1024.0, 2048.0, 4096.0, 8192.0, 16384.0)
"""What a level accelerometer says: in g, m/s², mg, and in counts of the ranges of 10 to 16 bits (data sheets of
ADXL345, MMA8452, LIS3DH and MPU-6050)."""

LEAST_TILT = 0.5
"""Relative: how far an axis of an acceleration has moved before its length tells it from other numbers."""

STEADY_NORM = 0.15
"""Relative: how far the length of an acceleration may be from one of GRAVITIES, and how much it may vary."""

GROWING_STEPS = 0.9
PACE_FACTOR = 2.0
"""A column without a name that grows at another pace than its lines come, by more than this, is no clock."""

STEP_SPREAD = 0.5
LEAST_FORWARD, STANDING = 0.2, 0.2
"""A clock does not go back in nine steps of ten, and half of the steps forward are within this share of their median.
One of too few digits stands still for most lines, and goes forward with a fifth of them at least."""

LEAST_TO_UNNAME = 10
SURROUNDINGS_C = (5.0, 70.0)
WARMTH_RANGE_C = 2.0

LEAST_LINES = 3


def find_clock(columns: list[SeenColumn], lines_per_s: float | None) -> None:
    """The leftmost column that grows evenly; one that grows by one is a counter, unless a line comes each ms."""
    if any(column.kind == "clock" for column in columns):
        return
    for column in columns:
        if column.kind or (column.unit and column.unit.dimension is not Dimension.TIME):
            continue
        step = step_of(column.numbers) if _is_growing(column.numbers) else 0.0
        if not step or not _fits(step, lines_per_s):
            continue
        if step == 1.0 and not (lines_per_s and 850.0 < lines_per_s < 1150.0):
            if not any(each.kind == "seq" for each in columns):
                column.kind, column.why = "seq", "counts one by one"
            continue
        column.kind, column.why = "clock", f"grows by {step:g} with each line"
        return


def unname_clocks(columns: list[SeenColumn], lines_per_s: float | None) -> None:
    """Take the name off a labelled clock that does not go on: `T: 25.1` is warm, and `us: 9980` lasts."""
    for column in columns:
        numbers = column.numbers
        if column.kind == "clock" and len(numbers) >= LEAST_TO_UNNAME and not _goes_on(numbers, lines_per_s):
            column.kind, column.why = "", ""


def _goes_on(numbers: Sequence[float], lines_per_s: float | None) -> bool:
    """Hardly ever back, and as fast as some unit makes it, or with enough of the lines where their pace is unknown."""
    steps = [after - before for before, after in pairwise(numbers)]
    if sum(step >= 0.0 for step in steps) < GROWING_STEPS * len(steps):
        return False
    forward = [step for step in steps if step > 0.0]
    if len(forward) >= LEAST_FORWARD * len(steps):
        return True
    step = sum(forward) / len(steps)
    return bool(lines_per_s) and step > 0.0 and _fits(step, lines_per_s)


def _fits(step: float, lines_per_s: float | None) -> bool:
    """Whether some unit makes the step that of the lines, or of a counter."""
    if lines_per_s is None or step == 1.0:
        return True
    return any(1.0 / PACE_FACTOR < step * us * 1e-6 * lines_per_s < PACE_FACTOR for us in CLOCK_US.values())


def _is_growing(numbers: Sequence[float]) -> bool:
    """Never back, or hardly ever, and by even steps once those are passed over that printing too few digits makes 0."""
    if len(numbers) < LEAST_LINES:
        return False
    steps = [after - before for before, after in pairwise(numbers)]
    forward = [step for step in steps if step > 0.0]
    if len(forward) < max(2, LEAST_FORWARD * len(steps)) or sum(step >= 0.0 for step in steps) < GROWING_STEPS * len(
        steps
    ):
        return False
    middle = median(forward)
    return sum(abs(step - middle) <= STEP_SPREAD * middle for step in forward) >= 0.5 * len(forward)


def step_of(numbers: Sequence[float]) -> float:
    """Typical step from line to line: the median, or the mean where most steps are hidden by too few digits."""
    steps = [after - before for before, after in pairwise(numbers)]
    forward = [step for step in steps if step >= 0.0]
    return median(steps) if steps.count(0.0) < STANDING * len(steps) else fmean(forward)


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
        has_moved = max(column.moves for column in three) > LEAST_TILT * mean  # at rest a bias has a steady length, too
        if is_gravity and has_moved and pstdev(lengths) <= STEADY_NORM * mean:
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
