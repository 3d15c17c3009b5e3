"""Check that two samples come from the same device: counter and clock both advance."""

from gyrodrift.link.clocks.steps import ODD_SHARE, ODD_US, step_between
from gyrodrift.values.constants import COUNTER_WRAP
from gyrodrift.values.sample import Reading


def goes_on(last: Reading, reading: Reading, rate_hz: float | None) -> bool:
    """Whether the clock advances, and the counter by the samples of that time.

    `rate_hz` is None if the device does not send it; then only the clock counts.
    """
    step_us, counted = step_between(last, reading)
    if step_us < 0:
        return False
    if rate_hz is None:
        return True
    off = (counted - step_us * 1e-6 * rate_hz) % COUNTER_WRAP
    return min(off, COUNTER_WRAP - off) <= max(ODD_US, ODD_SHARE * step_us) * 1e-6 * rate_hz
