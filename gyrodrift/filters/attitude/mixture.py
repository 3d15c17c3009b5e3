"""Merging and pruning of hypotheses, and the Gaussian sum as one estimate."""

from typing import NamedTuple

import numpy as np

from gyrodrift.filters.attitude.batch import conjugates, products, to_rotation_vectors
from gyrodrift.filters.attitude.block import RAD
from gyrodrift.filters.attitude.hypotheses import (
    ATTITUDE,
    BIAS,
    FORCE_BIAS,
    HEADING,
    SCALE,
    STATES,
    VELOCITY,
    Hypotheses,
)
from gyrodrift.filters.beliefs import MAX_HYPOTHESES, SAME_YAW_DEG, TAIL
from gyrodrift.values.arrays import Floats

LEAST_WEIGHT = 1e-6
"""Probability below which a hypothesis is pruned. Chosen: far below `TAIL`, so the output does not show it."""


class SumMoments(NamedTuple):
    """The Gaussian sum as one estimate.

    heading
        Mean heading (rad), by cubed weights, minus that of the most probable hypothesis.
    heading_var
        Variance of the heading about that mean, rad².
    bias
        Mean bias (3), rad/s.
    bias_cov
        Its covariance (3, 3).
    tilt_var
        Variance of the inclination, rad²: the mean of two level axes, of the most probable hypothesis.
    """

    heading: float
    heading_var: float
    bias: Floats
    bias_cov: Floats
    tilt_var: float


def differences(h: Hypotheses, i: int, j: int) -> Floats:
    """Error states (21) from hypothesis i to j."""
    error = np.empty(STATES)
    error[ATTITUDE] = to_rotation_vectors(products(h.q[j : j + 1], conjugates(h.q[i : i + 1])))[0]
    error[BIAS] = h.bias[j] - h.bias[i]
    error[VELOCITY] = h.velocity[j] - h.velocity[i]
    error[SCALE] = (h.scale[j] - h.scale[i]).ravel()
    error[FORCE_BIAS] = h.force_bias[j] - h.force_bias[i]
    return error


def merge_and_prune(h: Hypotheses) -> Hypotheses:
    """The most probable hypotheses, similar ones merged, with probabilities that sum to 1."""
    h = h.select(np.argsort(-h.weight, kind="stable"))
    i = 0
    while i < len(h.weight) - 1:
        j = i + 1
        while j < len(h.weight):
            if _are_similar(h, i, j):
                h = _merged(h, i, j)
            else:
                j += 1
        i += 1
    h.weight = h.weight / h.weight.sum()
    h = h.select(np.argsort(-h.weight, kind="stable")[:MAX_HYPOTHESES])
    h = h.select(h.weight >= LEAST_WEIGHT)
    h.weight = h.weight / h.weight.sum()
    return h


def _are_similar(h: Hypotheses, i: int, j: int) -> bool:
    """Whether two hypotheses agree in regime, in biases, and in headings, within the smaller standard deviation."""
    if h.regime[i] != h.regime[j] or h.knows_bias[i] != h.knows_bias[j]:
        return False
    error = differences(h, i, j)
    variance = np.minimum(np.diagonal(h.cov[i]), np.diagonal(h.cov[j]))
    near_heading = error[HEADING] ** 2 < variance[HEADING] + (SAME_YAW_DEG * RAD) ** 2
    has_same_turns = abs(h.yaw_deg[i] - h.yaw_deg[j]) < 180.0
    return bool(near_heading and has_same_turns and (error[BIAS] ** 2 < variance[BIAS]).all())


def _merged(h: Hypotheses, i: int, j: int) -> Hypotheses:
    """Hypotheses with i and j as one, by their moments, in slot i."""
    share = float(h.weight[j] / (h.weight[i] + h.weight[j]))
    error = differences(h, i, j)
    h.weight[i] += h.weight[j]
    h.moving_s[i] = min(h.moving_s[i], h.moving_s[j])
    h.cov[i] = (1.0 - share) * h.cov[i] + share * h.cov[j] + share * (1.0 - share) * np.outer(error, error)
    h.yaw_deg[i] += share * (h.yaw_deg[j] - h.yaw_deg[i])
    single = h.select([i])
    single.correct(share * error[None, :])
    h.q[i], h.bias[i], h.velocity[i] = single.q[0], single.bias[0], single.velocity[0]
    h.scale[i], h.force_bias[i] = single.scale[0], single.force_bias[0]
    return h.select(np.arange(len(h.weight)) != j)


def moments(h: Hypotheses) -> SumMoments:
    """The Gaussian sum as one estimate; the first hypothesis is the most probable."""
    headings = np.radians(h.yaw_deg - h.yaw_deg[0])
    cubes = h.weight**3 / (h.weight**3).sum()
    mean, bias = float(cubes @ headings), cubes @ h.bias
    off, bias_off = headings - mean, h.bias - bias
    kept = np.maximum(h.weight - TAIL, 0.0)
    kept = kept / kept.sum()
    heading_var = float(kept @ (h.cov[:, HEADING, HEADING] + off * off))
    bias_cov = np.einsum("n,nij->ij", kept, h.cov[:, BIAS, BIAS] + bias_off[:, :, None] * bias_off[:, None, :])
    tilt_var = 0.5 * float(h.cov[0, 0, 0] + h.cov[0, 1, 1])
    return SumMoments(mean, heading_var, bias, bias_cov, tilt_var)


def ordered(h: Hypotheses) -> Hypotheses:
    """The hypotheses, the most probable one first."""
    if len(h.weight) == 1 or h.weight[0] == h.weight.max():
        return h
    return h.select(np.argsort(-h.weight, kind="stable"))
