"""Means over whole blocks of samples, and what of a block counts as at least so much scatter."""

import numpy as np
from scipy.ndimage import maximum_filter1d

from gyrodrift.arrays import Floats, Mask
from gyrodrift.compile import compiled_once

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
    limit = OUTLIER_LIMIT * np.median(squares) + LEAST_DPS**2
    return float(np.log(np.minimum(squares, limit).mean() + LEAST_DPS**2))


def integral_of(values: Floats, period_s: float) -> Floats:
    """By the trapezoidal rule, zero at the first sample, shape (n,)."""
    integral = np.empty(len(values))
    _integrate(values, period_s, integral)
    return integral


def slopes(integral: Floats, period_s: float, block: int) -> Floats:
    """Mean slope of each block, between means over EDGE_S about its edges, shape (blocks,).

    Residuals and regressors go through this same window, so that an error in proportion to a regressor is taken out
    with it.
    """
    found = np.empty(len(integral) // block)
    _slopes_between(integral, period_s, block, _beside(period_s), found)
    return found


def touches(samples: Mask, period_s: float, block: int) -> Mask:
    """Blocks whose slopes go by any of some samples, shape (blocks,)."""
    near = maximum_filter1d(samples, 2 * _beside(period_s) + 1)
    count = len(near) // block
    touched: Mask = near[: count * block].reshape(count, block).any(axis=1)
    return touched


def _beside(period_s: float) -> int:
    """Samples before and behind an edge that are averaged with it."""
    return max(1, round(EDGE_S / period_s)) // 2


@compiled_once()
def _integrate(values: Floats, period_s: float, integral: Floats) -> None:
    total = -0.5 * values[0]
    for n in range(len(values)):
        total += values[n]
        integral[n] = period_s * (total - 0.5 * values[n])


@compiled_once()
def _slopes_between(integral: Floats, period_s: float, block: int, beside: int, found: Floats) -> None:
    count, mean_before, middle_before = len(integral), 0.0, 0.0
    for edge in range(len(found) + 1):
        place = min(edge * block, count - 1)
        first, end = max(place - beside, 0), min(place + beside + 1, count)
        total = 0.0
        for n in range(first, end):
            total += integral[n]
        mean, middle = total / (end - first), 0.5 * (first + end)
        if edge > 0:
            found[edge - 1] = (mean - mean_before) / ((middle - middle_before) * period_s)
        mean_before, middle_before = mean, middle
