"""The Gaussian sum as a whole: kept small by merging and pruning, and collapsed to what the filter tells.

Merging keeps the mean and the covariance of the two; pruning forgets what is least probable (Alspach and Sorenson
1972 for the sum of Gaussians; Reid 1979 for trees of hypotheses that are kept small).
"""

from math import sqrt

from gyrodrift.filters.restlevel.bias_state import Hypothesis
from gyrodrift.filters.restlevel.kalman import WIDE_FACTOR
from gyrodrift.filters.restlevel.model import MAX_HYPOTHESES, RestlevelState

MIN_WEIGHT = 1e-9

TAIL = 0.045
"""What is taken off each probability for the variances: two sigmas hold nineteen in twenty, not all."""

TURN_ON_FACTOR = 4.0
"""Hypotheses that know no bias stand for kinds of parts: variances of their biases that are further apart than this
are two kinds."""

GATE_YAW_VAR = 1e-4
"""What the merge gate adds to the variance of yaw, deg²: in a long rest from the start yaw has none."""


def merge_and_prune(s: RestlevelState) -> None:
    """Merge hypotheses that say the same, and forget those that are least probable."""
    normalise(s)
    places = len(s.hypotheses)
    for k in range(places):
        for j in range(k + 1, places):
            if is_in_merge_gate(s.hypotheses[k], s.hypotheses[j]):
                moment_matched_merge(s.hypotheses[k], s.hypotheses[j])
    alive = 0
    for h in s.hypotheses:
        if h.weight < MIN_WEIGHT:
            h.weight = 0.0
        if h.weight > 0.0:
            alive += 1
    while alive > MAX_HYPOTHESES:
        least = -1
        for k in range(places):
            weight = s.hypotheses[k].weight
            if weight > 0.0 and (least < 0 or weight < s.hypotheses[least].weight):
                least = k
        s.hypotheses[least].weight = 0.0
        alive -= 1
    normalise(s)


def is_in_merge_gate(h: Hypothesis, other: Hypothesis) -> bool:
    """Whether two hypotheses agree on rest, and on yaw and bias to within the smaller sigma."""
    if h.weight == 0.0 or other.weight == 0.0:
        return False
    if h.is_at_rest != other.is_at_rest or h.knows_bias != other.knows_bias:
        return False
    least_var, most_var = min(h.bias_var, other.bias_var), max(h.bias_var, other.bias_var)
    if not h.knows_bias and most_var > TURN_ON_FACTOR * least_var:
        return False
    apart_dps, apart_deg = h.bias_dps - other.bias_dps, h.yaw_deg - other.yaw_deg
    is_same_bias = apart_dps * apart_dps < least_var
    return is_same_bias and apart_deg * apart_deg < GATE_YAW_VAR + min(h.yaw_var, other.yaw_var)


def moment_matched_merge(h: Hypothesis, other: Hypothesis) -> None:
    """Into the first: the Gaussian with the mean and the covariance of both together. The other's place is free.

    What holds the two back is averaged, so that together they end with the probability that they would have alone.
    """
    share = other.weight / (h.weight + other.weight)
    apart_dps, apart_deg = other.bias_dps - h.bias_dps, other.yaw_deg - h.yaw_deg
    spread = share * (1.0 - share)
    h.bias_var += share * (other.bias_var - h.bias_var) + spread * apart_dps * apart_dps
    h.covariance += share * (other.covariance - h.covariance) + spread * apart_dps * apart_deg
    h.yaw_var += share * (other.yaw_var - h.yaw_var) + spread * apart_deg * apart_deg
    h.bias_dps += share * apart_dps
    h.yaw_deg += share * apart_deg
    h.moving_s = min(h.moving_s, other.moving_s)
    h.rest_odds += share * (other.rest_odds - h.rest_odds)
    h.chance_density += share * (other.chance_density - h.chance_density)
    h.noisy_density += share * (other.noisy_density - h.noisy_density)
    h.odds += share * (other.odds - h.odds)
    h.turn_density += share * (other.turn_density - h.turn_density)
    h.weight += other.weight
    other.weight = 0.0


def normalise(s: RestlevelState) -> None:
    """Make the probabilities add up to 1."""
    total = 0.0
    for h in s.hypotheses:
        total += h.weight
    for h in s.hypotheses:
        h.weight /= total


def collapse(s: RestlevelState) -> None:
    """Take the hypotheses together: means by the cube of probability, so that improbable ones pull little.

    The covariance about that mean is by probability, without a tail of each: what is improbable by itself says nothing
    of how far yaw is off in nineteen cases of twenty. A hypothesis that knows no bias counts with the covariance of a
    part whose turn-on bias is far out: the prior of that bias has such a tail.
    """
    total = yaw_deg = bias_dps = rest_weight = most = 0.0
    for h in s.hypotheses:
        weight = h.weight
        if weight == 0.0:
            continue
        share = weight * weight * weight
        total += share
        yaw_deg += share * h.yaw_deg
        bias_dps += share * h.bias_dps
        most = max(most, weight)
        if h.is_at_rest:
            rest_weight += weight
    yaw_deg /= total
    bias_dps /= total
    yaw_var = covariance = bias_var = total = 0.0
    for h in s.hypotheses:
        weight = h.weight - TAIL
        if weight <= 0.0:
            continue
        total += weight
        apart_deg, apart_dps = h.yaw_deg - yaw_deg, h.bias_dps - bias_dps
        yaw_var += weight * (h.yaw_var + apart_deg * apart_deg)
        covariance += weight * (h.covariance + apart_deg * apart_dps)
        bias_var += weight * (h.bias_var + apart_dps * apart_dps)
        if not h.knows_bias:
            wider = weight * (WIDE_FACTOR - 1.0)
            yaw_var += wider * h.covariance * h.covariance / h.bias_var
            covariance += wider * h.covariance
            bias_var += wider * h.bias_var
    yaw_var /= total
    covariance /= total
    bias_var /= total
    moments = s.moments
    moments.yaw_deg = yaw_deg
    moments.bias_var, moments.covariance, moments.yaw_var = bias_var, covariance, yaw_var
    s.bias_dps = bias_dps
    s.bias_sigma_dps = sqrt(max(0.0, bias_var))
    s.confidence = most
    s.rest_probability = rest_weight
