"""Hypotheses about which constant-rate segments were rests, from block to block.

The rate returns to the bias at each rest. It does not return to the rate of a spin. So each hypothesis branches at each
segment: in one branch the device is at rest, in the other it spins at a constant rate. Later segments decide between
the two. Within a hypothesis, yaw and bias are a Kalman filter of two states. A block mean at rest measures the bias. It
also corrects the yaw error that a wrong bias has caused since the last rest.
"""

from math import exp

from gyrodrift.filters.beliefs import PARTS
from gyrodrift.filters.restlevel.bias_state import Hypothesis
from gyrodrift.filters.restlevel.durations import (
    begin_rest,
    outlast_motions,
    weigh_gradual_end,
    weigh_rest,
    weigh_vibrating_rest,
)
from gyrodrift.filters.restlevel.kalman import first_kalman_update, kalman_update
from gyrodrift.filters.restlevel.mixture import collapse, merge_and_prune, normalise
from gyrodrift.filters.restlevel.model import RestlevelCoefficients, RestlevelState
from gyrodrift.filters.restlevel.noise import FLICKER_CLIP, forget_noise, learn_at_rest
from gyrodrift.filters.restlevel.rate_state import NEVER
from gyrodrift.filters.restlevel.recall import begin_remembered, remembered_weight
from gyrodrift.filters.restlevel.segments import block_mean_var, confirming_blocks, is_from_start
from gyrodrift.filters.restlevel.slide import follow_slide, mark_safe, restore_safe_bias, undo_safe_bias
from gyrodrift.filters.restlevel.turns import forget_turns
from gyrodrift.filters.restlevel.vibration import (
    VIBRATION_LEVEL_DPS,
    VIBRATION_SHIFT_DPS,
    VIBRATION_SHIFT_S,
    count_motion,
    level_density,
    vibration_odds,
)
from gyrodrift.filters.restlevel.wander import forget_levels

NOISY_REST_SHARE = 0.1
"""Share of rests with a running motor or fan. After a drop of the noise, all rests so far were such rests or motion.
Chosen: one rest in ten."""


def begin(c: RestlevelCoefficients, s: RestlevelState) -> None:
    """Set the initial hypotheses: remembered biases, and the kinds of parts."""
    begin_remembered(c, s)
    _begin_unknown(c, s, 1.0 - remembered_weight(s))
    collapse(c, s)


def restart(c: RestlevelCoefficients, s: RestlevelState) -> None:
    """Restart the filter with the present block, because the values so far were no rates. Yaw stays, without sigma."""
    s.yaw_deg, s.moments.yaw_var = s.moments.yaw_deg, 0.0
    for h in s.hypotheses:
        _clear(h)
    begin(c, s)
    forget_noise(s.noise)
    forget_levels(s.wander)
    forget_turns(s.turns)
    forget_segments(s)
    s.vibration.motions = s.vibration.motion_var = 0.0
    s.blocks = 0
    s.sure.seconds, s.sure.rests, s.sure.has_first = 0.0, 0, False


def reopen(c: RestlevelCoefficients, s: RestlevelState) -> None:
    """Give the bias its turn-on prior around the last estimate. Yaw, its variance and the noise of the sensor stay.

    The next segment may be one from the start.
    """
    bias_dps = s.bias_dps
    s.yaw_deg = s.moments.yaw_deg
    for h in s.hypotheses:
        _clear(h)
    _begin_unknown(c, s, 1.0)
    for h in s.hypotheses:
        if h.weight > 0.0:
            h.bias_dps = bias_dps
    collapse(c, s)
    forget_turns(s.turns)
    s.blocks = 0


def forget_segments(s: RestlevelState) -> None:
    """Forget the present and the last segment."""
    s.wander.was_stationary = False
    s.segment.blocks = s.vibration.blocks = 0
    s.ended.blocks_ago, s.ended.short_start_blocks, s.ended.ended_gradually = NEVER, 0, False


def _clear(h: Hypothesis) -> None:
    """Free the slot of a hypothesis."""
    h.weight = h.covariance = h.yaw_var = h.bias_dps = h.moving_s = 0.0
    h.knows_bias = h.is_at_rest = h.was_at_rest = False
    h.odds = h.turn_density = 1.0


def _begin_unknown(c: RestlevelCoefficients, s: RestlevelState, weight: float) -> None:
    """Set the hypotheses of an unknown part in free slots, with this probability of all together."""
    free = 0
    for k in range(len(PARTS)):
        share, wider = PARTS[k]
        while s.hypotheses[free].weight > 0.0:
            free += 1
        h = s.hypotheses[free]
        _clear(h)
        h.yaw_deg, h.yaw_var = s.yaw_deg, s.moments.yaw_var
        h.weight, h.bias_var = weight * share, c.turn_on_var * wider * wider
        if c.turn_on_var == 0.0:  # the sensor subtracts its own bias, so the bias is known
            h.weight, h.knows_bias = weight, True
            return


def enter_segment(s: RestlevelState) -> None:
    """Store the yaw of each hypothesis where a segment may begin."""
    for h in s.hypotheses:
        checkpoint = h.checkpoint
        checkpoint.yaw_deg = h.yaw_deg
        checkpoint.yaw_var = h.yaw_var
        checkpoint.covariance = h.covariance
        checkpoint.moving_s = h.moving_s


def leave_segment(s: RestlevelState) -> None:
    """End the rest of all hypotheses at the end of a confirmed segment."""
    if s.ended.is_vibrating:
        count_motion(s)
    for h in s.hypotheses:
        h.was_at_rest = h.is_at_rest
        h.is_at_rest = False


def end_gradually(s: RestlevelState) -> None:
    """Weigh rests that have ended gradually, as the flat part of a curve does, and restore their safe bias."""
    for h in s.hypotheses:
        if h.weight > 0.0 and h.was_at_rest:
            weigh_gradual_end(h, s.ended.seconds, s.ended.sensor_odds)
            restore_safe_bias(h)
    normalise(s)


def weigh_noisy_rests(s: RestlevelState) -> None:
    """Weigh hypotheses with a rest by the share of noisy rests, if the noise has dropped."""
    if not s.noise.has_dropped:
        return
    for h in s.hypotheses:
        if h.knows_bias:
            h.weight *= NOISY_REST_SHARE
    normalise(s)


def predict(c: RestlevelCoefficients, s: RestlevelState, angle_deg: float, seconds: float) -> None:
    """Predict a block: yaw turns in hypotheses of motion, and the bias follows its random walk."""
    angle_walk_var = max(0.0, s.noise.angle_walk_var)  # unknown in the first block
    for h in s.hypotheses:
        if h.weight == 0.0:
            continue
        if not h.is_at_rest:
            h.yaw_deg += angle_deg - h.bias_dps * seconds
            h.yaw_var += seconds * (h.bias_var * seconds - 2.0 * h.covariance + angle_walk_var)
            h.covariance -= h.bias_var * seconds
            h.moving_s += seconds
        h.bias_var += c.rate_walk_var * seconds


def branch(c: RestlevelCoefficients, s: RestlevelState, seconds: float) -> None:
    """Branch each hypothesis at a confirmed segment into a spin, and a rest in a free slot.

    The rest begins where the segment began: its yaw is the yaw at that time.
    """
    odds = c.start_odds if is_from_start(s, seconds) else c.rest_odds
    odds = vibration_odds(s, odds) if s.segment.is_vibrating else odds
    _branch(c, s, s.segment.mean_dps, _level_var(s, seconds), odds)


def branch_at_end(c: RestlevelCoefficients, s: RestlevelState, seconds: float) -> None:
    """Branch each hypothesis at the end of a short rest from the start, which the present block has ended."""
    mean_var = s.noise.angle_walk_var / (seconds * s.ended.short_start_blocks)
    _branch(c, s, s.ended.mean_dps, mean_var, c.rest_odds)


def _level_var(s: RestlevelState, seconds: float) -> float:
    """Variance of the mean of a segment that is confirmed now, as a bias, (deg/s)²."""
    mean_var = block_mean_var(s, seconds) / confirming_blocks(s.segment)
    return mean_var + VIBRATION_SHIFT_DPS * VIBRATION_SHIFT_DPS if s.segment.is_vibrating else mean_var


def _branch(c: RestlevelCoefficients, s: RestlevelState, mean_dps: float, mean_var: float, odds: float) -> None:
    """Branch each hypothesis by the mean of a segment, its variance, and the prior odds of a rest."""
    is_vibrating, free = s.segment.is_vibrating, 0
    level_var = VIBRATION_LEVEL_DPS * VIBRATION_LEVEL_DPS if is_vibrating else s.noise.sample_var
    for k in range(len(s.hypotheses)):
        h = s.hypotheses[k]
        if h.weight == 0.0 or h.is_at_rest or (is_vibrating and not h.knows_bias):
            continue
        while s.hypotheses[free].weight > 0.0:
            free += 1
        rest = s.hypotheses[free]
        _go_back(h, rest)
        rest.bias_dps = h.bias_dps
        rest.bias_var = h.bias_var
        rest.knows_bias = h.knows_bias
        rest.turn_density = h.turn_density
        rest.is_at_rest, rest.was_at_rest = True, False
        begin_rest(rest, s.wander, odds, level_var, mean_dps - h.bias_dps)
        log_likelihood = _measure_segment(c, s, rest, mean_dps, mean_var)
        rest.weight = h.weight if is_vibrating else h.weight * exp(log_likelihood)
        _weigh_segment(s, rest)
        mark_safe(rest)
    merge_and_prune(s)


def resume(c: RestlevelCoefficients, s: RestlevelState, seconds: float) -> None:
    """Resume the segment before: its rests go on, and the blocks between are no evidence."""
    mean_dps, mean_var = s.segment.mean_dps, _level_var(s, seconds)
    for h in s.hypotheses:
        if h.weight > 0.0 and h.was_at_rest:
            _go_back(h, h)
            if s.ended.ended_gradually:
                undo_safe_bias(h)
            _measure_segment(c, s, h, mean_dps, mean_var)
            h.is_at_rest = True
            _weigh_segment(s, h)
    normalise(s)


def zero_velocity_update(
    c: RestlevelCoefficients, s: RestlevelState, mean_dps: float, step_dps: float, seconds: float
) -> None:
    """Update hypotheses of rest by the mean of a further block of a confirmed segment, and learn the noise."""
    noise, is_vibrating, mean_var = s.noise, s.segment.is_vibrating, block_mean_var(s, seconds)
    if is_vibrating:
        mean_var += VIBRATION_SHIFT_DPS * VIBRATION_SHIFT_DPS * VIBRATION_SHIFT_S / seconds
    ramp_var = c.rate_ramp_dps_s * c.rate_ramp_dps_s * seconds * seconds
    rest_weight = excess_var = 0.0
    for h in s.hypotheses:
        if h.weight == 0.0 or not h.is_at_rest:
            continue
        rest_weight += h.weight
        outlast_motions(h, s.segment.averages_out)
        _weigh_segment(s, h)
        innovation_dps = mean_dps - h.bias_dps
        beyond_var = innovation_dps * innovation_dps - h.bias_var - mean_var - noise.flicker_var
        excess_var += h.weight * min(beyond_var, FLICKER_CLIP * (mean_var + noise.flicker_var))
        kalman_update(h, mean_dps, mean_var, ramp_var)
        if not is_vibrating:
            h.moving_s = 0.0
        follow_slide(c.rate_ramp_dps_s, h, seconds)
    normalise(s)
    if not is_vibrating:
        learn_at_rest(noise, rest_weight, excess_var, step_dps, s.block, seconds)


def _measure_segment(
    c: RestlevelCoefficients, s: RestlevelState, h: Hypothesis, mean_dps: float, mean_var: float
) -> float:
    """Update a hypothesis at the beginning of a rest; return the logarithm of the likelihood of the mean.

    A rest in vibration is no reason for a ramp of the bias: a gentle bend has such a mean.
    """
    if s.segment.is_vibrating:
        return kalman_update(h, mean_dps, mean_var, 0.0)
    return first_kalman_update(c, h, mean_dps, mean_var)


def _weigh_segment(s: RestlevelState, h: Hypothesis) -> None:
    """Weigh the present rest of a hypothesis."""
    if s.segment.is_vibrating:
        weigh_vibrating_rest(h, s.segment.seconds, level_density(s, h))
    else:
        weigh_rest(h, s.segment.seconds, s.segment.sensor_odds)


def _go_back(h: Hypothesis, to: Hypothesis) -> None:
    """Set yaw and its covariance of `to` to their values in `h` at the beginning of the segment."""
    to.yaw_deg = h.checkpoint.yaw_deg
    to.yaw_var = h.checkpoint.yaw_var
    to.covariance = h.checkpoint.covariance
    to.moving_s = h.checkpoint.moving_s
