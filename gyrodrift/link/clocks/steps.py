"""Steps of the wrapping clock and counter of a device, and their comparison."""

from gyrodrift.values.constants import CLOCK_WRAP_US, COUNTER_WRAP
from gyrodrift.values.sample import Reading

ODD_US = 100_000
ODD_SHARE = 0.1
"""Largest difference of clock and counter over a step, in µs, and as a share of the step."""


def clock_step(last: Reading, reading: Reading) -> int:
    """Signed step of the wrapping clock, µs."""
    half = CLOCK_WRAP_US // 2
    return ((reading.t_us or 0) - (last.t_us or 0) + half) % CLOCK_WRAP_US - half


def counter_step(last_seq: int, seq: int) -> int:
    """Step of the wrapping counter."""
    return (seq - last_seq) % COUNTER_WRAP


def step_between(last: Reading, reading: Reading) -> tuple[int, int]:
    """Steps of the clock, µs, and of the counter; 0 without a counter."""
    counted = 0 if last.seq is None or reading.seq is None else counter_step(last.seq, reading.seq)
    return clock_step(last, reading), counted


def agree(counted_us: float, step_us: int) -> bool:
    """Whether counter and clock agree on a step."""
    return abs(counted_us - step_us) <= max(ODD_US, ODD_SHARE * abs(step_us))


def is_one_pace(before: tuple[int, int], after: tuple[int, int]) -> bool:
    """Whether the period is the same over two forward steps, by the counter.

    It confirms the steps of a device with a new sample rate, before its period is known.
    """
    (before_us, counted_before), (after_us, counted) = before, after
    if before_us <= 0 or after_us <= 0 or not all(0 < count < COUNTER_WRAP // 2 for count in (counted_before, counted)):
        return False
    expected = before_us * counted
    return abs(after_us * counted_before - expected) <= ODD_SHARE * expected
