"""Means over whole blocks of samples, and what of a block counts as at least so much scatter."""

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.recording.order_statistics import median

LEAST_DPS = 2e-3
"""Block means of a second scatter by so much at least, whatever the encoder: added to every spread so that nothing is
measured in shares of nothing."""

EDGE_S = 0.5
"""Over which an angle at an edge of a block is averaged."""

FEW = 16
"""Samples in a block, below which numpy's own mean takes ten times as long as a product."""

OUTLIER_LIMIT = 30.0
"""Times the median of squares: 3.7 standard deviations of normal numbers. Bounds what one outlier adds."""


def block_means(values: Floats, points: int) -> Floats:
    """Means of as many whole blocks as there are, shape (blocks,)."""
    count = len(values) // points
    rows = values[: count * points].reshape(count, points)
    means: Floats = rows @ np.ones(points) / points if points < FEW else rows.mean(axis=1)
    return means


def log_variance(values_dps: Floats) -> float:
    """Logarithm of the mean square of values in deg/s, outliers held back; of an empty set that of LEAST_DPS."""
    squares = np.square(values_dps) if len(values_dps) else np.zeros(1)
    limit = OUTLIER_LIMIT * median(squares) + LEAST_DPS**2
    return float(np.log(np.minimum(squares, limit).mean() + LEAST_DPS**2))


def integral_of(values: Floats, period_s: float) -> Floats:
    """By the trapezoidal rule, zero at the first sample, shape (n,)."""
    sums: Floats = period_s * (np.cumsum(values) - 0.5 * (values + values[0]))
    return sums


def slopes(integral: Floats, period_s: float, block: int) -> Floats:
    """Mean slope of each block, between means over EDGE_S about its edges, shape (blocks,).

    Residuals and regressors go through this same window, so that an error in proportion to a regressor is taken out
    with it.
    """
    points = max(1, round(EDGE_S / period_s))
    edges = np.arange(len(integral) // block + 1) * block
    edges[-1] = min(edges[-1], len(integral) - 1)
    sums = np.concatenate([[0.0], np.cumsum(integral)])
    first, end = np.maximum(edges - points // 2, 0), np.minimum(edges + points // 2 + 1, len(integral))
    means = (sums[end] - sums[first]) / (end - first)
    found: Floats = np.diff(means) / (np.diff(0.5 * (first + end)) * period_s)
    return found
