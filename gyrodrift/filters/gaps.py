"""Gaps and restarts: meanwhile the motion of the device is unknown.

A step between two samples that is much longer than the others is a gap. Over a gap yaw is held, and its variance grows
by the turn that a device may have made. A restart, or a pause that is long enough for one, also gives the bias its
turn-on prior again, around the last estimate. All filters have this rule.

The rate in a gap is a Gauss-Markov process with the measured rates at both ends. Its integral over T seconds has the
mean τ·tanh(T/2τ)·(ω₀ + ω₁) and the variance 2σ²τ·(T − 2τ·tanh(T/2τ)). Yaw is held, so the square of the mean counts as
variance too. More than a whole circle is not known less: the variance stays at that of a uniform angle.
"""

from dataclasses import dataclass
from math import exp
from typing import Any

LONGEST_STEP_S = 0.3
"""Longest step that is no gap at any sample rate, s. Chosen: a device turns evenly for a few tenths of a second."""

GAP_PERIODS = 3.0
"""Periods of a slow device in a step that is no gap. Chosen: up to two samples may be missing."""

MOST_STEP_S = 3.0
"""Longest step that is no gap of any device, s. Derived: three periods at 1 Hz, the slowest logger."""

FIRST_STEP_S = 1.5
"""Longest step that is no gap before the period is known, s. Derived: three periods at 2 Hz."""

RATE_DPS, CORRELATION_S = 60.0, 1.0
"""Standard deviation of the unknown rate, deg/s, and its correlation time, s. Chosen: half a turn in 3 s is within two
sigmas. On 91 real recordings, 99 % of windows of 0.3 to 60 s are, and of each recording at least 80 %. Maximum
likelihood on these robots and tables gives 17 deg/s and 1.2 s, but the liveliest tenth has 76 deg/s."""

CIRCLE_VAR = 180.0 * 180.0 / 3.0
"""Variance of a uniform angle, deg². Derived: the square of 360° over 12."""

POWER_CYCLE_S = 10.0
"""Shortest gap in which a device may have been switched off and on, s. Chosen: a person needs some seconds to replug a
device, and a device some seconds to start."""

CORRECTION_DEG = 1.0
"""Step of yaw without motion above which it counts as a correction, deg. Chosen; the public interface states it."""


UNKNOWN_S = 1e9
"""Length of a gap that nobody knows, s. By definition: beyond any gap, and `CIRCLE_VAR` limits the variance."""


@dataclass(slots=True)
class GapWatch:
    """Limit that tells a gap from a step, and counts.

    longest_step_s
        Longest step that is no gap, s; 0 if the next step is one whatever its length.
    told_s
        Length of the next gap, s, if the times do not show it.
    has_restarted
        The device has restarted before the next sample.
    gaps, restarts
        Numbers of gaps, and of those after which the bias is in doubt.
    """

    longest_step_s: float = FIRST_STEP_S
    told_s: float = 0.0
    has_restarted: bool = False
    gaps: int = 0
    restarts: int = 0


def longest_step_s(period_s: float) -> float:
    """Longest step that is no gap of a device with this period, s."""
    return min(max(LONGEST_STEP_S, GAP_PERIODS * period_s), MOST_STEP_S)


def gap_length_s(watch: GapWatch, step_s: float) -> float:
    """Length of a gap, s: the step of the times, or what was told if that is a usual step."""
    return step_s if step_s > LONGEST_STEP_S else max(step_s, watch.told_s)


def turn_var(seconds: float, rates_dps: float) -> float:
    """Variance of yaw that is held over a gap, deg².

    Parameters
    ----------
    seconds
        Length of the gap, s.
    rates_dps
        Sum of the rates before and after it without their bias, deg/s.
    """
    decay = exp(-seconds / CORRELATION_S)
    lag_s = CORRELATION_S * (1.0 - decay) / (1.0 + decay)
    turn_deg = lag_s * rates_dps
    return min(CIRCLE_VAR, 2.0 * RATE_DPS * RATE_DPS * CORRELATION_S * (seconds - 2.0 * lag_s) + turn_deg * turn_deg)


def count_gap(watch: GapWatch, step_s: float) -> bool:
    """Count a gap by the step of the times; whether the device may have been switched off and on in it.

    The next step may be as long as this one without a gap, up to three times the limit: the device may send fewer
    samples from now on.
    """
    may_have_restarted = watch.has_restarted or step_s >= POWER_CYCLE_S
    watch.longest_step_s = longest_step_s(min(step_s, max(watch.longest_step_s, LONGEST_STEP_S)))
    watch.told_s, watch.has_restarted = 0.0, False
    watch.gaps += 1
    if may_have_restarted:
        watch.restarts += 1
    return may_have_restarted


def expect_gap(watch: GapWatch, seconds: float, *, has_restarted: bool) -> None:
    """Take the next step as a gap of some seconds, whatever the times are; or as a restart, with any time."""
    watch.longest_step_s, watch.told_s = 0.0, max(watch.told_s, seconds)
    watch.has_restarted = watch.has_restarted or has_restarted


def count_correction(s: Any, step_deg: float) -> None:
    """Store a step of yaw that is no motion in the state of a filter, and count it if it is large."""
    s.correction_deg = step_deg
    if abs(step_deg) > CORRECTION_DEG:
        s.corrections += 1


def add_correction(s: Any, step_deg: float) -> None:
    """Add a further step in the same sample, which counts once."""
    was_large = abs(s.correction_deg) > CORRECTION_DEG
    s.correction_deg += step_deg
    if abs(s.correction_deg) > CORRECTION_DEG and not was_large:
        s.corrections += 1
