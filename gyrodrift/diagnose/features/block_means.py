"""Means over whole blocks of samples, mean slopes of blocks, and the logarithm of a variance."""

import numpy as np
from scipy.ndimage import maximum_filter1d

from gyrodrift.diagnose.recording.order_statistics import median
from gyrodrift.io.compile import compiled_once
from gyrodrift.values.arrays import Floats, Mask

LEAST_DPS = 2e-3
"""Scatter of block means of 1 s, deg/s, that every encoder has. It is added to every spread, so that ratios of spreads
stay finite. Chosen: an encoder with steps of 0.005 degrees scatters by as much."""

EDGE_S = 0.5
"""Width of the window, s, in which the angle at an edge of a block is averaged. Chosen: half a block; the angle then
passes many counts, whose rounding averages out."""

SHORT_BLOCK = 16
"""Samples in a block below which numpy's mean takes several times as long as a product. Measured: with numpy 2.4, 3 to
7 times for blocks of 2 to 16 samples."""

OUTLIER_LIMIT = 30.0
"""Upper limit of a square in a mean of squares, as a multiple of their median: 3.7 standard deviations of normal
numbers. Chosen: 1 of 4500 normal numbers lies beyond."""


def block_means(values: Floats, length: int) -> Floats:
    """Means over whole blocks of `length` samples, shape (blocks,)."""
    count = len(values) // length
    rows = values[: count * length].reshape(count, length)
    means: Floats = rows @ np.ones(length) / length if length < SHORT_BLOCK else rows.mean(axis=1)
    return means


def log_variance(values_dps: Floats) -> float:
    """Logarithm of the mean square of values in deg/s, with outliers limited; log(LEAST_DPS²) without values."""
    squares = np.square(values_dps) if len(values_dps) else np.zeros(1)
    limit = OUTLIER_LIMIT * median(squares) + LEAST_DPS**2
    return float(np.log(np.minimum(squares, limit).mean() + LEAST_DPS**2))


def integral_of(values: Floats, period_s: float) -> Floats:
    """Integral of values over time by the trapezoidal rule, 0 at the first sample, shape (n,)."""
    integral = np.empty(len(values))
    _integrate(values, period_s, integral)
    return integral


def slopes(integral: Floats, period_s: float, block: int) -> Floats:
    """Mean slope of every block, between the means in windows of EDGE_S at its edges, shape (blocks,).

    Residuals and regressors use the same window, so that an error proportional to a regressor is removed exactly.
    """
    block_slopes = np.empty(len(integral) // block)
    _slopes_between(integral, period_s, block, _half_window(period_s), block_slopes)
    return block_slopes


def blocks_with(samples: Mask, period_s: float, block: int) -> Mask:
    """Blocks whose slope depends on a marked sample, shape (blocks,)."""
    near = maximum_filter1d(samples, 2 * _half_window(period_s) + 1)
    count = len(near) // block
    is_affected: Mask = near[: count * block].reshape(count, block).any(axis=1)
    return is_affected


def _half_window(period_s: float) -> int:
    """Samples on either side of an edge that are averaged with it."""
    return max(1, round(EDGE_S / period_s)) // 2


@compiled_once()
def _integrate(values: Floats, period_s: float, integral: Floats) -> None:
    total = -0.5 * values[0]
    for n in range(len(values)):
        total += values[n]
        integral[n] = period_s * (total - 0.5 * values[n])


@compiled_once()
def _slopes_between(integral: Floats, period_s: float, block: int, half_window: int, block_slopes: Floats) -> None:
    count, mean_before, middle_before = len(integral), 0.0, 0.0
    for edge in range(len(block_slopes) + 1):
        center = min(edge * block, count - 1)
        first, end = max(center - half_window, 0), min(center + half_window + 1, count)
        total = 0.0
        for n in range(first, end):
            total += integral[n]
        mean, middle = total / (end - first), 0.5 * (first + end)
        if edge > 0:
            block_slopes[edge - 1] = (mean - mean_before) / ((middle - middle_before) * period_s)
        mean_before, middle_before = mean, middle
