"""Smooth a motion by local cubics. Every sample has the widest window that the motion allows.

With a large jerk, a model of white jerk follows every sample of the gyro, so that its noise becomes motion. But smooth
motion is nearly a cubic within a fraction of a second, even if its jerk is large. The windows are tried from the
narrowest to the widest. An estimate is accepted as long as it differs from the narrower one by no more than noise does
(O. V. Lepski, 1990). At a corner no window is accepted, and the samples do not change.
"""

from functools import cache

import numpy as np
from scipy.ndimage import maximum_filter1d, uniform_filter1d

from gyrodrift.diagnose.recording.smoothing import convolved
from gyrodrift.values.arrays import Floats, Mask

HALF_WINDOWS = (2, 4, 8, 16, 32, 64)
"""Number of samples on either side."""

WINDOWS_AVERAGED, DISAGREES = 2, 2.5
"""Number of windows over which the squared difference of two estimates is averaged, and its largest accepted value, in
variances of noise.

Averages over more windows reduce the noise on a sine to 0.3 of its size instead of 0.5. But then a slow corner is
rounded by twice as much.
"""


def local_cubic(values: Floats, sigma: float, widest: int) -> Floats:
    """(n,) smoothed values.

    values
        (n,) smooth values with white noise.
    sigma
        Standard deviation of the noise.
    widest
        Largest number of samples on either side.
    """
    kept, before, weights_before = values, values, np.ones(1)
    agrees: Mask = np.ones(len(values), bool)
    for half in HALF_WINDOWS:
        if half > widest or 2 * half + 1 > len(values):
            break
        weights = _weights(half)
        smooth = convolved(np.pad(values, half, mode="edge"), weights[half:])
        expected = sigma**2 * float(np.square(_difference(weights, weights_before)).sum())
        power = uniform_filter1d(np.square(smooth - before), WINDOWS_AVERAGED * (2 * half + 1))
        agrees = agrees & (maximum_filter1d(power, 2 * half + 1) <= DISAGREES * expected)
        kept = np.where(agrees, smooth, kept)
        before, weights_before = smooth, weights
    return kept


def _difference(weights: Floats, narrower: Floats) -> Floats:
    """Weights of the difference of two windows."""
    padding = (len(weights) - len(narrower)) // 2
    difference: Floats = weights - np.pad(narrower, padding)
    return difference


@cache
def _weights(half: int) -> Floats:
    """(2 half + 1,) weights of the value in the middle of a cubic least-squares fit (Savitzky and Golay, 1964)."""
    offsets = np.arange(-half, half + 1, dtype=np.float64)
    weights: Floats = np.linalg.pinv(np.vander(offsets, 4, increasing=True))[0]  # four coefficients of a cubic
    weights.flags.writeable = False
    return weights
