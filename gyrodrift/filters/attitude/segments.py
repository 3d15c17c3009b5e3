"""Segments: runs of rest candidates with the same mean rates, and the branches at their beginning."""

import numpy as np

from gyrodrift.filters.attitude.block import RAD
from gyrodrift.filters.attitude.hypotheses import BIAS, REST, UNDECIDED
from gyrodrift.filters.attitude.mixture import merge_and_prune
from gyrodrift.filters.attitude.model import AttitudeCoefficients, AttitudeState
from gyrodrift.filters.attitude.regimes import branch, is_same_rest, measure_rest, weigh_duration
from gyrodrift.filters.attitude.rests import GYRO_SPREAD, QUIET, RestCandidate, Segment, find_rest
from gyrodrift.filters.attitude.vertical import (
    begin_level,
    begin_slide,
    end_level,
    follow_bias,
    follow_level,
    leaves_level,
    resume_level,
    resumes_level,
    slopes,
)
from gyrodrift.filters.attitude.witness import certain_rest, keep_rests
from gyrodrift.filters.beliefs import MAJORITY

UPDATE_BLOCKS = 10
"""Blocks between two updates of a rest. Measured: recordings of five rigs, median heading error."""

START_BLOCKS = 4
"""Blocks by which a rest may begin after the first sample and still be one from the start. Chosen: 0.4 s at the default
`window_s`."""

CERTAIN_ODDS = 1e9
"""Prior odds of a rest that a witness reports, and that fits the bias. Chosen: far above `CERTAIN`, so that turns have
no share."""

GYRO_NOISE = 0.02 * RAD
"""Least angle random walk of a gyro, rad/√s. Measured: recordings of five rigs, median heading error."""

NOISE_SHARE = 0.05
"""Weight of a block at rest in the angle random walk: 2 s. Chosen."""

RESUME_BLOCKS = 11
"""Blocks after which a segment with the same rates is another one: ten lie between, as in restlevel."""

QUIET_ODDS = 4.0
"""Odds of a rest by an accelerometer as quiet as the gyro: vehicles in a bend shake. Chosen: with `rest_share` 0.2
rests and turns are equally frequent. The first sample has `still_start` alone, whatever the accelerometer. A segment
after one that ended gradually has `rest_share` alone: the accelerometer was quiet all the time."""


def follow_rest(c: AttitudeCoefficients, s: AttitudeState) -> None:
    """Find a rest candidate that ends with this block, and branch or update the hypotheses by it."""
    segment = s.segment
    if s.block.moving > 0:
        s.windows.blocks = 0
    certain = certain_rest(c, s)
    is_resting = segment.blocks > 0 or bool(s.hypotheses.knows_bias[0])
    candidate = certain or find_rest(s.windows, c.limits, is_resting=is_resting)
    goes_on = candidate is not None and continues(c, s, candidate)
    if candidate is not None and certain is None and end_between_levels(c, s, candidate, goes_on=goes_on):
        candidate = None
    if candidate is None:
        end_segment(s)
    elif goes_on:
        continue_segment(c, s, candidate)
    else:
        begin_segment(c, s, candidate, is_certain=certain is not None)
    if certain is not None:
        keep_rests(s)
    if s.rest_probability > MAJORITY and candidate is not None:
        learn_noise(c, s, candidate)


def end_between_levels(c: AttitudeCoefficients, s: AttitudeState, candidate: RestCandidate, *, goes_on: bool) -> bool:
    """End the segment by a window with blocks of two levels; return whether it is one, or its rate still changes."""
    if s.segment.blocks == 0:
        return slopes(c, s, candidate)
    if not goes_on:
        end_level(c, s)
    return not goes_on


def continue_segment(c: AttitudeCoefficients, s: AttitudeState, candidate: RestCandidate) -> None:
    """Resume or lengthen a segment by a candidate that ends with this block."""
    segment = s.segment
    resumes, segment.blocks = segment.blocks == 0, candidate.kind.blocks
    if resumes:
        segment.since, was_brief = 0, segment.level_blocks < QUIET.blocks
        resume_level(s, candidate)
        update_rest(s, candidate, 1.0)
        if was_brief:
            begin_slide(s)
        return
    follow_level(s)
    segment.since += 1
    if segment.since >= UPDATE_BLOCKS:
        let_drift(c, s)
        lengthen(c, s)
        update_rest(s, candidate, max(candidate.kind.blocks, QUIET.blocks) / QUIET.blocks)
        follow_bias(c, s, UPDATE_BLOCKS * c.block_s)


def learn_noise(c: AttitudeCoefficients, s: AttitudeState, candidate: RestCandidate) -> None:
    """Follow the angle random walk of the gyro by the scatter of block means at rest."""
    s.noise_var += NOISE_SHARE * (float(candidate.gyro_var.mean()) * c.block_s - s.noise_var)


def begin_segment(c: AttitudeCoefficients, s: AttitudeState, candidate: RestCandidate, *, is_certain: bool) -> None:
    """Branch all hypotheses by a new candidate."""
    is_from_start = s.windows.total <= candidate.kind.blocks + START_BLOCKS
    odds = c.start_odds if is_from_start else c.rest_odds
    is_at_first = s.watch.restarts == 0 and is_from_start
    odds *= 1.0 if is_at_first or left_gradually(s) else QUIET_ODDS
    odds = CERTAIN_ODDS if is_certain else odds
    s.hypotheses = merge_and_prune(branch(c, s.hypotheses, candidate, odds, s.turn_on_bias))
    s.segment = Segment(candidate.kind.blocks, 0, 0, candidate.kind.blocks * c.block_s, candidate.gyro)
    begin_level(s, candidate)


def end_segment(s: AttitudeState) -> None:
    """End the segment; after some blocks it cannot resume, and all hypotheses are undecided."""
    segment = s.segment
    segment.ago = 1 if segment.blocks > 0 else segment.ago + 1
    segment.blocks = 0
    if segment.ago == RESUME_BLOCKS:
        s.hypotheses.regime[:] = UNDECIDED


def left_gradually(s: AttitudeState) -> bool:
    """Whether the last segment has just ended gradually: the device has not moved since but for a slow turn."""
    return s.segment.ended_gradually and s.segment.ago < RESUME_BLOCKS


def continues(c: AttitudeCoefficients, s: AttitudeState, candidate: RestCandidate) -> bool:
    """Whether a window has the rates of the present or the last segment, and the bias of its rest."""
    segment, h = s.segment, s.hypotheses
    if segment.seconds == 0.0 or (segment.blocks == 0 and segment.ago >= RESUME_BLOCKS):
        return False
    if leaves_level(c, s, candidate) if segment.blocks > 0 else not resumes_level(c, s, candidate):
        return False
    limit = max(candidate.kind.gyro, 1.0) * GYRO_SPREAD
    may_drift = candidate.kind is QUIET and bool((h.regime == REST).any())
    is_near = may_drift or bool(np.abs(candidate.gyro - segment.gyro).max() < 2.0 * limit)
    return is_near and is_same_rest(h, candidate, segment.undone * segment.up)


def let_drift(c: AttitudeCoefficients, s: AttitudeState) -> None:
    """Widen the biases of rests by half of the fastest drift since the last update."""
    drift = 0.5 * c.drift_rate * s.segment.since * c.block_s
    s.hypotheses.cov[s.hypotheses.regime == REST, BIAS, BIAS] += drift * drift * np.eye(3)


def lengthen(c: AttitudeCoefficients, s: AttitudeState) -> None:
    """Count the blocks since the last update in the duration of the segment, and weigh it."""
    segment = s.segment
    seconds = segment.seconds + segment.since * c.block_s
    weigh_duration(s.hypotheses, segment.seconds, seconds)
    segment.seconds, segment.since = seconds, 0


def update_rest(s: AttitudeState, candidate: RestCandidate, overlap: float) -> None:
    """Measure the bias of hypotheses of rest again by a later window."""
    h = s.hypotheses
    is_rest = h.regime == REST
    rests = h.select(is_rest)
    if len(rests.weight):
        measure_rest(rests, candidate, overlap)
        s.hypotheses = merge_and_prune(rests.joined(h.select(~is_rest)))
