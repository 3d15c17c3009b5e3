"""Whether one sample may be of the device that sent the one before: its counter and its clock both went on."""

CLOCK_WRAP_US = 1 << 32
COUNTER_WRAP = 1 << 16

SLACK_S = 0.1
SLACK_SHARE = 0.1
"""How far clock and counter may part over a step before they contradict each other, s, and as a share of the step.

The device clock of `clocks` allows as much.
"""


def goes_on(before: tuple[int, int], after: tuple[int, int], rate_hz: float | None) -> bool:
    """Whether the clock went forward, and the counter by as many samples as a device of this rate takes meanwhile.

    before, after
        Counter and clock in µs of two samples.
    rate_hz
        None where the device does not say it: then the clock decides alone.
    """
    (seq, t_us), (next_seq, next_t_us) = before, after
    step_us = (next_t_us - t_us) % CLOCK_WRAP_US
    if step_us >= CLOCK_WRAP_US // 2:
        return False
    if rate_hz is None:
        return True
    elapsed_s = step_us * 1e-6
    off = (next_seq - seq - elapsed_s * rate_hz) % COUNTER_WRAP
    return min(off, COUNTER_WRAP - off) <= max(SLACK_S, SLACK_SHARE * elapsed_s) * rate_hz
