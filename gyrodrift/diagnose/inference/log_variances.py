"""How changes of features add and grow: logarithms of variances as variances, all else as it is."""

import numpy as np

from gyrodrift.arrays import Floats, Integers
from gyrodrift.diagnose.features.vector import IS_LOG, LINEAR
from gyrodrift.diagnose.simulate.candidate import Candidate

LOG_RANGE, LEAST_VARIANCE = 20.0, 1e-6
"""Bounds of logarithms of variances that are added as variances, so that nothing overflows or becomes 0."""

LOGARITHMS = np.flatnonzero(IS_LOG)


def combined(change: Floats, more: Floats) -> Floats:
    """Two changes at once, (…, F)."""
    added: Floats = change + more
    one, other = (np.take(each, LOGARITHMS, axis=-1) for each in (change, more))
    powers = np.exp(np.clip(one, -LOG_RANGE, LOG_RANGE)) + np.exp(np.clip(other, -LOG_RANGE, LOG_RANGE))
    both = np.log(np.maximum(powers - 1.0, LEAST_VARIANCE))
    added[..., LOGARITHMS] = np.where((one > 0.0) & (other > 0.0), both, one + other)
    return added


def scaled(node: Floats, share: Floats) -> Floats:
    """A linear effect at shares of a size: variances grow with the square, shares of samples no further."""
    by = share.reshape(-1, *([1] * node.ndim))
    squares = np.log1p(np.expm1(np.clip(node, 0.0, LOG_RANGE)) * by**2)
    logs = np.where(node > 0.0, squares, node * np.minimum(by, 1.0))
    found: Floats = np.where(LINEAR, node * by, np.where(IS_LOG, logs, node * np.minimum(by, 1.0)))
    return found


def interpolated(candidate: Candidate, nodes: Floats) -> Floats:
    """Changes at the sizes that were simulated, (nodes, …, F), taken to all sizes of a candidate, (sizes, …, F).

    Linear effects are scaled; all others are interpolated along the logarithm of the size.
    """
    if candidate.grid_points[0] < 0.0:
        up = scaled(nodes[1], candidate.sizes[candidate.sizes > 0.0] / candidate.grid_points[1])
        down = scaled(nodes[0], candidate.sizes[candidate.sizes < 0.0] / candidate.grid_points[0])
        return np.concatenate([down, up])
    if len(candidate.grid_points) == 1:
        return nodes
    place = np.interp(np.log(candidate.sizes), np.log(candidate.grid_points), np.arange(len(candidate.grid_points)))
    left = np.minimum(place.astype(np.int64), len(nodes) - 2)
    part = (place - left).reshape(-1, *([1] * (nodes.ndim - 1)))
    found: Floats = (1.0 - part) * nodes[left] + part * nodes[left + 1]
    return found


def between_scaled(candidate: Candidate, nodes: Floats) -> Floats:
    """The same for what is added to the rate in proportion to its size: both neighbors are scaled to a size."""
    points, sizes = candidate.grid_points, candidate.sizes
    left = np.clip(np.searchsorted(points, sizes, side="right") - 1, 0, len(points) - 2)
    ratio = np.log(points[left + 1] / points[left])
    part = (np.log(sizes / points[left]) / ratio).reshape(-1, *([1] * (nodes.ndim - 1)))

    def from_node(numbers: Integers) -> Floats:
        shares = sizes / points[numbers]
        each = zip(numbers, shares, strict=True)
        return np.array([scaled(nodes[at], np.array([share]))[0] for at, share in each])

    found: Floats = (1.0 - part) * from_node(left) + part * from_node(left + 1)
    return found
