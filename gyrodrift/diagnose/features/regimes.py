"""What a device did at each sample and in each block: rest, slow or fast motion, quick or steady."""

from dataclasses import dataclass

import numpy as np

from gyrodrift.arrays import Floats, Mask
from gyrodrift.diagnose.features.block_means import block_means
from gyrodrift.diagnose.recording.motion import ReplayedMotion
from gyrodrift.diagnose.recording.smoothing import gaussian

REST_DPS, SLOW_DPS, FAST_DPS = 0.5, 2.0, 40.0
REST_EDGE_S = 0.6
"""At rest is what is slower than REST_DPS for so long before and after, and shakes no faster."""

QUICK_DPS, STEADY_DPS = 1.0, 0.05
"""From one sample to the next the rate changes by more than noise does, or by next to nothing."""

MASK_SMOOTH_S = 0.15
"""Standard deviation of the Gaussian through which the rate is looked at for this."""


@dataclass(frozen=True, slots=True)
class Regimes:
    """Regimes of a motion.

    speed_dps, at_rest, is_slow, is_fast, is_turning, is_quick, is_steady
        Smoothed rate, and what the device did, of samples, shape (n,).
    block_rate_dps, block_at_rest, block_is_even
        Mean rate, blocks that rest, and those that rest or turn steadily, shape (blocks,).
    """

    speed_dps: Floats
    at_rest: Mask
    is_slow: Mask
    is_fast: Mask
    is_turning: Mask
    is_quick: Mask
    is_steady: Mask
    block_rate_dps: Floats
    block_at_rest: Mask
    block_is_even: Mask


def regimes_of(motion: ReplayedMotion, block: int) -> Regimes:
    """The regimes of a motion, with blocks of so many samples."""
    speed_dps = gaussian(motion.rate_dps, MASK_SMOOTH_S / motion.period_s)
    absolute_dps = np.abs(speed_dps)
    shakes = gaussian(np.square(motion.rate_dps - speed_dps), MASK_SMOOTH_S / motion.period_s) > REST_DPS**2
    at_rest = lasting((absolute_dps < REST_DPS) & ~shakes, 2 * round(REST_EDGE_S / motion.period_s) + 1)
    is_slow = lasting((absolute_dps > SLOW_DPS) & (absolute_dps < FAST_DPS), block)
    is_fast = lasting(absolute_dps > FAST_DPS, block)
    change_dps = np.abs(np.gradient(speed_dps))
    block_rate_dps = block_means(motion.rate_dps, block)
    return Regimes(
        speed_dps=speed_dps,
        at_rest=at_rest,
        is_slow=is_slow,
        is_fast=is_fast,
        is_turning=is_fast | is_slow,
        is_quick=change_dps > QUICK_DPS,
        is_steady=~at_rest & ~shakes & (change_dps < STEADY_DPS),
        block_rate_dps=block_rate_dps,
        block_at_rest=block_means(at_rest.astype(np.float64), block) > 0.99,
        block_is_even=np.abs(np.gradient(block_rate_dps)) < 0.5,  # deg/s/s
    )


def lasting(is_such: Mask, points: int) -> Mask:
    """Samples about which so many are such: half of them before, the others from it on; none beyond the ends counts."""
    others = np.concatenate([[0], np.cumsum(~is_such)])
    place = np.arange(len(is_such)) - points // 2
    first, end = np.maximum(place, 0), np.minimum(place + points, len(is_such))
    lasts: Mask = others[end] == others[first]
    return lasts
