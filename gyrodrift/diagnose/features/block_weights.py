"""How well an encoder knows the mean rate of each block: less where the rounding of its counts does not average out.

At rest rounding stays as it is, and in quick motion it goes through all of a count within a moment. Where a count
stands for long while the device moves, or where it turns by nearly a whole number of counts from sample to sample, the
angle at an edge of a block is off by up to half a count.
"""

import numpy as np
from scipy.ndimage import uniform_filter1d

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.block_means import slopes
from gyrodrift.diagnose.recording.motion import ReplayedMotion

KNOWN_DPS = 0.01
"""A block whose rounding adds less than this is known as well as any."""

NEAR_BLOCKS = 3
"""What rounding does to a block shows in this many about it: by chance one of them is rounded to the truth."""


def root_weights_of(motion: ReplayedMotion, count_deg: float, block: int, sigma_dps: float) -> Floats:
    """Square roots of weights, shape (blocks,).

    motion, count_deg
        The rebuilt motion, whose angles are those of the encoder, and the step of the encoder.
    sigma_dps
        White noise of a sample of the gyro, which no block is known better than.
    """
    if count_deg == 0.0:
        return np.ones(len(motion.angle_deg) // block)
    rounding_deg = motion.angle_deg - count_deg * np.rint(motion.angle_deg / count_deg)
    rounding_dps = slopes(rounding_deg, motion.period_s, block)
    variance = uniform_filter1d(np.square(rounding_dps), NEAR_BLOCKS)
    known = KNOWN_DPS**2 + sigma_dps**2 / block
    roots: Floats = np.sqrt(known / (known + variance))
    return roots
