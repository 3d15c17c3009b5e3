"""Means over whole blocks of samples, and what of a block counts as at least so much scatter."""

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.recording.order_statistics import median

LEAST_DPS = 2e-3
"""Block means of a second scatter by so much at least, whatever the encoder: added to every spread so that nothing is
measured in shares of nothing."""

OUTLIER_LIMIT = 30.0
"""Times the median of squares: 3.7 standard deviations of normal numbers. Bounds what one outlier adds."""


def block_means(values: Floats, points: int) -> Floats:
    """Means of as many whole blocks as there are, shape (blocks,)."""
    count = len(values) // points
    means: Floats = values[: count * points].reshape(count, points).mean(axis=1)
    return means


def log_variance(values_dps: Floats) -> float:
    """Logarithm of the mean square of values in deg/s, outliers held back; of an empty set that of LEAST_DPS."""
    squares = np.square(values_dps) if len(values_dps) else np.zeros(1)
    limit = OUTLIER_LIMIT * median(squares) + LEAST_DPS**2
    return float(np.log(np.minimum(squares, limit).mean() + LEAST_DPS**2))
