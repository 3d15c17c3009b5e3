"""The rate in blocks: how noisy the sensor is by itself, which blocks are quiet, and how long a level lasts."""

from math import exp, sqrt

from gyrodrift.filters.restlevel.model import RestlevelCoefficients, RestlevelState

LEAST_SAMPLES = 6
"""Of a block: a variance of fewer says little."""

LEAST_VAR = 1e-12

CONFIRMED = 5
"""Blocks after which a plateau is one: the turning point of a gentle curve is over by then."""

LEVEL_SIGMAS = 4.0
"""A block whose mean is further from the level than this begins another plateau."""

EVEN_SIGMAS = 2.0
"""The two ends of a plateau that is to be confirmed may differ by this: a curve's do."""

GENTLE_DPS_S = 0.4
"""A plateau that is left by less than this, deg/s², with nothing but its level changing, is left gently."""

RESUMED = 10
"""A level that comes back within so many blocks has not been away; one that begins by then began at the start."""

LONG_S = 15.0
LONG_SIGMAS = 6.0
"""After a plateau of this length the level may come back as far off as this: a bias that jumped, rather than a spin."""

REMEMBERED = 10
"""Blocks that the level of a plateau is the mean of."""

FEW = 20
"""Up to so many quiet blocks the noise is their mean, and itself uncertain; later it follows."""

NOISE_GAIN = 0.05
NOISE_RISE = 0.001
"""The noise follows quiet blocks by this exponent, and rises by this share of itself a second in all others: a motor
that was switched on."""

DROP_SIGMAS = 4.5
"""Two blocks in a row that are quieter than the noise by so many standard errors are the noise."""


def is_quiet(c: RestlevelCoefficients, s: RestlevelState, seconds: float) -> bool:
    """Whether the block that has just ended shows no more than the sensor's noise, which is followed here.

    Nothing is compared with a fixed threshold: noise is what the quietest blocks of this very sensor show.
    """
    mean = s.block_sum / s.block_samples
    resolution_var = 0.25 * s.least_step_dps * s.least_step_dps if s.least_step_dps > 0.0 else 0.0
    variance = max(s.block_squares / s.block_samples - mean * mean, resolution_var, LEAST_VAR)
    error = sqrt(2.0 / s.block_samples)  # of a variance, relative
    if s.noise_var < 0.0:
        s.noise_var = variance
    limit = 1.0 + c.quiet * error * sqrt(1.0 + 1.0 / max(s.quiet_blocks, 1))
    if max(variance, s.variance_before) < s.noise_var * exp(-DROP_SIGMAS * error):
        s.noise_var = max(variance, s.variance_before)
    elif variance < s.noise_var * limit:
        s.quiet_blocks = min(s.quiet_blocks + 1, FEW)
        if s.quiet_blocks < FEW:
            s.noise_var += (variance - s.noise_var) / s.quiet_blocks
        else:
            s.noise_var *= (variance / s.noise_var) ** NOISE_GAIN
    else:
        s.noise_var *= 1.0 + NOISE_RISE * seconds
    s.variance_before = variance
    if not s.knows_density:
        s.density_var = 2.0 * s.noise_var / s.block_samples * seconds
    return variance < s.noise_var * limit


def follow_plateau(
    c: RestlevelCoefficients, s: RestlevelState, level_dps: float, step_dps: float, seconds: float
) -> None:
    """Count the blocks of the present plateau: 0 where there is none, 1 where one begins."""
    blocks_before, level_before_dps = s.plateau_blocks, s.plateau_level_dps
    is_now_quiet = is_quiet(c, s, seconds)
    s.blocks += 1
    level_var = s.density_var / seconds
    drift_dps = c.drift_dps_s * seconds
    if not is_now_quiet:
        s.plateau_blocks = 0
    elif s.plateau_blocks == 0 or not _is_level(s, level_dps, level_var, drift_dps):
        s.plateau_blocks = 1
        s.plateau_head_dps = s.plateau_level_dps = level_dps
    else:
        s.plateau_blocks += 1
        if s.plateau_blocks == 2:
            s.plateau_head_dps += level_dps
        if s.plateau_blocks == CONFIRMED:
            uneven_dps = 0.5 * (s.plateau_last_dps + level_dps - s.plateau_head_dps)
            if abs(uneven_dps) >= EVEN_SIGMAS * sqrt(level_var + 4.0 * drift_dps * drift_dps):
                s.plateau_blocks = 0
    s.plateau_last_dps = level_dps
    if blocks_before >= CONFIRMED > s.plateau_blocks:
        s.left_level_dps, s.left_blocks = level_before_dps, 0
        s.left_long = blocks_before * seconds >= LONG_S
        s.left_gently = is_now_quiet and abs(step_dps) < GENTLE_DPS_S * seconds
    s.left_blocks += 1


def goes_on(c: RestlevelCoefficients, s: RestlevelState, seconds: float) -> bool:
    """Whether a plateau that has just been confirmed is the one before."""
    level_var = s.density_var / seconds
    drift_dps = c.drift_dps_s * seconds * s.left_blocks
    spread = level_var * (1.0 / CONFIRMED + 1.0 / REMEMBERED) + drift_dps * drift_dps + s.flicker_var
    sigmas = LONG_SIGMAS if s.left_long else LEVEL_SIGMAS
    off_dps = s.plateau_level_dps - s.left_level_dps
    return s.left_blocks <= RESUMED + CONFIRMED and abs(off_dps) < sigmas * sqrt(spread)


def _is_level(s: RestlevelState, level_dps: float, level_var: float, drift_dps: float) -> bool:
    spread = level_var * (1.0 + 1.0 / min(s.plateau_blocks, REMEMBERED)) + drift_dps * drift_dps + s.flicker_var
    return abs(level_dps - s.plateau_level_dps) < LEVEL_SIGMAS * sqrt(spread)
