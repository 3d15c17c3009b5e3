"""Seven-point slopes, and a Gaussian over samples."""

import numpy as np
from scipy.ndimage import gaussian_filter1d

from gyrodrift.arrays import Floats

SIXTH_ORDER = np.array([45.0, -9.0, 1.0]) / 60.0
"""Central difference over seven points, by the distance of a pair: a tone of a tenth of the sample rate comes out
0.05 % too weak."""


def gaussian(values: Floats, sigma: float) -> Floats:
    """Values through a Gaussian of `sigma` samples, mirrored at the ends; shape (n,)."""
    smooth: Floats = gaussian_filter1d(values, sigma)
    return smooth


def central_difference(values: Floats, spacing: float) -> Floats:
    """Slope of values three samples either way; the end values stand for the values beyond; shape (n,)."""
    reach = len(SIXTH_ORDER)
    padded, slope = np.pad(values, reach, mode="edge"), np.zeros(len(values))
    for away, weight in enumerate(SIXTH_ORDER, 1):
        after, before = padded[reach + away :][: len(slope)], padded[reach - away :][: len(slope)]
        slope += (weight / spacing) * (after - before)
    return slope
