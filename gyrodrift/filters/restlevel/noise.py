"""Noise of the sensor: its size, and whether a block shows no more than noise."""

from math import exp, log, sqrt

from gyrodrift.filters.restlevel.model import RestlevelCoefficients
from gyrodrift.filters.restlevel.rate_state import BlockStats, NoiseModel

MIN_VAR = 1e-12
"""Smallest variance of samples, (deg/s)². Chosen: a sensor of the finest steps has some noise, too."""

UNKNOWN_STEPS_VAR = 0.03**2
"""Variance that unknown steps may hide, (deg/s)². Derived: half a step of coarse parts, squared; 16 bits over
±2000 deg/s have steps of 0.06 deg/s."""

COARSEST_VAR = 0.125**2
"""Largest variance that steps may hide, (deg/s)²: half the coarsest step, squared. Chosen: a larger step is a
motion."""

FINE_DPS = 0.03
"""Largest step of a fine sensor, deg/s. Such a sensor always shows noise at rest, so repeated zeros are no rates.
Chosen: half of `USUAL_NOISE_DPS`."""

START_BLOCKS = 5
MAX_NOISE_VAR = 1.2**2
"""First steps after fewer blocks of a single value are noise. After more blocks they are noise only with a variance
below `MAX_NOISE_VAR`, (deg/s)². Chosen: its root is twenty times `USUAL_NOISE_DPS`."""

NOISE_BLOCKS = 20
"""Number of stationary blocks up to which the noise is their mean; after that it follows by `NOISE_GAIN`. Chosen: 6 s
at the default `window_s`."""

NOISE_GAIN = 0.01
NOISE_RISE = 0.001
"""Weight of a stationary block in the logarithm of the noise, and relative rise of the noise in other blocks, 1/s. It
rises because a motor may have been switched on. Chosen: at 0.05 instead of 0.01, a smooth road becomes the noise
(docs/blind-alleys.md)."""

DROP_SIGMAS = 4.5
"""Distance of two consecutive variances below the noise, in standard errors, at which they replace the noise. Chosen:
at 2.5, luck is enough once an hour (docs/blind-alleys.md)."""

USUAL_NOISE_DPS, NOISE_SPREAD = 0.06, 1.0
"""Usual standard deviation of a sample at rest, deg/s, and the spread of its logarithm over parts. Source: densities of
0.003 to 0.03 deg/s/√Hz in data sheets, in bandwidths of 5 to 200 Hz."""

MOTION_DENSITY = 0.11
"""Probability density of the logarithm of the scatter in motion, uniform from 0.01 to 100 deg/s. Derived: 1/ln(10⁴)."""

WALK_GAIN = 0.05
"""Weight of a squared step between two block means in the angle random walk. Chosen: about twenty count."""

INNOVATION_CLIP = 9.0
"""Largest ratio of a squared step between two block means to its expected value. Derived: 3², three sigmas."""

FLICKER_GAIN = 0.002
FLICKER_CLIP = 4.0
"""Weight of a block in the flicker, and largest ratio of its excess to the expected variance. Chosen: flicker is
learned over minutes, because within seconds a gradual curve looks like flicker."""


def is_stationary(c: RestlevelCoefficients, block: BlockStats, noise: NoiseModel) -> bool:
    """Whether the present block shows no more than the noise of the sensor. The block also updates the noise.

    There is no fixed threshold: the noise comes from the quietest blocks of the sensor itself.
    """
    variance = _variance(block, noise)
    is_starting = noise.stationary_blocks < START_BLOCKS
    if noise.resolution_dps > 0.0 and not noise.has_steps and (is_starting or variance < MAX_NOISE_VAR):
        _forget_blocks(noise)  # blocks of a repeated value show no noise
        variance = _variance(block, noise)
    error = sqrt(2.0 / independent(block))  # relative standard error of a variance
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
        noise.angle_walk_var = 2.0 * noise.sample_var / independent(block) * block.seconds
    return variance < noise.sample_var * limit


def begins_to_measure(noise: NoiseModel) -> bool:
    """Whether the present block is the first with rates of a fine sensor that repeated one value before.

    A device that begins to move shows the fine resolution of its sensor only after some blocks.
    """
    if noise.resolution_dps < 0.0:
        noise.same_blocks += 1
        return False
    if noise.same_blocks > 0:
        noise.same_blocks = -START_BLOCKS
    if noise.same_blocks == 0:
        return False
    is_fine = noise.resolution_dps <= FINE_DPS
    noise.same_blocks = 0 if is_fine else noise.same_blocks + 1
    return is_fine


def forget_noise(noise: NoiseModel) -> None:
    """Forget everything about the noise but the resolution."""
    _forget_blocks(noise)
    noise.angle_walk_var = -1.0
    noise.flicker_var = 0.0


def sensor_odds(sample_var: float) -> float:
    """Likelihood ratio of a variance of samples, (deg/s)²: sensor at rest against motion, at most 1."""
    away = (0.5 * log(sample_var) - log(USUAL_NOISE_DPS)) / NOISE_SPREAD
    away = max(away, 0.0)  # a quiet sensor is no evidence against rest
    return min(1.0, 0.4 / NOISE_SPREAD * exp(-0.5 * away * away) / MOTION_DENSITY)


def learn_at_rest(
    noise: NoiseModel, rest_weight: float, excess_var: float, step_dps: float, block: BlockStats, seconds: float
) -> None:
    """Update flicker and angle random walk by a block at rest.

    Parameters
    ----------
    noise
        Noise of the sensor, which is changed.
    rest_weight
        Probability that the block is at rest.
    excess_var
        Squared innovation minus its expected value, weighted by probability, (deg/s)².
    step_dps
        Step from the mean of the block before to the mean of the block, deg/s.
    block, seconds
        Block, and its length, s.
    """
    noise.flicker_var = max(0.0, noise.flicker_var + FLICKER_GAIN * excess_var)
    noise.is_walk_measured = noise.is_walk_measured or rest_weight > 0.5
    measured_var = min(0.5 * step_dps * step_dps * seconds, INNOVATION_CLIP * noise.angle_walk_var)
    walk_var = noise.angle_walk_var + WALK_GAIN * rest_weight * (measured_var - noise.angle_walk_var)
    noise.angle_walk_var = max(walk_var, _rounding_var(noise) / independent(block) * seconds)


def _forget_blocks(noise: NoiseModel) -> None:
    """Forget the variance of samples, because the sensor shows its steps from now on."""
    noise.sample_var = noise.last_block_var = -1.0
    noise.stationary_blocks = 0
    noise.has_steps, noise.is_walk_measured = True, False


def independent(block: BlockStats) -> int:
    """Number of independent samples of a block: all, unless most repeat the one before; two are the least."""
    return max(block.samples - block.repeats, 2) if 2 * block.repeats >= block.samples else block.samples


def _variance(block: BlockStats, noise: NoiseModel) -> float:
    """Variance of the samples of a block, (deg/s)², at least the variance that rounding may hide."""
    mean_dps = block.sum_dps / block.samples
    return max(block.sum_squares / block.samples - mean_dps * mean_dps, _rounding_var(noise), MIN_VAR)


def _rounding_var(noise: NoiseModel) -> float:
    """Variance that steps of the resolution may hide, (deg/s)²."""
    if not noise.has_steps:
        return UNKNOWN_STEPS_VAR
    return min(0.25 * noise.resolution_dps * noise.resolution_dps, COARSEST_VAR)
