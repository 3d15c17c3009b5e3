"""Levels that values take, and spreads of normal numbers by their medians."""

import numpy as np

from gyrodrift.arrays import Floats

MEDIAN_TO_SIGMA = 0.6745
"""Median of the absolute values of normal numbers, in standard deviations."""

MAD_TO_SIGMA = 1.4826
"""Standard deviation of normal numbers over their median absolute deviation."""

DECIMALS = 9
"""Decimals in which values of one level agree: parsing and unwrapping add less than one unit of the last."""


def distinct(values: Floats) -> Floats:
    """Finite values, rounded to DECIMALS, each once, rising."""
    return np.unique(np.round(values[np.isfinite(values)], DECIMALS) + 0.0)  # of the two zeros, the one
