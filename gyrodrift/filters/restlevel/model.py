"""What restlevel consists of: parameters, what follows from them, what it holds for possible, and its state."""

from dataclasses import dataclass, field
from typing import Annotated

from annotated_types import Ge, Gt, Le, Lt

MOST = 6
"""Accounts that are kept from one plateau to the next; each can become two at a plateau."""


@dataclass(frozen=True, slots=True)
class RestlevelParams:
    """What a person or `tune` sets.

    window_s
        Length of the blocks that rest is looked for in, s. Small: short stops are found. Large: noise averages out.
    quiet
        How much the variance of a block may lie above that of the sensor's own noise, in standard errors. Small:
        noisy rests are missed. Large: gentle motion passes for rest until its level gives it away.
    turn_on_dps
        Standard deviation of the bias at power-on, deg/s. Small: a first level far from zero is taken for a spin.
        Large: a slow spin is taken for a bias.
    walk_dps_rts
        How fast the bias walks, deg/s/√s. Small: long averages. Large: every rest begins anew.
    drift_dps_s
        The fastest that a bias drifts, deg/s², while the sensor warms up or the air changes. Small: a rest after a
        fast change is taken for a spin. Large: a slow change of a true rate is taken for drift.
    still_start
        Probability that the device stands still when its first sample comes. Near 1: a level from the first sample
        on is a bias. Small: it is a spin until the rate has come back to it. Nothing in the rate tells the two apart.
    rest_share
        Probability that a later constant level is a rest, before it is compared with anything. Small: a level has
        to come back before it is believed. Large: the first one is.
    scale_percent
        Standard deviation of the scale factor, %. It changes nothing but `yaw_sigma_deg`.
    """

    window_s: Annotated[float, Gt(0.0), Le(60.0)] = 0.3
    quiet: Annotated[float, Gt(0.0), Le(100.0)] = 5.0
    turn_on_dps: Annotated[float, Gt(0.0), Le(1000.0)] = 0.5
    walk_dps_rts: Annotated[float, Ge(0.0), Le(10.0)] = 0.0005
    drift_dps_s: Annotated[float, Ge(0.0), Le(10.0)] = 0.004
    still_start: Annotated[float, Ge(0.0), Lt(1.0)] = 0.99
    rest_share: Annotated[float, Ge(0.0), Lt(1.0)] = 0.2
    scale_percent: Annotated[float, Ge(0.0), Le(100.0)] = 1.0


@dataclass(frozen=True, slots=True)
class RestlevelCoefficients:
    """What follows from the parameters alone: variances in place of standard deviations, odds for probabilities.

    start_odds_dps, rest_odds_dps
        Odds of a rest against a spin of some constant rate, at the start and later, deg/s: times a probability
        density of levels they are a number.
    """

    window_s: float
    quiet: float
    turn_on_var: float
    walk_var_per_s: float
    drift_dps_s: float
    start_odds_dps: float
    rest_odds_dps: float
    scale: float


@dataclass(slots=True)
class Account:
    """One account of what has happened: which of the plateaus were rests. A slot of weight 0 is free.

    weight
        Its probability.
    bias_dps, yaw_deg
        What follows from it.
    bias_var, covariance, yaw_var
        How certain that is, (deg/s)², deg²/s and deg².
    knows_bias
        There has been a rest in it. Until then the bias is 0 with the spread of the power-on.
    rests, rested
        The device stands still now; it did on the plateau before.
    is_news
        That it rests has taught this account a bias it did not expect, and not for long yet.
    moved_s
        Time since the last rest, s.
    entry_yaw_deg, entry_covariance, entry_yaw_var, entry_moved_s
        As they were where the plateau began: what is gained in a rest is taken back.
    """

    weight: float = 0.0
    bias_dps: float = 0.0
    yaw_deg: float = 0.0
    bias_var: float = 0.0
    covariance: float = 0.0
    yaw_var: float = 0.0
    knows_bias: bool = False
    rests: bool = False
    rested: bool = False
    is_news: bool = False
    moved_s: float = 0.0
    entry_yaw_deg: float = 0.0
    entry_covariance: float = 0.0
    entry_yaw_var: float = 0.0
    entry_moved_s: float = 0.0


def _no_accounts() -> list[Account]:
    return [Account() for _ in range(2 * MOST)]


@dataclass(slots=True)
class RestlevelState:
    """All that changes from sample to sample; a deep copy of it is the filter saved.

    t_s, rate_dps
        Of the last accepted sample.
    yaw_deg, yaw_sigma_deg
        Yaw, 0 at the first sample, and its standard deviation.
    bias_dps, bias_sigma_dps
        The drift estimate, and its standard deviation.
    rest_probability
        Probability that the device stands still, as of the last block.
    confidence
        Probability of the account that is believed most.
    samples, rejected
        Samples accepted, and samples passed by because T ≤ 0 or the rate or time was not finite.

    block_*
        The block that is being filled: its length, its samples, the angle turned in deg, and sums of rates and
        squares less its first rate.
    noise_var, variance_before, least_step_dps, density_var
        Of the sensor itself: variance of samples at rest; variance of the last block; smallest step between two
        samples, which is the resolution; variance of a block's mean times its length, (deg/s)²·s. −1 until known.
    quiet_blocks, knows_density
        Blocks that the noise is known from, up to 20; whether the density has been seen at a rest, or is only what
        white noise would make it.
    flicker_var
        By how much levels at rest wander beyond that within seconds, (deg/s)².
    blocks
        Ended so far.
    plateau_*
        Constant rate: its blocks so far, 0 for none; its level now; the sum of its first two levels; the last level.
    left_level_dps, left_gently, left_long, left_blocks
        Level of the last plateau that was confirmed, whether it ended gently and had been a long one, and the blocks
        since it ended.
    base_*
        The accounts taken together as the block began: yaw, its variances.
    """

    t_s: float = 0.0
    rate_dps: float = 0.0
    yaw_deg: float = 0.0
    yaw_sigma_deg: float = 0.0
    bias_dps: float = 0.0
    bias_sigma_dps: float = 0.0
    rest_probability: float = 0.0
    confidence: float = 1.0
    samples: int = 0
    rejected: int = 0
    block_seconds: float = 0.0
    block_samples: int = 0
    block_turned_deg: float = 0.0
    block_first_dps: float = 0.0
    block_sum: float = 0.0
    block_squares: float = 0.0
    noise_var: float = -1.0
    variance_before: float = -1.0
    least_step_dps: float = -1.0
    density_var: float = -1.0
    quiet_blocks: int = 0
    knows_density: bool = False
    flicker_var: float = 0.0
    blocks: int = 0
    plateau_blocks: int = 0
    plateau_level_dps: float = 0.0
    plateau_head_dps: float = 0.0
    plateau_last_dps: float = 0.0
    left_level_dps: float = 0.0
    left_gently: bool = False
    left_long: bool = False
    left_blocks: int = 1 << 30
    base_yaw_deg: float = 0.0
    base_yaw_var: float = 0.0
    base_covariance: float = 0.0
    base_bias_var: float = 0.0
    begun_yaw_deg: float = 0.0
    accounts: list[Account] = field(default_factory=_no_accounts)
