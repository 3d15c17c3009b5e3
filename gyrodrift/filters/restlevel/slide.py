"""Slide of the bias in a rest, and the safe bias from before the slide, which replaces the bias after a gradual end.

A rest follows the first seconds of a gradual curve as drift, and all of a curve below `drift_dps_s`. Only the end of
the rest shows whether a slide was drift or a curve: a gradual end belongs to a curve. So the bias of each rest is
stored every few seconds. A cumulative sum detects the beginning of a slide (Page, "Continuous inspection schemes",
Biometrika 41, 1954). It sums the steps of the bias, reduced by the step that a rest may have. The slide began where
the sum was zero last. A slide from the first seconds on is a warm-up. It ends with the first step within its
uncertainty.
"""

from math import sqrt

from gyrodrift.filters.limits import SAME_TIME_S
from gyrodrift.filters.restlevel.bias_state import Hypothesis, RestMark

MARK_S = 4.0
"""Time between two steps of the bias of a rest, s. Chosen: at 2 or 3 s, more simulated drives had harm
(docs/blind-alleys.md)."""

FLAT_S = 1.0
"""Time in s whose drift by `drift_dps_s` is no slide: a quarter of the drift in `MARK_S`.

Chosen: it is half way between no slide and a slide by half of that drift."""

LONGEST_SLIDE_S = 40.0
"""Longest bend, s. Chosen: a longer slide is a change of temperature."""


def mark_safe(h: Hypothesis) -> None:
    """Store the present bias as recent and as safe, so that a gradual end undoes only a later slide."""
    _mark(h.recent, h)
    _mark(h.safe, h)
    h.slide_dps = 0.0
    h.has_been_flat = False


def follow_slide(ramp_dps_s: float, h: Hypothesis, seconds: float) -> None:
    """Update the slide of a rest after the zero-velocity update of a block; `ramp_dps_s` is the fastest drift."""
    recent, safe = h.recent, h.safe
    recent.ago_s += seconds
    safe.ago_s += seconds
    if recent.ago_s < MARK_S - SAME_TIME_S:
        return
    least_dps = ramp_dps_s * FLAT_S
    step_dps = h.bias_dps - recent.bias_dps
    before_dps = h.slide_dps
    h.slide_dps = _towards_zero(before_dps + step_dps, least_dps) if h.has_been_flat else 0.0
    h.has_been_flat = h.has_been_flat or abs(step_dps) <= least_dps + sqrt(recent.bias_var)
    if h.slide_dps * before_dps <= 0.0 or safe.ago_s >= LONGEST_SLIDE_S:
        safe.bias_dps, safe.bias_var, safe.ago_s = recent.bias_dps, recent.bias_var, recent.ago_s
    _mark(recent, h)


def restore_safe_bias(h: Hypothesis) -> None:
    """Exchange bias and safe bias of a rest that has ended gradually, and turn yaw by their difference since the end.

    The present segment may have begun with the block that ended the rest. Yaw had not turned then, so only the time
    since the rest changes in the checkpoint.
    """
    _exchange(h)
    h.yaw_deg -= (h.bias_dps - h.safe.bias_dps) * h.moving_s
    h.moving_s += h.safe.ago_s
    h.checkpoint.moving_s += h.safe.ago_s


def undo_safe_bias(h: Hypothesis) -> None:
    """Undo `restore_safe_bias` if the rest resumes; yaw is the yaw at the beginning of the segment."""
    _exchange(h)
    h.moving_s -= h.safe.ago_s
    h.yaw_deg -= (h.bias_dps - h.safe.bias_dps) * h.moving_s


def _exchange(h: Hypothesis) -> None:
    """Exchange bias and safe bias, with their variances."""
    safe = h.safe
    h.bias_dps, safe.bias_dps = safe.bias_dps, h.bias_dps
    h.bias_var, safe.bias_var = safe.bias_var, h.bias_var


def _mark(mark: RestMark, h: Hypothesis) -> None:
    """Store the present bias."""
    mark.bias_dps, mark.bias_var, mark.ago_s = h.bias_dps, h.bias_var, 0.0


def _towards_zero(x: float, step: float) -> float:
    """Value moved towards zero by a step, and not beyond zero."""
    return x - step if x > step else min(x + step, 0.0)
