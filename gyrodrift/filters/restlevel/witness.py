"""A witness of rest: something else than the rate that says whether the device stands still, as wheels and chargers do.

Its word beats every statistic. A block whose samples are all said to stand still is a rest from its first sample on,
with no wait and no alternative; in one with a sample that is said to move nothing is taken for a rest.

A word of rest that the rate contradicts is not used, and is counted. One that comes a little late at either end of a
rest does no harm; one that is stuck in turns is found out within a second or two of turning. From then on it is not
believed until it has said something else, and what it taught is as doubtful as it is far from what was known before.
"""

from math import exp, sqrt

from gyrodrift.filters.restlevel.bias_state import Witness
from gyrodrift.filters.restlevel.kalman import MAX_RAMP_S, first_kalman_update, gaussian_logpdf, kalman_update
from gyrodrift.filters.restlevel.mixture import merge_and_prune
from gyrodrift.filters.restlevel.model import RestlevelCoefficients, RestlevelState
from gyrodrift.filters.restlevel.noise import FLICKER_CLIP, learn_at_rest
from gyrodrift.filters.restlevel.segments import CONFIRMED_BLOCKS
from gyrodrift.filters.restlevel.slide import mark_safe

FIT_SIGMAS = 6.0
"""A block mean further from the bias than this contradicts that the device stands still."""

AGREEMENT_SIGMAS = 4.0
"""Contradicting blocks within this of each other have one level: a bias that has jumped, or a constant turn."""

MOST_CONTRADICTIONS = 5.0
"""Contradicting blocks after which a witness is not believed."""

FIT_CREDIT = 0.1
"""Doubt that each block takes away which fits."""

MOST_FIRST, MOST_JUMP = 20.0, 1.0
"""How far out a bias may be that no rest has shown yet, and how far one jumps that is known, in sigmas of the turn-on
bias. What is further away is a turn."""

FIRST_BLOCKS = 2
"""Contradicting blocks of one level that show a bias which no rest has shown yet; of one that jumps it takes as many as
confirm a segment."""

MAJORITY = 0.5
"""Probability from which on hypotheses that know a bias stand for all."""


def hear(witness: Witness, still: float) -> None:
    """What is said of one sample: 1 stands still, 0 moves."""
    if still == 1.0:
        witness.still += 1
    else:
        witness.moving += 1


def is_certain_rest(c: RestlevelCoefficients, s: RestlevelState, mean_dps: float, seconds: float) -> bool:
    """Whether the block that has just ended is a rest by a witness that is believed; doubt is counted.

    Parameters
    ----------
    c, s
        Coefficients, and the state as before the block but for noise and segment; the witness is changed.
    mean_dps, seconds
        Mean and length of the block.
    """
    w = s.witness
    w.since_s = seconds if s.rest_probability > MAJORITY else w.since_s + seconds
    reports_rest = w.moving == 0 and w.still == s.block.samples
    if not reports_rest:
        w.is_believed, w.is_reporting_rest, w.agreeing_blocks = True, False, 0
        return False
    if not w.is_reporting_rest:
        w.is_reporting_rest, w.before_dps = True, s.bias_dps
    if not w.is_believed:
        return False
    mean_var, ramp_dps = noisy_mean_var(s, seconds), c.rate_ramp_dps_s * min(w.since_s, MAX_RAMP_S)
    fit_var = s.moments.bias_var + mean_var + s.noise.flicker_var + ramp_dps * ramp_dps
    if abs(mean_dps - s.bias_dps) < FIT_SIGMAS * sqrt(fit_var):
        w.contradictions, w.agreeing_blocks = max(0.0, w.contradictions - FIT_CREDIT), 0
        return True
    return _is_new_level(c, s, mean_dps, mean_var, seconds)


def noisy_mean_var(s: RestlevelState, seconds: float) -> float:
    """Variance of a block mean, (deg/s)², larger where the block is louder than the sensor: a motor that runs.

    Before a rest has shown the noise, it is what the scatter of this block makes of it.
    """
    noise = s.noise
    louder = noise.last_block_var / noise.sample_var
    return noise.angle_walk_var / seconds * (max(1.0, louder) if noise.is_walk_measured else louder)


def stand_still(c: RestlevelCoefficients, s: RestlevelState, mean_dps: float, step_dps: float, seconds: float) -> None:
    """A certain rest: in every hypothesis the block mean is the bias, which also weighs those that come from motion."""
    mean_var, flicker_var = noisy_mean_var(s, seconds), s.noise.flicker_var
    if not s.noise.is_walk_measured:
        s.noise.sample_var, s.noise.angle_walk_var = s.noise.last_block_var, mean_var * seconds
    best, excess_var = -1e300, 0.0
    for h in s.hypotheses:
        if h.weight > 0.0:
            drift_dps = c.rate_ramp_dps_s * (seconds if h.is_at_rest else min(h.moving_s, MAX_RAMP_S))
            h.odds = gaussian_logpdf(mean_dps - h.bias_dps, h.bias_var + drift_dps * drift_dps + mean_var + flicker_var)
            best = max(best, h.odds)
    ramp_var = c.rate_ramp_dps_s * c.rate_ramp_dps_s * seconds * seconds
    for h in s.hypotheses:
        if h.weight == 0.0:
            continue
        if h.is_at_rest:
            innovation_dps = mean_dps - h.bias_dps
            excess_var += h.weight * (innovation_dps * innovation_dps - h.bias_var - mean_var - flicker_var)
            kalman_update(h, mean_dps, mean_var, ramp_var)
        else:
            first_kalman_update(c, h, mean_dps, mean_var)
        h.weight *= exp(h.odds - best)
        h.is_at_rest = True
        h.moving_s = 0.0
        h.odds = h.rest_odds = 1.0
        mark_safe(h)
        h.chance_density = h.noisy_density = 0.0
    if s.witness.was_certain:
        excess_var = min(excess_var, FLICKER_CLIP * (mean_var + flicker_var))
        learn_at_rest(s.noise, 1.0, excess_var, step_dps, s.block, seconds)
    merge_and_prune(s)


def end_certain_rest(s: RestlevelState) -> None:
    """The witness says nothing of rest any more: without a confirmed segment nothing else says so."""
    if s.segment.blocks < CONFIRMED_BLOCKS:
        for h in s.hypotheses:
            h.is_at_rest = False


def _is_new_level(
    c: RestlevelCoefficients, s: RestlevelState, mean_dps: float, mean_var: float, seconds: float
) -> bool:
    """A block contradicts the word: whether it is the last of those that show a bias that has jumped."""
    w = s.witness
    ramp_dps = c.rate_ramp_dps_s * seconds
    spread_var = 2.0 * mean_var + ramp_dps * ramp_dps + s.noise.flicker_var
    if w.agreeing_blocks > 0 and abs(mean_dps - w.level_dps) < AGREEMENT_SIGMAS * sqrt(spread_var):
        w.agreeing_blocks += 1
        w.level_dps += (mean_dps - w.level_dps) / w.agreeing_blocks
    else:
        w.agreeing_blocks, w.level_dps = 1, mean_dps
    w.contradictions += 1.0
    known = 0.0
    for h in s.hypotheses:
        if h.weight > 0.0 and h.knows_bias:
            known += h.weight
    is_known = known > MAJORITY
    away_dps, most = (w.level_dps - s.bias_dps, MOST_JUMP) if is_known else (w.level_dps, MOST_FIRST)
    has_level = w.agreeing_blocks >= (CONFIRMED_BLOCKS if is_known else FIRST_BLOCKS)
    if has_level and away_dps * away_dps < most * most * c.turn_on_var:
        if is_known:  # of a bias that no rest has shown yet the first update takes care
            _open(s, away_dps * away_dps)
        w.contradictions, w.agreeing_blocks = 0.0, 0
        return True
    if w.contradictions < MOST_CONTRADICTIONS:
        return False
    learned_dps = s.bias_dps - w.before_dps
    _open(s, learned_dps * learned_dps)
    w.is_believed, w.refuted = False, w.refuted + 1
    w.contradictions, w.agreeing_blocks = MOST_CONTRADICTIONS - 1.0, 0
    return False


def _open(s: RestlevelState, variance: float) -> None:
    """The bias of all hypotheses is less certain by this, (deg/s)²."""
    for h in s.hypotheses:
        h.bias_var += variance
