"""Restlevel, sample by sample, in plain floats: the one truth that `serve`, `filter`, `tune` and `compare` run.

Batch versions are this very source, compiled, and held to its bits by a test.
"""

from math import isfinite, sqrt

from gyrodrift.filters.restlevel.blocks import CONFIRMED, LEAST_SAMPLES, REMEMBERED, follow_plateau, goes_on
from gyrodrift.filters.restlevel.hypotheses import (
    begin,
    enter_plateau,
    leave_plateau,
    rest_on,
    resume,
    split,
    summarise,
    turn,
)
from gyrodrift.filters.restlevel.model import RestlevelCoefficients, RestlevelParams, RestlevelState

SPINS_PER_DPS = 0.03
"""Probability density of the rates of constant spins, 1/(deg/s): even up to some 15 deg/s either way."""


def coefficients(params: RestlevelParams) -> RestlevelCoefficients:
    """Work out everything that depends on the parameters alone."""
    return RestlevelCoefficients(
        window_s=params.window_s,
        quiet=params.quiet,
        turn_on_var=params.turn_on_dps * params.turn_on_dps,
        walk_var_per_s=params.walk_dps_rts * params.walk_dps_rts,
        drift_dps_s=params.drift_dps_s,
        start_odds_dps=params.still_start / (1.0 - params.still_start) / SPINS_PER_DPS,
        rest_odds_dps=params.rest_share / (1.0 - params.rest_share) / SPINS_PER_DPS,
        scale=params.scale_percent / 100.0,
    )


def step(c: RestlevelCoefficients, s: RestlevelState, t_s: float, rate_dps: float) -> bool:
    """Advance the state by one sample.

    Parameters
    ----------
    c, s
        Coefficients, and the state, which is changed in place.
    t_s
        Device time in s.
    rate_dps
        Measured rate, deg/s, counter-clockwise positive; both plain floats.

    Returns
    -------
    bool
        False where the sample was passed by (T ≤ 0, or a value that is not finite); it is counted in
        `s.rejected` and leaves all else untouched.
    """
    dt_s = t_s - s.t_s if s.samples > 0 else 0.0
    if not (isfinite(t_s) and isfinite(dt_s) and isfinite(rate_dps)) or (s.samples > 0 and dt_s <= 0.0):
        s.rejected += 1
        return False
    s.t_s = t_s
    advance(c, s, dt_s, rate_dps)
    return True


def advance(c: RestlevelCoefficients, s: RestlevelState, dt_s: float, rate_dps: float) -> None:
    """`step` for a sample that is known to be good, `dt_s` after the one before; 0 for the first."""
    if s.samples == 0:
        s.begun_yaw_deg = s.yaw_deg
        s.rate_dps = rate_dps
        begin(c, s)
    else:
        apart_dps = abs(rate_dps - s.rate_dps)
        if apart_dps > 0.0 and (s.least_step_dps < 0.0 or apart_dps < s.least_step_dps):
            s.least_step_dps = apart_dps
    if s.block_samples == 0:
        s.block_first_dps = rate_dps
    above_dps = rate_dps - s.block_first_dps
    s.block_samples += 1
    s.block_sum += above_dps
    s.block_squares += above_dps * above_dps
    s.block_turned_deg += 0.5 * (rate_dps + s.rate_dps) * dt_s
    s.block_seconds += dt_s
    s.rate_dps = rate_dps
    s.samples += 1
    if s.block_seconds >= c.window_s and s.block_samples >= LEAST_SAMPLES:
        _end_block(c, s, s.block_seconds)
    seconds = s.block_seconds
    s.yaw_deg = s.base_yaw_deg + s.block_turned_deg - s.bias_dps * seconds
    scale_deg = c.scale * (s.yaw_deg - s.begun_yaw_deg)
    noise_var = max(0.0, s.density_var)
    moving_var = seconds * (s.base_bias_var * seconds - 2.0 * s.base_covariance + noise_var)
    s.yaw_sigma_deg = sqrt(max(0.0, s.base_yaw_var + moving_var + scale_deg * scale_deg))


def _end_block(c: RestlevelCoefficients, s: RestlevelState, seconds: float) -> None:
    level_dps = s.block_turned_deg / seconds
    step_dps = level_dps - s.plateau_last_dps
    follow_plateau(c, s, level_dps, step_dps, seconds)
    if s.left_blocks == 1:
        leave_plateau(s)
    if s.plateau_blocks == 1:
        enter_plateau(s)
    turn(c, s, s.block_turned_deg, seconds)
    if s.plateau_blocks > CONFIRMED:
        rest_on(c, s, level_dps, step_dps, seconds)
    if s.plateau_blocks > 1:
        s.plateau_level_dps += (level_dps - s.plateau_level_dps) / min(s.plateau_blocks, REMEMBERED)
    if s.plateau_blocks == CONFIRMED:
        if goes_on(c, s, seconds):
            resume(c, s, seconds)
        else:
            split(c, s, seconds)
    summarise(s)
    s.block_seconds = 0.0
    s.block_samples = 0
    s.block_turned_deg = 0.0
    s.block_sum = 0.0
    s.block_squares = 0.0
