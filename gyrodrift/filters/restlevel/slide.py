"""What a curve has carried along: the bias of a rest before it began to slide, which counts where the rest ends gently.

By drift a rest follows the first seconds of a gentle curve, and all of one that is gentler than `drift_dps_s`. Whether
a slide was drift or a curve shows at its end: a device that is carried off gently was in a curve. So the bias of
each rest is looked at every few seconds, and where it began to slide is found by a cumulative sum (Page, "Continuous
inspection schemes", Biometrika 41, 1954): the sum of steps, each less what a rest may do by itself, was zero there
last. A rest that slides from its first seconds on slides by warming up, until a step is no more than its uncertainty.
"""

from math import sqrt

from gyrodrift.filters.restlevel.bias_state import Hypothesis, RestMark
from gyrodrift.filters.restlevel.model import RestlevelCoefficients

MARK_S = 4.0
"""The bias of a rest is looked at each time so long has passed."""

FLAT_S = 1.0
"""A step of no more than `drift_dps_s` in this time, a quarter of what drift allows, is no slide: half way between
none and one by half of it."""

LONGEST_SLIDE_S = 40.0
"""Bends last no longer than this; what slides longer is the weather."""


def mark_safe(h: Hypothesis) -> None:
    """Its bias is certain from here on: a gentle end of the rest takes back no more than what follows."""
    _mark(h.recent, h)
    _mark(h.safe, h)
    h.slide_dps = 0.0
    h.has_been_flat = False


def follow_slide(c: RestlevelCoefficients, h: Hypothesis, seconds: float) -> None:
    """A block of a rest has passed, and its zero-velocity update was made."""
    recent, safe = h.recent, h.safe
    recent.ago_s += seconds
    safe.ago_s += seconds
    if recent.ago_s < MARK_S:
        return
    least_dps = c.rate_ramp_dps_s * FLAT_S
    step_dps = h.bias_dps - recent.bias_dps
    before_dps = h.slide_dps
    h.slide_dps = _towards_zero(before_dps + step_dps, least_dps) if h.has_been_flat else 0.0
    h.has_been_flat = h.has_been_flat or abs(step_dps) <= least_dps + sqrt(recent.bias_var)
    if h.slide_dps * before_dps <= 0.0 or safe.ago_s >= LONGEST_SLIDE_S:
        safe.bias_dps, safe.bias_var, safe.ago_s = recent.bias_dps, recent.bias_var, recent.ago_s
    _mark(recent, h)


def restore_safe_bias(h: Hypothesis) -> None:
    """Give a rest that has ended gradually the bias that it had settled at, of some time ago; yaw turns with it since.

    The present segment may have begun with the block that ended the rest, when yaw had not turned yet.
    """
    _exchange(h)
    h.yaw_deg -= (h.bias_dps - h.safe.bias_dps) * h.moving_s
    h.moving_s += h.safe.ago_s
    h.checkpoint.moving_s += h.safe.ago_s


def undo_safe_bias(h: Hypothesis) -> None:
    """Undo `restore_safe_bias` where the rest goes on; yaw is that of the beginning of the segment."""
    _exchange(h)
    h.moving_s -= h.safe.ago_s
    h.yaw_deg -= (h.bias_dps - h.safe.bias_dps) * h.moving_s


def _exchange(h: Hypothesis) -> None:
    """Of bias and settled bias."""
    safe = h.safe
    h.bias_dps, safe.bias_dps = safe.bias_dps, h.bias_dps
    h.bias_var, safe.bias_var = safe.bias_var, h.bias_var


def _mark(mark: RestMark, h: Hypothesis) -> None:
    """Its bias as it is now."""
    mark.bias_dps, mark.bias_var, mark.ago_s = h.bias_dps, h.bias_var, 0.0


def _towards_zero(x: float, step: float) -> float:
    """By so much, and no further than zero."""
    return x - step if x > step else min(x + step, 0.0)
