"""Distinct values, and standard deviations of normal distributions from medians."""

import numpy as np

from gyrodrift.values.arrays import Floats

MEDIAN_TO_SIGMA = 0.6745
"""Median of the absolute values of normal numbers, in standard deviations."""

DECIMALS = 9
"""Decimals to which values of a level are equal: parsing and unwrapping add less than a unit of the last."""


def distinct(values: Floats) -> Floats:
    """Distinct finite values, rounded to DECIMALS, rising."""
    return np.unique(np.round(values[np.isfinite(values)], DECIMALS) + 0.0)  # the sum turns -0.0 into 0.0
