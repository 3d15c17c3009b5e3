"""Constant-rate segments: beginning, confirmation, end, and resumption of the segment before."""

from math import sqrt

from gyrodrift.filters.restlevel.model import RestlevelCoefficients, RestlevelState
from gyrodrift.filters.restlevel.noise import MIN_VAR, is_stationary, sensor_odds
from gyrodrift.filters.restlevel.rate_state import RateSegment
from gyrodrift.filters.restlevel.vibration import VIBRATION_BLOCKS, follow_means, resumes, vibrates_steadily
from gyrodrift.filters.restlevel.wander import count_agreement, count_break, forget_levels

CONFIRMED_BLOCKS = 5
"""Number of blocks that confirm a segment. Chosen: the extreme rate of a gradual curve does not last so long."""

SHORT_BLOCKS = 3
"""Smallest number of blocks of a short rest from the start. Chosen: a device with a slow sensor may start to move
before its first rest is confirmed. The rest lasts at least as long as a fast sensor needs for a confirmation."""

GATE_SIGMAS = 4.0
"""Distance of a block mean from the mean of the segment, in sigmas, that begins another segment. Chosen: white noise
exceeds it once in 16 000 blocks."""

SLOPE_SIGMAS = 2.0
"""Largest difference of the two ends of a segment at its confirmation, in sigmas. Chosen: the ends of a curve
differ."""

GRADUAL_DPS_S = 0.4
"""Largest change of the rate at a gradual end, deg/s². The blocks after a gradual end are also stationary. Chosen."""

MAX_GAP_BLOCKS = 10
"""Largest number of blocks between a segment and the segment that it resumes, or between the start and the beginning of
a segment from the start. Chosen: 3 s at the default `window_s`."""

START_SIGMAS = 6.0
"""Largest range of the block means up to a rest from the start, in sigmas of a block mean. Chosen: the range of
fourteen normal numbers is seldom larger."""

LONG_SEGMENT_S = 15.0
LONG_GATE_SIGMAS = 6.0
"""Length in s from which on the gate for the next segment is wider, and this gate in sigmas. Chosen: after a long
segment, a larger difference is a jump of the bias rather than a spin."""

MEAN_BLOCKS = 10
"""Number of blocks in the mean of a segment. Chosen: 3 s at the default `window_s`."""

LESS_THAN_WHITE = 0.4
"""Scatter of the block means, as a variance of samples, below which it is less than that of white noise, over the
variance of the samples. Chosen: below the 0.5 of white noise."""


def track_segment(
    c: RestlevelCoefficients, s: RestlevelState, mean_dps: float, step_dps: float, seconds: float
) -> None:
    """Take a block into the present segment, begin another segment, or end the segment.

    Parameters
    ----------
    c, s
        Coefficients, and the state: segment, ended segment, levels and noise are changed.
    mean_dps, step_dps
        Mean of the present block, and its step from the mean of the block before, deg/s.
    seconds
        Length of the block, s.
    """
    segment, ended = s.segment, s.ended
    blocks_before, mean_before_dps = segment.blocks, segment.mean_dps
    seconds_before, sensor_odds_before = segment.seconds, segment.sensor_odds
    was_vibrating, was_confirmed, vibration_before_var = (
        segment.is_vibrating,
        is_confirmed(segment),
        s.vibration.sample_var,
    )
    is_now_stationary = not s.noise.is_frozen and is_stationary(c, s.block, s.noise) and s.witness.moving == 0
    is_short_start = not is_now_stationary and _is_short_start(c, s, seconds)
    s.blocks += 1
    if s.blocks <= 2:  # switching on may disturb the first block
        segment.least_dps = segment.most_dps = mean_dps
    segment.least_dps = min(segment.least_dps, mean_dps)
    segment.most_dps = max(segment.most_dps, mean_dps)
    if s.noise.has_dropped:
        forget_levels(s.wander)
    if is_now_stationary and s.wander.was_stationary:
        _follow_wander(c, s, mean_dps, seconds)
    s.wander.was_stationary = is_now_stationary
    may_vibrate = not is_now_stationary and not s.noise.is_frozen and s.witness.moving == 0
    if is_now_stationary or not may_vibrate:
        s.vibration.blocks = 0
    if is_now_stationary or (may_vibrate and vibrates_steadily(s)):
        if segment.is_vibrating != may_vibrate:
            segment.is_vibrating, segment.blocks = may_vibrate, 0
        _take_block(c, s, mean_dps, seconds)
    else:
        segment.blocks = 0
    segment.last_mean_dps = mean_dps
    ended.short_start_blocks = blocks_before if is_short_start else 0
    if is_short_start or (was_confirmed and not is_confirmed(segment)):
        ended.mean_dps, ended.blocks_ago = mean_before_dps, 0
        ended.seconds, ended.sensor_odds = seconds_before, sensor_odds_before
        ended.is_vibrating, s.vibration.ended_var = was_vibrating, vibration_before_var
        ended.ended_gradually = not was_vibrating and is_now_stationary and abs(step_dps) < GRADUAL_DPS_S * seconds
    ended.blocks_ago += 1


def confirming_blocks(segment: RateSegment) -> int:
    """Number of blocks that confirm the segment."""
    return VIBRATION_BLOCKS if segment.is_vibrating else CONFIRMED_BLOCKS


def is_confirmed(segment: RateSegment) -> bool:
    """Whether the segment is confirmed."""
    return segment.blocks >= confirming_blocks(segment)


def block_mean_var(s: RestlevelState, seconds: float) -> float:
    """Variance of a block mean of the present segment, (deg/s)²."""
    return s.vibration.mean_var if s.segment.is_vibrating else s.noise.angle_walk_var / seconds


def goes_on_gradually(s: RestlevelState, step_dps: float, seconds: float) -> bool:
    """Whether the block after the end of a segment also changes gradually."""
    return s.wander.was_stationary and abs(step_dps) < GRADUAL_DPS_S * seconds


def is_from_start(s: RestlevelState, seconds: float) -> bool:
    """Whether a segment is from the start: in the first blocks, without motion before."""
    segment = s.segment
    mean_var = s.noise.angle_walk_var / seconds
    range_dps = segment.most_dps - segment.least_dps
    is_early = s.blocks < MAX_GAP_BLOCKS + CONFIRMED_BLOCKS and not segment.is_vibrating
    return is_early and range_dps < START_SIGMAS * sqrt(mean_var)


def update_mean(segment: RateSegment, mean_dps: float) -> None:
    """Update the mean of the segment by a further block."""
    segment.mean_dps += (mean_dps - segment.mean_dps) / _mean_blocks(segment)


def continues(c: RestlevelCoefficients, s: RestlevelState, seconds: float) -> bool:
    """Whether a confirmed segment resumes the segment before; `seconds` is the length of a block, s."""
    segment, ended, mean_var = s.segment, s.ended, block_mean_var(s, seconds)
    ramp_dps = c.rate_ramp_dps_s * seconds * ended.blocks_ago
    gate_var = mean_var * (1.0 / CONFIRMED_BLOCKS + 1.0 / MEAN_BLOCKS) + ramp_dps * ramp_dps + s.noise.flicker_var
    sigmas = LONG_GATE_SIGMAS if ended.seconds >= LONG_SEGMENT_S else GATE_SIGMAS
    innovation_dps = segment.mean_dps - ended.mean_dps
    is_soon = ended.blocks_ago <= MAX_GAP_BLOCKS + CONFIRMED_BLOCKS
    return is_soon and resumes(s) and abs(innovation_dps) < sigmas * sqrt(gate_var)


def _is_short_start(c: RestlevelCoefficients, s: RestlevelState, seconds: float) -> bool:
    """Whether a present block in motion ends a short rest from the start."""
    blocks = s.segment.blocks
    is_long_enough = blocks >= SHORT_BLOCKS and blocks * seconds >= CONFIRMED_BLOCKS * c.window_s
    return is_long_enough and not s.segment.is_vibrating and blocks < CONFIRMED_BLOCKS and is_from_start(s, seconds)


def _follow_wander(c: RestlevelCoefficients, s: RestlevelState, mean_dps: float, seconds: float) -> None:
    """Update the agreement of levels by a stationary block that follows a stationary block.

    Blocks inside a confirmed segment do not count, because a confirmed level is no chance level.
    """
    segment = s.segment
    mean_var, ramp_dps = s.noise.angle_walk_var / seconds, c.rate_ramp_dps_s * seconds
    if segment.blocks > 0 and not _is_in_gate(s, mean_dps, mean_var, ramp_dps):
        count_break(s.wander, mean_dps - segment.mean_dps)
    elif segment.blocks < CONFIRMED_BLOCKS:
        count_agreement(s.wander)


def _take_block(c: RestlevelCoefficients, s: RestlevelState, mean_dps: float, seconds: float) -> None:
    """Extend the segment by a stationary or vibrating block, or begin another segment."""
    segment, ramp_dps = s.segment, c.rate_ramp_dps_s * seconds
    if segment.blocks == 0 or not _is_in_gate(s, mean_dps, block_mean_var(s, seconds), ramp_dps):
        segment.blocks, segment.seconds, segment.sum_squares = 1, seconds, 0.0
        segment.head_sum_dps = segment.mean_dps = mean_dps
        if segment.is_vibrating:
            follow_means(s)
        return
    step_dps = mean_dps - segment.last_mean_dps
    segment.sum_squares += step_dps * step_dps
    segment.blocks += 1
    segment.seconds += seconds
    if segment.blocks == 2:
        segment.head_sum_dps += mean_dps
    _follow_scatter(s)
    is_rest_like = not segment.is_vibrating or follow_means(s)
    if segment.blocks == confirming_blocks(segment):
        slope_dps = 0.5 * (segment.last_mean_dps + mean_dps - segment.head_sum_dps)
        slope_var = block_mean_var(s, seconds) + 4.0 * ramp_dps * ramp_dps
        is_rest_like = is_rest_like and abs(slope_dps) < SLOPE_SIGMAS * sqrt(slope_var)
    if not is_rest_like:
        segment.blocks = 0


def _follow_scatter(s: RestlevelState) -> None:
    """Update the likelihood of the scatter of the segment, as a variance of samples, (deg/s)².

    It is the variance of the samples, or the variance that the steps between block means imply, if that is smaller. A
    vibration averages out within a block, a motion does not. For white noise the second is half of the first.
    """
    segment = s.segment
    sample_var = s.vibration.sample_var if segment.is_vibrating else s.noise.sample_var
    step_var = 0.25 * s.block.samples * segment.sum_squares / (segment.blocks - 1)
    segment.averages_out = step_var < LESS_THAN_WHITE * sample_var
    segment.sensor_odds = 1.0 if segment.is_vibrating else sensor_odds(max(MIN_VAR, min(sample_var, step_var)))


def _mean_blocks(segment: RateSegment) -> int:
    """Number of blocks in the mean of the segment."""
    return segment.blocks if segment.is_vibrating else min(segment.blocks, MEAN_BLOCKS)


def _is_in_gate(s: RestlevelState, mean_dps: float, mean_var: float, ramp_dps: float) -> bool:
    """Whether a block mean may belong to the segment."""
    gate_var = mean_var * (1.0 + 1.0 / _mean_blocks(s.segment)) + ramp_dps * ramp_dps + s.noise.flicker_var
    return abs(mean_dps - s.segment.mean_dps) < GATE_SIGMAS * sqrt(gate_var)
