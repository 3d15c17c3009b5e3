"""Gaussian sum: merging, pruning, and its moments, which are the output of the filter.

Merging keeps the mean and covariance of two hypotheses. Pruning removes the least probable hypotheses. Sources: Alspach
and Sorenson 1972 for the sum of Gaussians; Reid 1979 for small trees of hypotheses.
"""

from math import sqrt

from gyrodrift.filters.beliefs import MAX_HYPOTHESES, MAX_RAMP_S, RAMP_PROBABILITY, SAME_YAW_DEG, TAIL
from gyrodrift.filters.restlevel.bias_state import Hypothesis
from gyrodrift.filters.restlevel.model import RestlevelCoefficients, RestlevelState

MIN_WEIGHT = 1e-9
"""Probability below which a hypothesis is pruned. Chosen: far below `TAIL`, so the output does not show it."""

TURN_ON_FACTOR = 4.0
"""Largest ratio of the bias variances of two hypotheses without a known bias that merge. A larger ratio is that of two
kinds of parts. Chosen: variances of kinds differ by a factor of 64 or more (`PARTS`)."""


def merge_and_prune(s: RestlevelState) -> None:
    """Merge hypotheses that agree, and prune the least probable hypotheses."""
    normalise(s)
    slots = len(s.hypotheses)
    for k in range(slots):
        for j in range(k + 1, slots):
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
        for k in range(slots):
            weight = s.hypotheses[k].weight
            if weight > 0.0 and (least < 0 or weight < s.hypotheses[least].weight):
                least = k
        s.hypotheses[least].weight = 0.0
        alive -= 1
    normalise(s)


def is_in_merge_gate(first: Hypothesis, second: Hypothesis) -> bool:
    """Whether two hypotheses agree on rest, and differ in yaw and bias by less than the smaller sigma."""
    if first.weight == 0.0 or second.weight == 0.0:
        return False
    if first.is_at_rest != second.is_at_rest or first.knows_bias != second.knows_bias:
        return False
    least_var, most_var = min(first.bias_var, second.bias_var), max(first.bias_var, second.bias_var)
    if not first.knows_bias and most_var > TURN_ON_FACTOR * least_var:
        return False
    apart_dps, apart_deg = first.bias_dps - second.bias_dps, first.yaw_deg - second.yaw_deg
    is_same_bias = apart_dps * apart_dps < least_var
    return is_same_bias and apart_deg * apart_deg < SAME_YAW_DEG * SAME_YAW_DEG + min(first.yaw_var, second.yaw_var)


def moment_matched_merge(first: Hypothesis, second: Hypothesis) -> None:
    """Merge the second hypothesis into the first by moments: the mean and covariance of both. The second slot is free.

    Odds and densities that the weights contain are averaged. So both together end with the same probability as
    separately.
    """
    share = second.weight / (first.weight + second.weight)
    apart_dps, apart_deg = second.bias_dps - first.bias_dps, second.yaw_deg - first.yaw_deg
    spread = share * (1.0 - share)
    first.bias_var += share * (second.bias_var - first.bias_var) + spread * apart_dps * apart_dps
    first.covariance += share * (second.covariance - first.covariance) + spread * apart_dps * apart_deg
    first.yaw_var += share * (second.yaw_var - first.yaw_var) + spread * apart_deg * apart_deg
    first.bias_dps += share * apart_dps
    first.yaw_deg += share * apart_deg
    first.moving_s = min(first.moving_s, second.moving_s)
    first.rest_odds += share * (second.rest_odds - first.rest_odds)
    first.chance_density += share * (second.chance_density - first.chance_density)
    first.noisy_density += share * (second.noisy_density - first.noisy_density)
    first.odds += share * (second.odds - first.odds)
    first.turn_density += share * (second.turn_density - first.turn_density)
    first.weight += second.weight
    second.weight = 0.0


def normalise(s: RestlevelState) -> None:
    """Divide the probabilities by their sum."""
    total = 0.0
    for h in s.hypotheses:
        total += h.weight
    for h in s.hypotheses:
        h.weight /= total


def collapse(c: RestlevelCoefficients, s: RestlevelState) -> None:
    """Compute the output from the Gaussian sum: yaw, bias, their covariance, and probabilities.

    The means are weighted by the cubes of the probabilities, so that improbable hypotheses hardly count. The covariance
    about these means is weighted by the probability minus `TAIL`, and at least 0. It holds the ramp that the bias may
    have followed since the last rest, as the update at the next rest does. The ramp grew evenly, so yaw since the last
    zero is off by the mean ramp of that time.
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
        if h.knows_bias and h.moving_s > 0.0:
            ramp_dps, seconds = c.rate_ramp_dps_s * min(h.moving_s, MAX_RAMP_S), min(h.moving_s, s.travelled_s)
            ramp_var = weight * RAMP_PROBABILITY * ramp_dps * ramp_dps
            reach_s = seconds - 0.5 * seconds * seconds / h.moving_s
            bias_var += ramp_var
            covariance -= ramp_var * reach_s
            yaw_var += ramp_var * reach_s * reach_s
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
