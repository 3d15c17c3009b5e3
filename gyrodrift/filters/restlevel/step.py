"""Step of restlevel for a sample, in plain floats, for `serve`, `filter`, `tune` and `compare`.

Batch versions compile this source, and a test compares their bits with it.
"""

from math import nan, sqrt

from gyrodrift.filters.gaps import count_correction, longest_step_s
from gyrodrift.filters.limits import LEAST_STEP_S, MOST_DPS, MOST_S, SAME_TIME_S
from gyrodrift.filters.restlevel.frozen import detect_freeze, widen_yaw
from gyrodrift.filters.restlevel.gap import pass_gap
from gyrodrift.filters.restlevel.hypotheses import (
    begin,
    branch,
    branch_at_end,
    end_gradually,
    enter_segment,
    leave_segment,
    predict,
    restart,
    resume,
    weigh_noisy_rests,
    zero_velocity_update,
)
from gyrodrift.filters.restlevel.mixture import collapse
from gyrodrift.filters.restlevel.model import (
    COLDEST_C,
    WARMEST_C,
    RestlevelCoefficients,
    RestlevelParams,
    RestlevelState,
)
from gyrodrift.filters.restlevel.noise import FINE_DPS, begins_to_measure
from gyrodrift.filters.restlevel.recall import recall_noise
from gyrodrift.filters.restlevel.segments import (
    CONFIRMED_BLOCKS,
    confirming_blocks,
    continues,
    goes_on_gradually,
    is_confirmed,
    track_segment,
    update_mean,
)
from gyrodrift.filters.restlevel.temperature import follow_temperature, learn_when_sure
from gyrodrift.filters.restlevel.turns import add_mean_rate, follow_turns, weigh_turns
from gyrodrift.filters.restlevel.witness import end_certain_rest, hear, is_certain_rest, stand_still

LEAST_VAR = 1e-24
"""Smallest variance of a turn-on bias, (deg/s)². Chosen: below that of any gyro, and large enough to divide by."""

MIN_BLOCK_SAMPLES = 6
"""Smallest number of samples in a block. Chosen: the variance of fewer samples is too uncertain, and twelve had larger
errors (docs/blind-alleys.md)."""

TURN_DEG = 30.0
"""Angle of a turn, deg. Errors of scale and cross axes are equal within a turn, and independent between turns.
Chosen."""


def coefficients(params: RestlevelParams) -> RestlevelCoefficients:
    """Coefficients of the parameters."""
    return RestlevelCoefficients(
        window_s=params.window_s,
        stationarity_sigmas=params.quiet,
        turn_on_var=max(LEAST_VAR, params.turn_on_dps * params.turn_on_dps) if params.turn_on_dps > 0.0 else 0.0,
        rate_walk_var=params.walk_dps_rts * params.walk_dps_rts,
        rate_ramp_dps_s=params.drift_dps_s,
        start_odds=params.still_start / (1.0 - params.still_start),
        rest_odds=params.rest_share / (1.0 - params.rest_share),
        scale_sigma=params.scale_percent / 100.0,
    )


def step(
    c: RestlevelCoefficients,
    s: RestlevelState,
    t_s: float,
    rate_dps: float,
    still: float = nan,
    temp_c: float = nan,
) -> bool:
    """Advance the state by one sample.

    Parameters
    ----------
    c, s
        Coefficients, and the state, which is changed in place.
    t_s
        Device time, s, as a plain float.
    rate_dps
        Measured rate, deg/s, counter-clockwise positive, as a plain float.
    still
        Report of an external rest sensor: 1 at rest, 0 in motion, NaN without a report.
    temp_c
        Temperature of the sensor, °C; NaN if unknown.

    Returns
    -------
    bool
        False if the sample is rejected, because T ≤ 0, or because its time or rate is not finite or exceeds a limit. A
        rejected sample changes only `s.rejected`. After a restart any time is accepted.
    """
    dt_s = t_s - s.t_s if s.samples > 0 else 0.0
    is_within = -MOST_S <= t_s <= MOST_S and -MOST_DPS <= rate_dps <= MOST_DPS
    if not is_within or (s.samples > 0 and dt_s < LEAST_STEP_S):
        if not is_within or not s.watch.has_restarted:
            s.rejected += 1
            return False
        dt_s = LEAST_STEP_S  # the clock has restarted too
    s.t_s = t_s
    advance(c, s, dt_s, rate_dps, still, temp_c)
    return True


def advance(
    c: RestlevelCoefficients, s: RestlevelState, dt_s: float, rate_dps: float, still: float, temp_c: float
) -> None:
    """Advance the state by a valid sample, `dt_s` after the sample before; 0 for the first sample."""
    block, noise, moments = s.block, s.noise, s.moments
    if s.samples == 0:
        s.start_yaw_deg = s.yaw_deg
        s.rate_dps = rate_dps
        begin(c, s)
    elif dt_s > s.watch.longest_step_s:
        expected_deg = moments.yaw_deg + block.angle_deg - s.bias_dps * block.seconds
        pass_gap(c, s, dt_s, rate_dps)
        count_correction(s, moments.yaw_deg - expected_deg)
        dt_s = 0.0
    if still >= 0.0:  # false for NaN
        hear(s.witness, still)
    if COLDEST_C < temp_c < WARMEST_C:
        s.temp_c = temp_c
    step_dps = abs(rate_dps - s.rate_dps)
    if step_dps > 0.0 and (step_dps < noise.resolution_dps or noise.resolution_dps < 0.0):
        noise.resolution_dps = step_dps
    if block.samples < 2:
        if block.samples == 0:
            block.origin_dps = rate_dps
        if dt_s > 0.0:  # no gap: the correction is that of the sample before
            s.correction_deg = 0.0
    above_dps = rate_dps - block.origin_dps
    seconds = block.seconds + dt_s
    block.seconds = seconds
    block.samples += 1
    block.repeats += int(step_dps == 0.0 < noise.resolution_dps <= FINE_DPS)
    block.sum_dps += above_dps
    block.sum_squares += above_dps * above_dps
    block.angle_deg += 0.5 * (rate_dps + s.rate_dps) * dt_s
    s.rate_dps = rate_dps
    s.samples += 1
    if seconds > c.window_s - SAME_TIME_S and block.samples >= MIN_BLOCK_SAMPLES:
        expected_deg = moments.yaw_deg + block.angle_deg - s.bias_dps * seconds
        _end_block(c, s, seconds)
        count_correction(s, moments.yaw_deg - expected_deg)
        seconds = 0.0
    yaw_deg = moments.yaw_deg + block.angle_deg - s.bias_dps * seconds
    net_deg = yaw_deg - s.start_yaw_deg
    scale_var = c.scale_sigma * c.scale_sigma * (net_deg * net_deg + TURN_DEG * s.travelled_deg)
    angle_walk_var = max(0.0, noise.angle_walk_var)
    moving_var = seconds * (moments.bias_var * seconds - 2.0 * moments.covariance + angle_walk_var)
    s.yaw_deg = yaw_deg
    s.yaw_sigma_deg = sqrt(max(0.0, moments.yaw_var + moving_var + scale_var))


def _end_block(c: RestlevelCoefficients, s: RestlevelState, seconds: float) -> None:
    """Pass a complete block to segments and hypotheses, and begin the next block."""
    block, segment = s.block, s.segment
    s.lived_s += seconds
    s.travelled_s += seconds
    s.watch.longest_step_s = longest_step_s(seconds / block.samples)
    mean_dps = block.angle_deg / seconds
    step_dps = mean_dps - segment.last_mean_dps
    if begins_to_measure(s.noise):
        restart(c, s)
    if s.blocks == 0:
        recall_noise(s, seconds)
    detect_freeze(s)
    track_segment(c, s, mean_dps, step_dps, seconds)
    weigh_noisy_rests(s)
    _leave(c, s, step_dps, seconds)
    if segment.blocks == 1:
        enter_segment(s)
    follow_temperature(s, seconds)
    is_certain = is_certain_rest(c, s, mean_dps, seconds)
    if is_certain:
        stand_still(c, s, mean_dps, step_dps, seconds)
    elif s.witness.was_certain:
        end_certain_rest(s)
    predict(c, s, block.angle_deg, seconds)
    widen_yaw(s, seconds)
    is_confirming = segment.blocks == confirming_blocks(segment)
    if not is_certain and is_confirmed(segment) and not is_confirming:
        zero_velocity_update(c, s, mean_dps, step_dps, seconds)
    if segment.blocks > 1:
        update_mean(segment, mean_dps)
    if not is_certain and is_confirming:
        _confirm(c, s, seconds)
    elif segment.is_vibrating or segment.blocks < CONFIRMED_BLOCKS:
        follow_turns(s.turns, block.angle_deg, seconds)
    weigh_turns(s)
    collapse(c, s)
    learn_when_sure(c, s, seconds, is_certain)
    s.travelled_deg += abs(block.angle_deg - s.bias_dps * seconds)
    s.witness.was_certain = is_certain
    s.witness.still = s.witness.moving = 0
    block.seconds = 0.0
    block.samples = block.repeats = 0
    block.angle_deg = 0.0
    block.sum_dps = 0.0
    block.sum_squares = 0.0


def _confirm(c: RestlevelCoefficients, s: RestlevelState, seconds: float) -> None:
    """Resume the segment before, or branch the hypotheses, when a segment is confirmed."""
    if continues(c, s, seconds):
        s.segment.seconds += s.ended.seconds
        resume(c, s, seconds)
    else:
        branch(c, s, seconds)
        if not s.segment.is_vibrating and not s.ended.ended_gradually:  # after a gradual end it is the same turn
            add_mean_rate(s.turns, s.segment.mean_dps)


def _leave(c: RestlevelCoefficients, s: RestlevelState, step_dps: float, seconds: float) -> None:
    """Process the end of the last segment, if it ended with this block or with the block before."""
    if s.ended.short_start_blocks > 0:
        branch_at_end(c, s, seconds)
    if s.ended.blocks_ago == 1:
        leave_segment(s)
    if s.ended.blocks_ago == 2 and s.ended.ended_gradually:
        s.ended.ended_gradually = goes_on_gradually(s, step_dps, seconds)
        if s.ended.ended_gradually:
            end_gradually(s)
