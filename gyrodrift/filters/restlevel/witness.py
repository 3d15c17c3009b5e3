"""Witness of rest: an external sensor, such as wheels or a charger, that reports whether the device stands still.

Its report overrides the statistics of the rate. If all samples of a block have a report of rest, the block is a certain
rest, without confirmation and without a branch. A block with a report of motion is no rest.

A report of rest that the rate contradicts is ignored and counted. A report that is a little late at the beginning or
end of a rest does no harm. A witness that reports rest in turns is refuted after one or two seconds of a turn. It is
then ignored until a block without a report of rest. The variance of the bias grows by the square of its change during
the report.
"""

from math import exp, sqrt

from gyrodrift.filters.beliefs import MAJORITY, MAX_RAMP_S
from gyrodrift.filters.contradictions import FIT_SIGMAS, MOST_FIRST, count_contradiction, count_fit
from gyrodrift.filters.restlevel.bias_state import Witness
from gyrodrift.filters.restlevel.kalman import first_kalman_update, gaussian_logpdf, kalman_update
from gyrodrift.filters.restlevel.mixture import merge_and_prune
from gyrodrift.filters.restlevel.model import RestlevelCoefficients, RestlevelState
from gyrodrift.filters.restlevel.noise import FLICKER_CLIP, learn_at_rest
from gyrodrift.filters.restlevel.segments import CONFIRMED_BLOCKS, is_confirmed
from gyrodrift.filters.restlevel.slide import mark_safe

AGREEMENT_SIGMAS = 4.0
"""Largest distance of contradicting blocks of the same level, in sigmas: a bias that has jumped, or a constant turn.
Chosen: the gate of a segment, `segments.GATE_SIGMAS`."""

MOST_JUMP = 1.0
"""Largest jump of a known bias, in sigmas of the turn-on bias. Chosen: a larger level is a turn."""

FIRST_BLOCKS = 2
"""Number of contradicting blocks of the same level that show a first bias. A jump of a known bias needs
`CONFIRMED_BLOCKS`. Chosen."""


def hear(witness: Witness, still: float) -> None:
    """Count the report of a sample: 1 at rest, 0 in motion."""
    if still == 1.0:
        witness.still += 1
    else:
        witness.moving += 1


def is_certain_rest(c: RestlevelCoefficients, s: RestlevelState, mean_dps: float, seconds: float) -> bool:
    """Whether the present block is a certain rest; contradictions are counted.

    Parameters
    ----------
    c, s
        Coefficients, and the state before the block, but with noise and segment after it. The witness is changed.
    mean_dps, seconds
        Mean and length of the block, deg/s and s.
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
        count_fit(w)
        w.agreeing_blocks = 0
        return True
    return _is_new_level(c, s, mean_dps, mean_var, seconds)


def noisy_mean_var(s: RestlevelState, seconds: float) -> float:
    """Variance of a block mean, (deg/s)²; larger for a block with more noise than the sensor at rest, as by a motor.

    Before a rest has measured the noise, the variance follows from the scatter of the block.
    """
    noise = s.noise
    ratio = noise.last_block_var / noise.sample_var
    return noise.angle_walk_var / seconds * (max(1.0, ratio) if noise.is_walk_measured else ratio)


def stand_still(c: RestlevelCoefficients, s: RestlevelState, mean_dps: float, step_dps: float, seconds: float) -> None:
    """Update all hypotheses by the mean of a certain rest, and weigh them by its likelihood."""
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
    """End certain rests: without a confirmed segment no hypothesis stays at rest."""
    if not is_confirmed(s.segment):
        for h in s.hypotheses:
            h.is_at_rest = False


def _is_new_level(
    c: RestlevelCoefficients, s: RestlevelState, mean_dps: float, mean_var: float, seconds: float
) -> bool:
    """Whether contradicting blocks up to the present one show a first bias, or a bias that has jumped."""
    w = s.witness
    ramp_dps = c.rate_ramp_dps_s * seconds
    spread_var = 2.0 * mean_var + ramp_dps * ramp_dps + s.noise.flicker_var
    if w.agreeing_blocks > 0 and abs(mean_dps - w.level_dps) < AGREEMENT_SIGMAS * sqrt(spread_var):
        w.agreeing_blocks += 1
        w.level_dps += (mean_dps - w.level_dps) / w.agreeing_blocks
    else:
        w.agreeing_blocks, w.level_dps = 1, mean_dps
    known_weight = 0.0
    for h in s.hypotheses:
        if h.weight > 0.0 and h.knows_bias:
            known_weight += h.weight
    is_known = known_weight > MAJORITY
    away_dps, most = (w.level_dps - s.bias_dps, MOST_JUMP) if is_known else (w.level_dps, MOST_FIRST)
    has_level = w.agreeing_blocks >= (CONFIRMED_BLOCKS if is_known else FIRST_BLOCKS)
    if has_level and away_dps * away_dps < most * most * c.turn_on_var:
        if is_known:  # the first update widens an unknown bias itself
            _widen_bias(s, away_dps * away_dps)
        w.contradictions, w.agreeing_blocks = 0.0, 0
        return True
    if count_contradiction(w):
        learned_dps = s.bias_dps - w.before_dps
        _widen_bias(s, learned_dps * learned_dps)
        w.agreeing_blocks = 0
    return False


def _widen_bias(s: RestlevelState, variance: float) -> None:
    """Add a variance to the bias of all hypotheses, (deg/s)²."""
    for h in s.hypotheses:
        h.bias_var += variance
