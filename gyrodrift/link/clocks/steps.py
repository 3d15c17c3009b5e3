"""Steps of a device's clock and counter, both of which wrap, and whether two of them tell the same."""

from gyrodrift.sample import Reading

CLOCK_WRAP_US = 1 << 32
COUNTER_WRAP = 1 << 16

ODD_US = 100_000
ODD_SHARE = 0.1
"""How far clock and counter may part over one step, or the samples of two steps, before they contradict each other."""


def clock_step(last: Reading, reading: Reading) -> int:
    """Signed step of the wrapping clock, µs."""
    half = CLOCK_WRAP_US // 2
    return ((reading.t_us or 0) - (last.t_us or 0) + half) % CLOCK_WRAP_US - half


def counter_step(last_seq: int, seq: int) -> int:
    """How far the wrapping counter moved."""
    return (seq - last_seq) % COUNTER_WRAP


def step_between(last: Reading, reading: Reading) -> tuple[int, int]:
    """How far the clock moved, µs, and the counter; 0 for that of a device without one."""
    counted = 0 if last.seq is None or reading.seq is None else counter_step(last.seq, reading.seq)
    return clock_step(last, reading), counted


def agree(counted_us: float, step_us: int) -> bool:
    """Whether counter and clock tell the same of one step."""
    return abs(counted_us - step_us) <= max(ODD_US, ODD_SHARE * abs(step_us))


def is_one_pace(before: tuple[int, int], after: tuple[int, int]) -> bool:
    """Whether samples are as far apart over both steps, forward and by the counter.

    A device that was set to another rate is believed by that, long before its period is known.
    """
    (before_us, counted_before), (after_us, counted) = before, after
    if before_us <= 0 or after_us <= 0 or not all(0 < each < COUNTER_WRAP // 2 for each in (counted_before, counted)):
        return False
    expected = before_us * counted
    return abs(after_us * counted_before - expected) <= ODD_SHARE * expected
