"""Regimes of a motion, by sample and by block: rest, slow or fast, quick or steady."""

from dataclasses import dataclass

import numpy as np

from gyrodrift.diagnose.features.block_means import block_means
from gyrodrift.diagnose.recording.motion import ReplayedMotion
from gyrodrift.diagnose.recording.smoothing import gaussian
from gyrodrift.values.arrays import Floats, Mask

REST_DPS, SLOW_DPS, FAST_DPS = 0.5, 2.0, 40.0
"""Upper limit of the rate at rest; lower limits of slow and of fast motion, deg/s. Chosen: rest is a quarter of slow
motion at most, and 40 deg/s is a turn in 9 s."""

REST_EDGE_S = 0.6
"""A sample is at rest if rate and shaking stay below REST_DPS for this time before and after it, s. Chosen: 4
MASK_SMOOTH_S, the reach of the Gaussian."""

QUICK_DPS, STEADY_DPS = 1.0, 0.05
"""Changes of the smoothed rate from sample to sample, deg/s. Chosen: a quick one is above noise, a steady one almost
0."""

MASK_SMOOTH_S = 0.15
"""Standard deviation of the Gaussian that smooths the rate, s. Chosen: noise averages out, and starts and stops are
still distinct."""


@dataclass(frozen=True, slots=True)
class Regimes:
    """Regimes of a motion.

    speed_dps
        Smoothed rate, shape (n,).
    at_rest, is_slow, is_fast, is_turning, is_quick, is_steady
        Masks of samples, shape (n,). Turning is slow or fast.
    block_rate_dps, block_at_rest, block_is_even
        Mean rate, blocks at rest, and blocks with an almost constant rate, shape (blocks,).
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
    """Regimes of a motion; `block` is the number of samples in a block."""
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


def lasting(mask: Mask, length: int) -> Mask:
    """Samples whose whole window of `length` samples is in the mask, shape (n,).

    The window begins length // 2 samples before a sample. Its parts beyond the ends are ignored.
    """
    outside = np.concatenate([[0], np.cumsum(~mask)])
    begin = np.arange(len(mask)) - length // 2
    first, end = np.maximum(begin, 0), np.minimum(begin + length, len(mask))
    lasts: Mask = outside[end] == outside[first]
    return lasts
