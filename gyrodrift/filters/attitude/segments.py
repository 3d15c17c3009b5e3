"""Segments: runs of rest candidates with the same mean rates, and the branches at their beginning."""

import numpy as np

from gyrodrift.filters.attitude.hypotheses import REST, UNDECIDED
from gyrodrift.filters.attitude.mixture import merge_and_prune
from gyrodrift.filters.attitude.model import AttitudeCoefficients, AttitudeState
from gyrodrift.filters.attitude.regimes import branch, is_same_rest, measure_rest, weigh_duration
from gyrodrift.filters.attitude.rests import GYRO_SPREAD, QUIET, RestCandidate, Segment, find_rest

UPDATE_BLOCKS = 10
"""Blocks between two updates of a rest. Measured: recordings of five rigs, median heading error."""

START_BLOCKS = 4
"""Blocks by which a rest may begin after the first sample and still be one from the start."""

QUIET_ODDS = 4.0
"""Odds of a rest by an accelerometer as quiet as the gyro: vehicles in a bend shake. Chosen: with `rest_share` 0.2
rests and turns are equally frequent."""


def follow_rest(c: AttitudeCoefficients, s: AttitudeState) -> None:
    """Find a rest candidate that ends with this block, and branch or update the hypotheses by it."""
    segment = s.segment
    if s.block.moving > 0:
        s.windows.blocks = 0
    candidate = find_rest(s.windows, c.limits, is_resting=segment.blocks > 0)
    if candidate is None:
        end_segment(s)
        return
    if segment.blocks > 0 and not continues(s, candidate):
        end_segment(s)
    if segment.blocks == 0:
        odds = c.start_odds if s.windows.total <= candidate.kind.blocks + START_BLOCKS else c.rest_odds * QUIET_ODDS
        s.hypotheses = merge_and_prune(branch(c, s.hypotheses, candidate, odds))
        length_s = candidate.kind.blocks * c.block_s
        s.segment = Segment(candidate.kind.blocks, 0, length_s, candidate.gyro)
        return
    segment.blocks = candidate.kind.blocks
    segment.since += 1
    if segment.since >= UPDATE_BLOCKS:
        update_rest(c, s, candidate)


def end_segment(s: AttitudeState) -> None:
    """No candidate any more: all hypotheses are undecided."""
    if s.segment.blocks > 0:
        s.hypotheses.regime[:] = UNDECIDED
        s.segment.blocks = 0


def continues(s: AttitudeState, candidate: RestCandidate) -> bool:
    """Whether a window has the rates with which the segment began, and the bias of its rest."""
    limit = max(candidate.kind.gyro, 1.0) * GYRO_SPREAD
    return bool(np.abs(candidate.gyro - s.segment.gyro).max() < 2.0 * limit) and is_same_rest(s.hypotheses, candidate)


def update_rest(c: AttitudeCoefficients, s: AttitudeState, candidate: RestCandidate) -> None:
    """Measure the bias again by a later window, and weigh the duration of the segment."""
    segment, h = s.segment, s.hypotheses
    passed_s = segment.since * c.block_s
    weigh_duration(h, segment.seconds, segment.seconds + passed_s)
    segment.seconds += passed_s
    segment.since = 0
    is_rest = h.regime == REST
    rests = h.select(is_rest)
    if not len(rests.weight):
        return
    measure_rest(rests, candidate, max(candidate.kind.blocks, QUIET.blocks) / QUIET.blocks)
    s.hypotheses = merge_and_prune(rests.joined(h.select(~is_rest)))
