"""Loud rests: a device that stands still with a running engine, propellers, or a shaking mount.

Such a rest is louder than the sensor. Its blocks are equally loud, and their means agree. A straight drive looks the
same, and gentle bends look similar. So a loud rest has a prior, a noise and a level of its own. Only a hypothesis that
knows its bias can be in a loud rest, and such a rest moves the bias only as far as its variance allows.
"""

from math import exp, log

from gyrodrift.filters.restlevel.bias_state import Hypothesis
from gyrodrift.filters.restlevel.kalman import gaussian_logpdf
from gyrodrift.filters.restlevel.model import RestlevelState
from gyrodrift.filters.restlevel.noise import DROP_SIGMAS, NOISE_BLOCKS, independent

LOUD_BLOCKS = 10
"""Number of blocks that confirm a loud segment, 3 s. Chosen: twice those of a quiet segment."""

LOUD_SPREAD = 0.7
"""Spread of the logarithm of the variance of equally loud blocks, beyond sampling: a factor of 2. Chosen."""

LOUD_PRIOR_BLOCKS = 2.0
"""Number of blocks of white noise that the variance of block means begins with. Chosen: a weak prior."""

WOBBLE_DPS = 0.15
"""Largest sigma of block means in a loud rest, unless white noise explains more, deg/s. Chosen: a device that shakes
without turning sways by less than 0.05 deg in 0.3 s."""

LOUD_SHIFT_DPS, LOUD_SHIFT_S = 0.03, 10.0
"""Difference between the bias in vibration and at rest, deg/s, and the time for which it stays, s. Chosen: vibration
rectification of common parts by some g."""

LOUD_LEVEL_DPS = 1.0
"""Median rate of the level segments of a moving vehicle, deg/s: gentle bends. Chosen."""

LOUD_SHARE = 0.5
"""Odds of a loud rest over those of a quiet rest, before any loud motion. Chosen: each is seen once."""

LEAST_LEVEL_DENSITY = 1e-12
"""Smallest density of a level, 1/(deg/s): a hypothesis stays alive."""


def is_steadily_loud(s: RestlevelState) -> bool:
    """Whether a block that is not stationary is as loud as the blocks before; their variance is updated."""
    loud, variance = s.loud, s.noise.last_block_var
    if loud.blocks > 0:
        away = log(variance / loud.sample_var)
        if away * away < LOUD_SPREAD * LOUD_SPREAD + 2.0 * DROP_SIGMAS * DROP_SIGMAS / independent(s.block):
            loud.blocks = min(loud.blocks + 1, NOISE_BLOCKS)
            loud.sample_var *= exp(away / loud.blocks)
            return True
    loud.blocks, loud.sample_var = 1, variance
    return False


def follow_means(s: RestlevelState) -> bool:
    """Update the variance of block means by the steps of the present loud segment; return whether it may be a rest."""
    white_var = s.loud.sample_var / s.block.samples
    blocks = LOUD_PRIOR_BLOCKS + s.segment.blocks - 1.0
    s.loud.mean_var = (LOUD_PRIOR_BLOCKS * white_var + 0.5 * s.segment.sum_squares) / blocks
    return s.loud.mean_var < max(WOBBLE_DPS * WOBBLE_DPS, white_var)


def resumes(s: RestlevelState) -> bool:
    """Whether the present segment is as loud as the last one."""
    if not s.segment.is_loud:
        return not s.ended.is_loud
    return s.ended.is_loud and abs(log(s.loud.sample_var / s.ended.sample_var)) < LOUD_SPREAD


def loud_odds(s: RestlevelState, rest_odds: float) -> float:
    """Prior odds of a loud rest: the more motions were as loud, the less."""
    like = s.loud.motions if s.loud.sample_var > exp(-LOUD_SPREAD) * s.loud.motion_var else 0.0
    return rest_odds * LOUD_SHARE / (1.0 + like)


def level_density(s: RestlevelState, h: Hypothesis) -> float:
    """Density of the level of a loud segment if it is a rest, 1/(deg/s); it replaces that of the first blocks."""
    variance = h.bias_var + s.loud.mean_var / s.segment.blocks + LOUD_SHIFT_DPS * LOUD_SHIFT_DPS
    return max(LEAST_LEVEL_DENSITY, exp(gaussian_logpdf(s.segment.mean_dps - h.bias_dps, variance)))


def count_motion(s: RestlevelState) -> None:
    """Count a loud segment that has ended by the probability that it was a motion."""
    moving = 0.0
    for h in s.hypotheses:
        if not h.is_at_rest:
            moving += h.weight
    loud = s.loud
    if moving > 0.0:
        loud.motions += moving
        before_var = s.ended.sample_var if loud.motion_var == 0.0 else loud.motion_var
        loud.motion_var = before_var * (s.ended.sample_var / before_var) ** (moving / loud.motions)
