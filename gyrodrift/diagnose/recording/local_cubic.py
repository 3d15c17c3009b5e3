"""Noise taken out of a motion by cubics over windows as wide as the motion allows, sample by sample.

Where a motion is driven hard, a model of white jerk follows every sample of the gyro, and hands its noise on as motion.
A smooth motion is nearly a cubic within a fraction of a second, however hard it is driven. From the narrowest window to
the widest, each has to agree with the one before as noise does (O. V. Lepski, 1990: the widest estimate that no
narrower one contradicts); around a corner none does, and the samples stay as they are.
"""

from functools import cache

import numpy as np
from scipy.ndimage import maximum_filter1d, uniform_filter1d

from gyrodrift.arrays import Floats, Mask
from gyrodrift.diagnose.recording.smoothing import convolved

HALF_WINDOWS = (2, 4, 8, 16, 32, 64)
"""Samples on either side."""

NEIGHBOURS, DISAGREES = 2, 2.5
"""Mean square of the difference of two windows, over so many of the wider, and in units of what noise makes of it, that
is more than noise. Wider neighbourhoods take a sine's noise down to 0.3 of what it was instead of 0.5, and round a
gentle corner by twice as much."""


def local_cubic(values: Floats, sigma: float, widest: int) -> Floats:
    """Values, (n,), of white noise `sigma` on something smooth; no window has more than `widest` samples a side."""
    kept, before, weights_before = values, values, np.ones(1)
    agrees: Mask = np.ones(len(values), bool)
    for half in HALF_WINDOWS:
        if half > widest or 2 * half + 1 > len(values):
            break
        weights = _weights(half)
        found = convolved(np.pad(values, half, mode="edge"), weights[half:])
        expected = sigma**2 * float(np.square(_less(weights, weights_before)).sum())
        power = uniform_filter1d(np.square(found - before), NEIGHBOURS * (2 * half + 1))
        agrees = agrees & (maximum_filter1d(power, 2 * half + 1) <= DISAGREES * expected)
        kept = np.where(agrees, found, kept)
        before, weights_before = found, weights
    return kept


def _less(weights: Floats, narrower: Floats) -> Floats:
    """The weights of a difference of two windows."""
    padding = (len(weights) - len(narrower)) // 2
    difference: Floats = weights - np.pad(narrower, padding)
    return difference


@cache
def _weights(half: int) -> Floats:
    """(2 half + 1,) of the middle of a cubic by least squares (A. Savitzky and M. J. E. Golay, 1964)."""
    places = np.arange(-half, half + 1, dtype=np.float64)
    found: Floats = np.linalg.pinv(np.vander(places, 4, increasing=True))[0]  # a cubic
    found.flags.writeable = False
    return found
