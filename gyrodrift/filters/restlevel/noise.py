"""The sensor's own noise: whether a block shows no more than that, and how large it is."""

from math import exp, log, sqrt

from gyrodrift.filters.restlevel.model import RestlevelCoefficients
from gyrodrift.filters.restlevel.rate_state import BlockStats, NoiseModel

MIN_VAR = 1e-12
"""Of samples, (deg/s)²: what keeps a sensor of the finest steps from having no noise at all."""

UNKNOWN_STEPS_VAR = 0.03**2
"""The same while a sensor repeats itself, and its steps are not known: half a step of coarse parts."""

COARSEST_VAR = 0.125**2
"""The same of the coarsest part: a larger step is the beginning of a motion."""

FINE_DPS = 0.03
"""A sensor of steps as fine as this is never without noise at rest, so that zeros over and over are no rest: it has yet
to begin to measure."""

START_BLOCKS = 5
MAX_NOISE_VAR = 1.2**2
"""Where a sensor has said one thing for so many blocks, its first steps are noise if they are no louder than this,
(deg/s)², twenty times what is usual; else the device sets out, and its noise has yet to be seen."""

NOISE_BLOCKS = 20
"""Up to so many stationary blocks the noise is their mean, and itself uncertain; later it follows."""

NOISE_GAIN = 0.05
NOISE_RISE = 0.001
"""The noise follows stationary blocks by this exponent, and rises by this share of itself a second in all others: a
motor that was switched on."""

DROP_SIGMAS = 4.5
"""Two blocks in a row whose variance is below the noise by so many sigmas are the noise."""

USUAL_NOISE_DPS, NOISE_SPREAD = 0.06, 1.0
"""Standard deviation of a sample at rest, and the spread of its logarithm over parts: densities of 0.003 to 0.03
deg/s/√Hz of data sheets in bandwidths of 5 to 200 Hz."""

MOTION_DENSITY = 0.11
"""Of the logarithm of that in motion: even from 0.01 to 100 deg/s."""

WALK_GAIN = 0.05
INNOVATION_CLIP = 9.0
"""A squared step between two block means at rest counts up to this many times what is expected."""

FLICKER_GAIN = 0.002
FLICKER_CLIP = 4.0
"""The same for flicker, which is learned over minutes: in seconds the slide of a gentle curve looks like it."""


def is_stationary(c: RestlevelCoefficients, block: BlockStats, noise: NoiseModel) -> bool:
    """Whether the block that has just ended shows no more than the sensor's noise, which is followed here.

    Nothing is compared with a fixed threshold: noise is what the quietest blocks of this very sensor show.
    """
    variance = _variance(block, noise)
    is_starting = noise.stationary_blocks < START_BLOCKS
    if noise.resolution_dps > 0.0 and not noise.has_steps and (is_starting or variance < MAX_NOISE_VAR):
        _forget_blocks(noise)  # what was learned of one value over and over is no noise
        variance = _variance(block, noise)
    error = sqrt(2.0 / block.samples)  # of a variance, relative
    if noise.sample_var < 0.0:
        noise.sample_var = variance
    limit = 1.0 + c.stationarity_sigmas * error * sqrt(1.0 + 1.0 / max(noise.stationary_blocks, 1))
    noise.has_dropped = max(variance, noise.last_block_var) < noise.sample_var * exp(-DROP_SIGMAS * error)
    if noise.has_dropped:
        noise.sample_var = max(variance, noise.last_block_var)
    elif variance < noise.sample_var * limit:
        noise.stationary_blocks = min(noise.stationary_blocks + 1, NOISE_BLOCKS)
        if noise.stationary_blocks < NOISE_BLOCKS:
            noise.sample_var += (variance - noise.sample_var) / noise.stationary_blocks
        else:
            noise.sample_var *= (variance / noise.sample_var) ** NOISE_GAIN
    else:
        noise.sample_var *= 1.0 + NOISE_RISE * block.seconds
    noise.last_block_var = variance
    if not noise.is_walk_measured:
        noise.angle_walk_var = 2.0 * noise.sample_var / block.samples * block.seconds
    return variance < noise.sample_var * limit


def begins_to_measure(noise: NoiseModel, rate_dps: float) -> bool:
    """Whether the block that has just ended is the first of a sensor that said nothing but zero until then.

    Its steps may show in the next block only, where its first one came at the end of this one.
    """
    if noise.resolution_dps < 0.0:
        noise.zero_blocks = noise.zero_blocks + 1 if rate_dps == 0.0 else 0
        return False
    blocks_before = noise.zero_blocks
    noise.zero_blocks = -1 if blocks_before > 0 else 0
    if blocks_before == 0 or noise.resolution_dps > FINE_DPS:
        return False
    noise.zero_blocks = 0
    return True


def forget_noise(noise: NoiseModel) -> None:
    """All that is known but the resolution: the sensor has yet to show it."""
    _forget_blocks(noise)
    noise.angle_walk_var = -1.0
    noise.flicker_var = 0.0


def sensor_odds(sample_var: float) -> float:
    """How much likelier the noise of a sensor at rest is so large than the scatter of a motion."""
    away = (0.5 * log(sample_var) - log(USUAL_NOISE_DPS)) / NOISE_SPREAD
    away = max(away, 0.0)  # no sensor is too quiet
    return min(1.0, 0.4 / NOISE_SPREAD * exp(-0.5 * away * away) / MOTION_DENSITY)


def learn_at_rest(
    noise: NoiseModel, rest_weight: float, excess_var: float, step_dps: float, block: BlockStats, seconds: float
) -> None:
    """Follow flicker and angle random walk by a block at rest.

    Parameters
    ----------
    noise
        Is changed.
    rest_weight
        Probability that the block is at rest.
    excess_var
        By how much the innovation exceeded what was expected, weighted by probability, (deg/s)².
    step_dps
        Step from the block mean before to this one.
    block, seconds
        The block, and its length.
    """
    noise.flicker_var = max(0.0, noise.flicker_var + FLICKER_GAIN * excess_var)
    noise.is_walk_measured = noise.is_walk_measured or rest_weight > 0.5
    seen_var = min(0.5 * step_dps * step_dps * seconds, INNOVATION_CLIP * noise.angle_walk_var)
    walk_var = noise.angle_walk_var + WALK_GAIN * rest_weight * (seen_var - noise.angle_walk_var)
    noise.angle_walk_var = max(walk_var, _rounding_var(noise) / block.samples * seconds)


def _forget_blocks(noise: NoiseModel) -> None:
    """How large the noise of a sample is, now that the sensor shows its steps."""
    noise.sample_var = noise.last_block_var = -1.0
    noise.stationary_blocks = 0
    noise.has_steps, noise.is_walk_measured = True, False


def _variance(block: BlockStats, noise: NoiseModel) -> float:
    """Of the samples of a block, (deg/s)²; no less than rounding to the resolution can hide."""
    mean_dps = block.sum_dps / block.samples
    return max(block.sum_squares / block.samples - mean_dps * mean_dps, _rounding_var(noise), MIN_VAR)


def _rounding_var(noise: NoiseModel) -> float:
    """What steps of the resolution may hide, (deg/s)²."""
    if not noise.has_steps:
        return UNKNOWN_STEPS_VAR
    return min(0.25 * noise.resolution_dps * noise.resolution_dps, COARSEST_VAR)
