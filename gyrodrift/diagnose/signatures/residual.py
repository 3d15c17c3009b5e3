"""What is left of the rate without the encoder's: second by second against the design, and within seconds."""

import numpy as np

from gyrodrift.diagnose.clean import Cleaned
from gyrodrift.diagnose.design import (
    COLUMNS,
    LAG_SIGNATURES,
    Design,
    means,
    smoothed,
    smoothed_difference,
)
from gyrodrift.diagnose.signatures.signature import Measured, Signature
from gyrodrift.session.session import Floats

SLOW_MEANS = (2, 5, 10, 20, 50)
"""Blocks; the slow signatures compare neighbouring means of so many seconds."""

WALK_MEANS = (5, 20, 60, 120)
JUMP_MEAN = 4

SIGNATURES = (
    *(column.signature for column in COLUMNS),
    *LAG_SIGNATURES,
    *(
        Signature(f"wander_{count}s", "sensor", "late", f"the bias wanders within {2 * count} s")
        for count in SLOW_MEANS
    ),
    Signature("wander_rest", "sensor", "rest", "the bias wanders while it rests"),
    Signature("step", "sensor", "late", "the bias jumps"),
    Signature("two_levels", "sensor", "always", "the bias sits on two levels"),
    Signature("cycle", "sensor", "always", "the bias swings with a period"),
    *(
        Signature(f"walk_{count}s", "sensor", "late", f"the bias, taken by itself, wanders within {2 * count} s")
        for count in WALK_MEANS
    ),
    Signature("walk_levels", "sensor", "always", "the bias, taken by itself, sits on two levels"),
    Signature("walk_jumps", "sensor", "always", "the bias, taken by itself, moves in jumps"),
    Signature("scatter_moving", "sensor", "moving", "second by second the rate scatters more when it moves"),
    Signature("scatter_accelerating", "sensor", "accelerating", "and more still when it accelerates"),
)

LOG_FLOOR = 0.25
"""Of the logarithm of a variance: an eighth of the amplitude."""

LEAST_DPS = 2e-3
"""Seconds scatter by so much at least, whatever the encoder: added to every spread so that nothing is measured in
shares of nothing."""

SLOW_FLOORS = np.array(
    [LOG_FLOOR] * (len(SLOW_MEANS) + 1) + [1.0, 0.3, 0.5] + [LOG_FLOOR] * len(WALK_MEANS) + [0.3, 0.3] + [LOG_FLOOR] * 2
)

STEP_EDGE = 8
CYCLE_LEAST = 3


def block_residual_dps(seen: Cleaned, design: Design) -> Floats:
    """Mean rate of each block less that of the encoder, deg/s, shape (blocks,)."""
    rate_dps = means(seen.rate_dps, design.block)
    middles = np.concatenate([seen.encoder_deg[:1], 0.5 * (seen.encoder_deg[1:] + seen.encoder_deg[:-1])])
    edges = np.arange(len(rate_dps) + 1) * design.block
    edges[-1] = min(edges[-1], len(middles) - 1)
    residual_dps: Floats = rate_dps - np.diff(middles[edges]) / (np.diff(edges) * design.period_s)
    return residual_dps


def measure(seen: Cleaned, design: Design) -> Measured:
    """SIGNATURES of a recording or of a simulation."""
    residual_dps = block_residual_dps(seen, design)
    residual_dps = residual_dps - np.median(residual_dps[design.block_at_rest] if design.block_at_rest.any() else 0.0)
    static = design.basis.T @ residual_dps
    away_dps = smoothed(seen.rate_dps, design.period_s) - smoothed_difference(seen.encoder_deg, design.period_s)
    lags = design.lag_basis.T @ away_dps
    left_dps = residual_dps - residual_dps.mean() - design.basis @ static
    walk_dps = residual_dps - design.quick_basis @ (design.quick_basis.T @ residual_dps)
    slow = np.concatenate([_slow(left_dps, design), _walk(walk_dps, design), _scatter(left_dps, design)])
    return Measured(
        np.concatenate([static, lags, slow]), np.concatenate([design.floors, design.lag_floors, SLOW_FLOORS])
    )


def _slow(left_dps: Floats, design: Design) -> Floats:
    """What the regressors leave: how it wanders, jumps and swings."""
    values = [_log_variance(np.diff(means(left_dps, count))) for count in SLOW_MEANS]
    values.append(_log_variance(left_dps[design.block_at_rest]))
    limit_dps = 4.0 * 1.4826 * float(np.median(np.abs(left_dps))) + LEAST_DPS
    held_dps = np.clip(left_dps, -limit_dps, limit_dps)
    even_dps = np.where(design.block_is_even, held_dps, 0.0)
    values += [_step(even_dps), _two_levels(held_dps[design.block_is_even]), _cycle(even_dps)]
    return np.array(values)


def _walk(walk_dps: Floats, design: Design) -> Floats:
    """The bias by itself, slow regressors left in it, over the seconds that rest or turn steadily."""
    place = np.arange(len(walk_dps))
    even = design.block_is_even
    steady_dps = np.interp(place, place[even], walk_dps[even]) if even.any() else walk_dps
    values = [_log_variance(np.diff(means(steady_dps, count))) for count in WALK_MEANS]
    steps_dps = np.diff(means(steady_dps, JUMP_MEAN))
    spread = np.mean(np.square(steps_dps)) + LEAST_DPS**2 / JUMP_MEAN
    jumps = float(np.log1p(np.mean(steps_dps**4) / spread**2))
    return np.array([*values, _two_levels(steady_dps), jumps])


def _scatter(left_dps: Floats, design: Design) -> Floats:
    """Second by second, in motion beside at rest, and where it accelerates beside where it does not."""
    rest, moving = left_dps[design.block_at_rest], left_dps[~design.block_at_rest]
    change_dps = np.abs(np.gradient(design.block_rate_dps))[~design.block_at_rest]
    quick = change_dps > np.median(change_dps) if len(change_dps) else np.zeros(0, bool)
    return np.array(
        [_log_variance(moving) - _log_variance(rest), _log_variance(moving[quick]) - _log_variance(moving[~quick])]
    )


def _log_variance(values: Floats) -> float:
    """Logarithm of the mean square, a few wild ones held back; of an empty set that of LEAST_DPS."""
    squares = np.square(values) if len(values) else np.zeros(1)
    limit = 30.0 * float(np.median(squares)) + LEAST_DPS**2
    return float(np.log(np.minimum(squares, limit).mean() + LEAST_DPS**2))


def _step(left_dps: Floats) -> float:
    """The largest sum up to a point, in standard errors of what would be white."""
    if len(left_dps) < 3 * STEP_EDGE:
        return 0.0
    sums = np.cumsum(left_dps - left_dps.mean())
    spread = np.sqrt(np.mean(np.square(left_dps))) + LEAST_DPS
    return float(np.abs(sums[STEP_EDGE:-STEP_EDGE]).max() / (spread * np.sqrt(len(left_dps))))


def _two_levels(left_dps: Floats) -> float:
    """How flat the distribution of five-second means is: 0 for normal, below for two levels; kurtosis, held to ±1."""
    slow = means(left_dps, 5)
    variance = float(np.var(slow)) + LEAST_DPS**2 / 5.0
    return float(np.clip(np.mean((slow - slow.mean()) ** 4) / variance**2 - 3.0, -2.0, 2.0)) if len(slow) > 8 else 0.0


def _cycle(left_dps: Floats) -> float:
    """Logarithm of the strongest line below a fifth of a hertz over the mean of all."""
    power = np.abs(np.fft.rfft(left_dps)) ** 2
    low = power[CYCLE_LEAST : max(CYCLE_LEAST + 2, len(left_dps) // 5)]
    return float(np.log(low.max() / (low.mean() + len(left_dps) * LEAST_DPS**2) + 1.0))
