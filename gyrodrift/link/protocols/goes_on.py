"""Whether one sample may be of the device that sent the one before: its counter and its clock both went on."""

from gyrodrift.link.clocks.steps import COUNTER_WRAP, ODD_SHARE, ODD_US, step_between
from gyrodrift.sample import Reading


def goes_on(last: Reading, reading: Reading, rate_hz: float | None) -> bool:
    """Whether the clock went forward, and the counter by as many samples as a device of this rate takes meanwhile.

    `rate_hz` is None where the device does not say it: then the clock decides alone.
    """
    step_us, counted = step_between(last, reading)
    if step_us < 0:
        return False
    if rate_hz is None:
        return True
    off = (counted - step_us * 1e-6 * rate_hz) % COUNTER_WRAP
    return min(off, COUNTER_WRAP - off) <= max(ODD_US, ODD_SHARE * step_us) * 1e-6 * rate_hz
