"""Constant-rate segments: where one begins, how long it lasts, and whether it continues the one before."""

from math import sqrt

from gyrodrift.filters.restlevel.model import RestlevelCoefficients, RestlevelState
from gyrodrift.filters.restlevel.noise import MIN_VAR, is_stationary, sensor_odds
from gyrodrift.filters.restlevel.rate_state import EndedSegment, NoiseModel, RateSegment
from gyrodrift.filters.restlevel.wander import count_agreement, count_break, forget_levels

CONFIRMED_BLOCKS = 5
"""Blocks after which a segment is confirmed: the turning point of a gentle curve is over by then."""

SHORT_BLOCKS = 3
"""A slow sensor may set out before its first rest is confirmed. That has so many blocks at least, and lasts as long as
a fast sensor takes to confirm one."""

GATE_SIGMAS = 4.0
"""A block whose mean is further from the segment's than this begins another segment."""

SLOPE_SIGMAS = 2.0
"""The two ends of a segment that is to be confirmed may differ by this: a curve's do."""

GRADUAL_DPS_S = 0.4
"""A segment ends gradually where the rate leaves it by less than this, deg/s², and the noise stays what it was."""

MAX_GAP_BLOCKS = 10
"""A segment may continue the one before within so many blocks; one that begins by then began at the start."""

START_SIGMAS = 6.0
"""Of a block mean, that all of them up to a rest from the start may be apart: fourteen normal numbers seldom are."""

LONG_SEGMENT_S = 15.0
LONG_GATE_SIGMAS = 6.0
"""After a segment of this length the mean may be as far off as this: a bias that jumped, rather than a spin."""

MEAN_BLOCKS = 10
"""Blocks that the mean of a segment is taken over."""


def track_segment(
    c: RestlevelCoefficients, s: RestlevelState, mean_dps: float, step_dps: float, seconds: float
) -> None:
    """Count a block: its mean belongs to the present segment, begins another, or there is none.

    Parameters
    ----------
    c, s
        Coefficients, and the state: segment, ended segment and noise are changed.
    mean_dps, step_dps
        Mean of the block that has just ended, and its step from the block before.
    seconds
        Length of the block.
    """
    segment, ended = s.segment, s.ended
    blocks_before, mean_before_dps = segment.blocks, segment.mean_dps
    seconds_before, sensor_odds_before = segment.seconds, segment.sensor_odds
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
    if is_now_stationary:
        _take_block(segment, s.noise, mean_dps, c.rate_ramp_dps_s * seconds, seconds)
        if segment.blocks > 1:
            segment.sensor_odds = sensor_odds(_scatter_var(segment, s.noise, s.block.samples))
    else:
        segment.blocks = 0
    segment.last_mean_dps = mean_dps
    ended.short_start_blocks = blocks_before if is_short_start else 0
    if is_short_start or blocks_before >= CONFIRMED_BLOCKS > segment.blocks:
        ended.mean_dps, ended.blocks_ago = mean_before_dps, 0
        ended.seconds, ended.sensor_odds = seconds_before, sensor_odds_before
        ended.ended_gradually = is_now_stationary and abs(step_dps) < GRADUAL_DPS_S * seconds
    ended.blocks_ago += 1


def goes_on_gradually(s: RestlevelState, step_dps: float, seconds: float) -> bool:
    """Whether the block after the end of a segment is as gradual as the one that ended it."""
    return s.wander.was_stationary and abs(step_dps) < GRADUAL_DPS_S * seconds


def is_from_start(s: RestlevelState, seconds: float) -> bool:
    """Whether a segment that is being confirmed began soon after the start, and nothing has moved before it."""
    segment = s.segment
    mean_var = s.noise.angle_walk_var / seconds
    range_dps = segment.most_dps - segment.least_dps
    return s.blocks < MAX_GAP_BLOCKS + CONFIRMED_BLOCKS and range_dps < START_SIGMAS * sqrt(mean_var)


def update_mean(segment: RateSegment, mean_dps: float) -> None:
    """Take the mean of a further block into the mean of the segment."""
    segment.mean_dps += (mean_dps - segment.mean_dps) / min(segment.blocks, MEAN_BLOCKS)


def continues(
    c: RestlevelCoefficients, segment: RateSegment, ended: EndedSegment, noise: NoiseModel, seconds: float
) -> bool:
    """Whether a segment that has just been confirmed is the one before; `seconds` is the length of a block."""
    mean_var = noise.angle_walk_var / seconds
    ramp_dps = c.rate_ramp_dps_s * seconds * ended.blocks_ago
    gate_var = mean_var * (1.0 / CONFIRMED_BLOCKS + 1.0 / MEAN_BLOCKS) + ramp_dps * ramp_dps + noise.flicker_var
    sigmas = LONG_GATE_SIGMAS if ended.seconds >= LONG_SEGMENT_S else GATE_SIGMAS
    innovation_dps = segment.mean_dps - ended.mean_dps
    is_soon = ended.blocks_ago <= MAX_GAP_BLOCKS + CONFIRMED_BLOCKS
    return is_soon and abs(innovation_dps) < sigmas * sqrt(gate_var)


def _is_short_start(c: RestlevelCoefficients, s: RestlevelState, seconds: float) -> bool:
    """Whether the segment up to the present block is a rest from the start, if that block sets out from it."""
    blocks = s.segment.blocks
    is_long_enough = blocks >= SHORT_BLOCKS and blocks * seconds >= CONFIRMED_BLOCKS * c.window_s
    return is_long_enough and blocks < CONFIRMED_BLOCKS and is_from_start(s, seconds)


def _follow_wander(c: RestlevelCoefficients, s: RestlevelState, mean_dps: float, seconds: float) -> None:
    """A stationary block behind another one: does it agree with the level so far? A confirmed one is none by chance."""
    segment = s.segment
    mean_var, ramp_dps = s.noise.angle_walk_var / seconds, c.rate_ramp_dps_s * seconds
    if segment.blocks > 0 and not _is_in_gate(segment, mean_dps, mean_var, ramp_dps, s.noise.flicker_var):
        count_break(s.wander, mean_dps - segment.mean_dps)
    elif segment.blocks < CONFIRMED_BLOCKS:
        count_agreement(s.wander)


def _take_block(segment: RateSegment, noise: NoiseModel, mean_dps: float, ramp_dps: float, seconds: float) -> None:
    """A stationary block: the segment goes on, or another begins."""
    mean_var = noise.angle_walk_var / seconds
    if segment.blocks == 0 or not _is_in_gate(segment, mean_dps, mean_var, ramp_dps, noise.flicker_var):
        segment.blocks, segment.seconds, segment.sum_squares = 1, seconds, 0.0
        segment.head_sum_dps = segment.mean_dps = mean_dps
        return
    step_dps = mean_dps - segment.last_mean_dps
    segment.sum_squares += step_dps * step_dps
    segment.blocks += 1
    segment.seconds += seconds
    if segment.blocks == 2:
        segment.head_sum_dps += mean_dps
    if segment.blocks == CONFIRMED_BLOCKS:
        slope_dps = 0.5 * (segment.last_mean_dps + mean_dps - segment.head_sum_dps)
        if abs(slope_dps) >= SLOPE_SIGMAS * sqrt(mean_var + 4.0 * ramp_dps * ramp_dps):
            segment.blocks = 0


def _scatter_var(segment: RateSegment, noise: NoiseModel, samples: int) -> float:
    """Variance of samples by which a level is judged, (deg/s)².

    It is that of the samples, or what the scatter of the block means makes of it where that is smaller: a vibration
    averages out within a block, a motion does not. As for D, white noise counts twice.
    """
    step_var = segment.sum_squares / (segment.blocks - 1)
    return max(MIN_VAR, min(noise.sample_var, 0.25 * samples * step_var))


def _is_in_gate(segment: RateSegment, mean_dps: float, mean_var: float, ramp_dps: float, flicker_var: float) -> bool:
    """Whether a block mean may belong to the segment."""
    gate_var = mean_var * (1.0 + 1.0 / min(segment.blocks, MEAN_BLOCKS)) + ramp_dps * ramp_dps + flicker_var
    return abs(mean_dps - segment.mean_dps) < GATE_SIGMAS * sqrt(gate_var)
