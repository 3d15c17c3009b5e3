"""Constant-rate segments: beginning, confirmation, end, and resumption of the segment before."""

from math import log, sqrt

from gyrodrift.filters.restlevel.model import RestlevelCoefficients, RestlevelState
from gyrodrift.filters.restlevel.noise import LOUD_SPREAD, MIN_VAR, is_stationary, is_steadily_loud, sensor_odds
from gyrodrift.filters.restlevel.rate_state import EndedSegment, NoiseModel, RateSegment
from gyrodrift.filters.restlevel.wander import count_agreement, count_break, forget_levels

CONFIRMED_BLOCKS = 5
"""Number of blocks that confirm a segment. The extreme rate of a gradual curve does not last so long."""

LOUD_BLOCKS = 10

LOUD_MEAN_VAR = 0.15**2

LOUD_PRIOR_BLOCKS = 2

WHITE_SCATTER = 0.4

SHORT_BLOCKS = 3
"""Smallest number of blocks of a short rest from the start. A device with a slow sensor may start to move before its
first rest is confirmed. The rest lasts at least as long as a fast sensor needs for a confirmation."""

GATE_SIGMAS = 4.0
"""Distance of a block mean from the mean of the segment, in sigmas, that begins another segment."""

SLOPE_SIGMAS = 2.0
"""Largest difference of the two ends of a segment at its confirmation, in sigmas. The ends of a curve differ."""

GRADUAL_DPS_S = 0.4
"""Largest change of the rate at a gradual end, deg/s². The blocks after a gradual end are also stationary."""

MAX_GAP_BLOCKS = 10
"""Largest number of blocks between a segment and the segment that it resumes, or between the start and the beginning
of a segment from the start."""

START_SIGMAS = 6.0
"""Largest range of the block means up to a rest from the start, in sigmas of a block mean. The range of fourteen normal
numbers is seldom larger."""

LONG_SEGMENT_S = 15.0
LONG_GATE_SIGMAS = 6.0
"""Length in s from which on the gate for the next segment is wider, and this gate in sigmas. After a long segment, a
larger difference is a jump of the bias rather than a spin."""

MEAN_BLOCKS = 10
"""Number of blocks in the mean of a segment."""


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
    blocks_before, mean_before_dps, was_confirming = segment.blocks, segment.mean_dps, confirming_blocks(segment)
    seconds_before, sensor_odds_before, was_loud = segment.seconds, segment.sensor_odds, segment.is_loud
    loud_var_before = s.noise.loud_var
    is_now_stationary = not s.noise.is_frozen and is_stationary(c, s.block, s.noise) and s.witness.moving == 0
    is_short_start = not is_now_stationary and _is_short_start(c, s, seconds)
    is_loud = not is_now_stationary and not s.noise.is_frozen and s.witness.moving == 0
    is_loud = is_loud and is_steadily_loud(s.block, s.noise)
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
        s.noise.loud_blocks = 0
    if is_now_stationary or is_loud:
        if segment.is_loud != is_loud:
            segment.blocks = 0
        segment.is_loud = is_loud
        if segment.blocks == 0 and is_loud:
            segment.loud_mean_var = s.noise.loud_var / s.block.samples
        _take_block(segment, s.noise, mean_dps, c.rate_ramp_dps_s * seconds, seconds, s.block.samples)
        if segment.blocks > 1:
            step_var = segment.sum_squares / (segment.blocks - 1)
            segment.averages_out = 0.25 * s.block.samples * step_var < WHITE_SCATTER * (s.noise.loud_var if is_loud else s.noise.sample_var)
            segment.sensor_odds = 0.0 if is_loud else sensor_odds(_scatter_var(segment, s.noise, s.block.samples))
    else:
        segment.blocks = 0
    segment.last_mean_dps = mean_dps
    ended.short_start_blocks = blocks_before if is_short_start else 0
    if is_short_start or (blocks_before >= was_confirming > segment.blocks):
        ended.mean_dps, ended.blocks_ago = mean_before_dps, 0
        ended.seconds, ended.sensor_odds = seconds_before, sensor_odds_before
        ended.was_loud, ended.loud_var = was_loud, loud_var_before
        ended.ended_gradually = not was_loud and is_now_stationary and abs(step_dps) < GRADUAL_DPS_S * seconds
    ended.blocks_ago += 1


def confirming_blocks(segment: RateSegment) -> int:
    """Number of blocks that confirm a segment."""
    return LOUD_BLOCKS if segment.is_loud else CONFIRMED_BLOCKS


def block_mean_var(segment: RateSegment, noise: NoiseModel, seconds: float) -> float:
    """Variance of a block mean of the segment, (deg/s)²."""
    return segment.loud_mean_var if segment.is_loud else noise.angle_walk_var / seconds


def goes_on_gradually(s: RestlevelState, step_dps: float, seconds: float) -> bool:
    """Whether the block after the end of a segment also changes gradually."""
    return s.wander.was_stationary and abs(step_dps) < GRADUAL_DPS_S * seconds


def is_from_start(s: RestlevelState, seconds: float) -> bool:
    """Whether a segment is from the start: in the first blocks, without motion before."""
    segment = s.segment
    mean_var = s.noise.angle_walk_var / seconds
    range_dps = segment.most_dps - segment.least_dps
    return not segment.is_loud and s.blocks < MAX_GAP_BLOCKS + CONFIRMED_BLOCKS and range_dps < START_SIGMAS * sqrt(mean_var)


def mean_blocks(segment: RateSegment) -> int:
    """Number of blocks in the mean of the segment."""
    return segment.blocks if segment.is_loud else min(segment.blocks, MEAN_BLOCKS)


def update_mean(segment: RateSegment, mean_dps: float) -> None:
    """Update the mean of the segment by a further block."""
    segment.mean_dps += (mean_dps - segment.mean_dps) / mean_blocks(segment)


def continues(
    c: RestlevelCoefficients, segment: RateSegment, ended: EndedSegment, noise: NoiseModel, seconds: float
) -> bool:
    """Whether a confirmed segment resumes the segment before; `seconds` is the length of a block, s."""
    mean_var = block_mean_var(segment, noise, seconds)
    ramp_dps = c.rate_ramp_dps_s * seconds * ended.blocks_ago
    gate_var = mean_var * (1.0 / CONFIRMED_BLOCKS + 1.0 / MEAN_BLOCKS) + ramp_dps * ramp_dps + noise.flicker_var
    sigmas = LONG_GATE_SIGMAS if ended.seconds >= LONG_SEGMENT_S else GATE_SIGMAS
    innovation_dps = segment.mean_dps - ended.mean_dps
    is_soon = ended.blocks_ago <= MAX_GAP_BLOCKS + CONFIRMED_BLOCKS
    if segment.is_loud != ended.was_loud:
        return False
    if segment.is_loud:
        away = log(noise.loud_var / ended.loud_var)
        if away * away > LOUD_SPREAD * LOUD_SPREAD:
            return False
    return is_soon and abs(innovation_dps) < sigmas * sqrt(gate_var)


def _is_short_start(c: RestlevelCoefficients, s: RestlevelState, seconds: float) -> bool:
    """Whether a present block in motion ends a short rest from the start."""
    blocks = s.segment.blocks
    is_long_enough = blocks >= SHORT_BLOCKS and blocks * seconds >= CONFIRMED_BLOCKS * c.window_s
    return is_long_enough and not s.segment.is_loud and blocks < CONFIRMED_BLOCKS and is_from_start(s, seconds)


def _follow_wander(c: RestlevelCoefficients, s: RestlevelState, mean_dps: float, seconds: float) -> None:
    """Update the agreement of levels by a stationary block that follows a stationary block.

    Blocks inside a confirmed segment do not count, because a confirmed level is no chance level.
    """
    segment = s.segment
    mean_var, ramp_dps = s.noise.angle_walk_var / seconds, c.rate_ramp_dps_s * seconds
    if segment.blocks > 0 and not _is_in_gate(segment, mean_dps, mean_var, ramp_dps, s.noise.flicker_var):
        count_break(s.wander, mean_dps - segment.mean_dps)
    elif segment.blocks < CONFIRMED_BLOCKS:
        count_agreement(s.wander)


def _take_block(segment: RateSegment, noise: NoiseModel, mean_dps: float, ramp_dps: float, seconds: float, samples: int) -> None:
    """Extend the segment by a stationary block, or begin another segment."""
    mean_var = block_mean_var(segment, noise, seconds)
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
    if segment.is_loud:
        steps_var = 0.5 * segment.sum_squares
        blocks = LOUD_PRIOR_BLOCKS
        first_var = noise.loud_var / samples
        segment.loud_mean_var = mean_var = (blocks * first_var + steps_var) / (blocks + segment.blocks - 1)
        if mean_var > max(LOUD_MEAN_VAR, noise.loud_var / samples):
            segment.blocks = 0
    if segment.blocks == confirming_blocks(segment):
        slope_dps = 0.5 * (segment.last_mean_dps + mean_dps - segment.head_sum_dps)
        if abs(slope_dps) >= SLOPE_SIGMAS * sqrt(mean_var + 4.0 * ramp_dps * ramp_dps):
            segment.blocks = 0


def _scatter_var(segment: RateSegment, noise: NoiseModel, samples: int) -> float:
    """Scatter of the segment as a variance of samples, (deg/s)².

    It is the variance of the samples, or the variance that the steps between block means imply, if that is smaller. A
    vibration averages out within a block, a motion does not. For white noise the second is half of the first.
    """
    step_var = segment.sum_squares / (segment.blocks - 1)
    return max(MIN_VAR, min(noise.loud_var if segment.is_loud else noise.sample_var, 0.25 * samples * step_var))


def _is_in_gate(segment: RateSegment, mean_dps: float, mean_var: float, ramp_dps: float, flicker_var: float) -> bool:
    """Whether a block mean may belong to the segment."""
    gate_var = mean_var * (1.0 + 1.0 / mean_blocks(segment)) + ramp_dps * ramp_dps + flicker_var
    return abs(mean_dps - segment.mean_dps) < GATE_SIGMAS * sqrt(gate_var)
