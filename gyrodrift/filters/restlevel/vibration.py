"""Rests in vibration: a device that stands still with a running engine, propellers, or a shaking mount.

Such a rest is noisier than the sensor. Its blocks are equally noisy, and their means agree. A straight drive looks the
same, and gentle bends look similar. So this rest has a prior, a noise and a level of its own. Only a hypothesis that
knows its bias can be in it, and it moves the bias only as far as its variance allows.
"""

from math import exp, log

from gyrodrift.filters.restlevel.bias_state import Hypothesis
from gyrodrift.filters.restlevel.kalman import gaussian_logpdf
from gyrodrift.filters.restlevel.model import RestlevelState
from gyrodrift.filters.restlevel.noise import DROP_SIGMAS, NOISE_BLOCKS, independent

VIBRATION_BLOCKS = 10
"""Number of blocks that confirm a vibrating segment, 3 s. Chosen: twice those of a quiet segment."""

VIBRATION_SPREAD = 0.7
"""Spread of the logarithm of the variance of equally noisy blocks, beyond sampling: a factor of 2. Chosen."""

VIBRATION_PRIOR_BLOCKS = 2.0
"""Number of blocks of white noise that the variance of block means begins with. Chosen: a weak prior."""

WOBBLE_DPS = 0.15
"""Largest sigma of block means at rest, unless white noise explains more, deg/s. Chosen: a device that shakes without
turning sways by less than 0.05 deg in 0.3 s."""

VIBRATION_SHIFT_DPS, VIBRATION_SHIFT_S = 0.03, 10.0
"""Difference between the bias in vibration and at rest, deg/s, and the time for which it stays, s. Chosen: vibration
rectification of common parts by some g."""

VIBRATION_LEVEL_DPS = 1.0
"""Median rate of the level segments of a moving vehicle, deg/s: gentle bends. Chosen."""

VIBRATION_SHARE = 0.5
"""Odds of a rest in vibration over those of a quiet rest, before any noisy motion. Chosen: each is seen once."""

LEAST_LEVEL_DENSITY = 1e-12
"""Smallest density of a level, 1/(deg/s). Chosen: a hypothesis stays alive."""


def vibrates_steadily(s: RestlevelState) -> bool:
    """Whether a block that is not stationary is as noisy as the blocks before; their variance is updated."""
    vibration, variance = s.vibration, s.noise.last_block_var
    if vibration.blocks > 0:
        away = log(variance / vibration.sample_var)
        if away * away < VIBRATION_SPREAD * VIBRATION_SPREAD + 2.0 * DROP_SIGMAS * DROP_SIGMAS / independent(s.block):
            vibration.blocks = min(vibration.blocks + 1, NOISE_BLOCKS)
            vibration.sample_var *= exp(away / vibration.blocks)
            return True
    vibration.blocks, vibration.sample_var = 1, variance
    return False


def follow_means(s: RestlevelState) -> bool:
    """Update the variance of block means by the steps of a vibrating segment; return whether it may be a rest."""
    white_var = s.vibration.sample_var / s.block.samples
    blocks = VIBRATION_PRIOR_BLOCKS + s.segment.blocks - 1.0
    s.vibration.mean_var = (VIBRATION_PRIOR_BLOCKS * white_var + 0.5 * s.segment.sum_squares) / blocks
    return s.vibration.mean_var < max(WOBBLE_DPS * WOBBLE_DPS, white_var)


def resumes(s: RestlevelState) -> bool:
    """Whether the present segment is as noisy as the last one."""
    if not s.segment.is_vibrating:
        return not s.ended.is_vibrating
    return s.ended.is_vibrating and abs(log(s.vibration.sample_var / s.vibration.ended_var)) < VIBRATION_SPREAD


def vibration_odds(s: RestlevelState, rest_odds: float) -> float:
    """Prior odds of a rest in vibration: the more motions were as noisy, the less."""
    like = s.vibration.motions if s.vibration.sample_var > exp(-VIBRATION_SPREAD) * s.vibration.motion_var else 0.0
    return rest_odds * VIBRATION_SHARE / (1.0 + like)


def level_density(s: RestlevelState, h: Hypothesis) -> float:
    """Density of the level of a vibrating segment if it is a rest, 1/(deg/s); it replaces that of the first blocks."""
    variance = h.bias_var + s.vibration.mean_var / s.segment.blocks + VIBRATION_SHIFT_DPS * VIBRATION_SHIFT_DPS
    return max(LEAST_LEVEL_DENSITY, exp(gaussian_logpdf(s.segment.mean_dps - h.bias_dps, variance)))


def count_motion(s: RestlevelState) -> None:
    """Count a vibrating segment that has ended by the probability that it was a motion."""
    moving = 0.0
    for h in s.hypotheses:
        if not h.is_at_rest:
            moving += h.weight
    vibration = s.vibration
    if moving > 0.0:
        vibration.motions += moving
        before_var = s.vibration.ended_var if vibration.motion_var == 0.0 else vibration.motion_var
        vibration.motion_var = before_var * (s.vibration.ended_var / before_var) ** (moving / vibration.motions)
