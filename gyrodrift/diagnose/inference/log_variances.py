"""Changes of the features at all sizes of an effect, from those at its simulated sizes."""

import numpy as np

from gyrodrift.diagnose.features.vector import IS_LOG, LINEAR, LOG_RANGE, ROOTS
from gyrodrift.diagnose.simulate.candidate import Candidate
from gyrodrift.values.arrays import Floats, Integers


def scaled(node: Floats, share: Floats) -> Floats:
    """Changes (shares, …, F) at multiples of the size of a simulated change (…, F).

    Linear features grow in proportion. Increases of variances grow with the square. All other changes grow in
    proportion up to the simulated size and no further.
    """
    by = share.reshape(-1, *([1] * node.ndim))
    squares = np.log1p(np.expm1(np.clip(node, 0.0, LOG_RANGE)) * by**2)
    logs = np.where(node > 0.0, squares, node * np.minimum(by, 1.0))
    change: Floats = np.where(LINEAR, node * by, np.where(IS_LOG, logs, node * np.minimum(by, 1.0)))
    return change


def interpolated(candidate: Candidate, nodes: Floats) -> Floats:
    """Changes at all sizes of a candidate, (sizes, …, F), from those at its simulated sizes, (nodes, …, F).

    Effects of either sign are scaled. All others are interpolated linearly along the logarithm of the size, roots of
    shares as powers of the size.
    """
    if candidate.grid_points[0] < 0.0:
        up = scaled(nodes[1], candidate.sizes[candidate.sizes > 0.0] / candidate.grid_points[1])
        down = scaled(nodes[0], candidate.sizes[candidate.sizes < 0.0] / candidate.grid_points[0])
        return np.concatenate([down, up])
    if len(candidate.grid_points) == 1:
        return nodes
    position = np.interp(np.log(candidate.sizes), np.log(candidate.grid_points), np.arange(len(candidate.grid_points)))
    lower = np.minimum(position.astype(np.int64), len(nodes) - 2)
    part = (position - lower).reshape(-1, *([1] * (nodes.ndim - 1)))
    change: Floats = (1.0 - part) * nodes[lower] + part * nodes[lower + 1]
    return _with_powers(change, nodes[lower], nodes[lower + 1], part)


def _with_powers(change: Floats, below: Floats, above: Floats, part: Floats) -> Floats:
    """The change with its roots of shares as a power of the size through both neighbors, where both are positive.

    Shares grow in proportion to the size: their roots with the power 0.5, or with 1 beside a larger share.

    part
        Share of the way from one neighbor to the other, along the logarithm of the size.
    """
    first, second = (np.maximum(np.take(values, ROOTS, axis=-1), 0.0) for values in (below, above))
    powers = np.power(first, 1.0 - part) * np.power(second, part)
    change[..., ROOTS] = np.where((first > 0.0) & (second > 0.0), powers, np.take(change, ROOTS, axis=-1))
    return change


def straight(candidate: Candidate, nodes: Floats) -> tuple[Floats, Floats | float]:
    """Changes at all sizes of a candidate, (sizes, …, F), by linear interpolation, and the error of the interpolation.

    Roots of shares are powers of the size. The error is that of a chord of a parabola: the second divided difference of
    three simulated sizes times the distances to both ends of the chord. Effects of either sign are scaled, and effects
    of a single size are returned as they are. Both have no error.
    """
    points = candidate.grid_points
    if len(points) < 2 or points[0] < 0.0:
        return interpolated(candidate, nodes), 0.0
    lower = np.clip(np.searchsorted(points, candidate.sizes, side="right") - 1, 0, len(points) - 2)
    below, above = points[lower], points[lower + 1]
    part = ((candidate.sizes - below) / (above - below))[:, None, None]
    means: Floats = (1.0 - part) * nodes[lower] + part * nodes[lower + 1]
    in_logs = (np.log(candidate.sizes / below) / np.log(above / below))[:, None, None]
    means = _with_powers(means, nodes[lower], nodes[lower + 1], in_logs)
    bends = _bends(points, nodes) if candidate.in_rig is not None else _bends(*_with_none(points, nodes))
    bend = np.minimum(lower if candidate.in_rig is None else np.maximum(lower - 1, 0), len(bends) - 1)
    distances = (candidate.sizes - below) * (above - candidate.sizes)
    return means, bends[bend] * np.maximum(distances, 0.0)[:, None, None]


def _with_none(points: Floats, nodes: Floats) -> tuple[Floats, Floats]:
    """Sizes and changes with a size of 0 added, which changes nothing if the rig has no such effect."""
    return np.concatenate([[0.0], points]), np.concatenate([np.zeros_like(nodes[:1]), nodes])


def _bends(points: Floats, nodes: Floats) -> Floats:
    """Absolute second divided differences at all points but the first and the last; one row of 0 for two points."""
    if len(points) < 3:
        return np.zeros_like(nodes[:1])
    slopes = np.diff(nodes, axis=0) / np.diff(points)[:, None, None]
    bends: Floats = np.abs(np.diff(slopes, axis=0)) / (points[2:] - points[:-2])[:, None, None]
    return bends


def between_scaled(candidate: Candidate, nodes: Floats) -> Floats:
    """Changes at all sizes, (sizes, …, F), of effects that add to the rate in proportion to their size.

    The changes at both neighboring simulated sizes are scaled to the size, and then averaged with weights.
    """
    points, sizes = candidate.grid_points, candidate.sizes
    lower = np.clip(np.searchsorted(points, sizes, side="right") - 1, 0, len(points) - 2)
    ratio = np.log(points[lower + 1] / points[lower])
    part = (np.log(sizes / points[lower]) / ratio).reshape(-1, *([1] * (nodes.ndim - 1)))

    def from_node(indices: Integers) -> Floats:
        shares = sizes / points[indices]
        pairs = zip(indices, shares, strict=True)
        return np.array([scaled(nodes[index], np.array([share]))[0] for index, share in pairs])

    change: Floats = (1.0 - part) * from_node(lower) + part * from_node(lower + 1)
    return change
