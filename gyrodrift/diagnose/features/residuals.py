"""What is left of the rate without the encoder's: second by second against the design, and within seconds."""

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.design_matrix import (
    COLUMNS,
    LAG_FEATURES,
    WARMING_BLOCKS,
    WARMING_FEATURES,
    Design,
    means,
    smoothed,
    smoothed_difference,
)
from gyrodrift.diagnose.features.feature import Feature, Measured
from gyrodrift.diagnose.recording.outliers import Cleaned

SLOW_MEANS = (2, 5, 10, 20, 50)
"""Blocks; the slow features compare neighbouring means of so many seconds."""

WALK_MEANS = (5, 20, 60, 120)
JUMP_MEAN = 4

FEATURES = (
    *(column.feature for column in COLUMNS),
    *LAG_FEATURES,
    *WARMING_FEATURES,
    *(Feature(f"wander_{count}s", "sensor", "late", f"the bias wanders within {2 * count} s") for count in SLOW_MEANS),
    Feature("wander_rest", "sensor", "rest", "the bias wanders while it rests"),
    Feature("step", "sensor", "late", "the bias jumps"),
    Feature("two_levels", "sensor", "always", "the bias sits on two levels"),
    Feature("swing", "sensor", "always", "the bias swings with a period"),
    Feature("ripple", "sensor", "moving", "the bias changes several times per turn"),
    Feature("angle_ripple", "encoder", "moving", "the angle errs several times per turn"),
    *(
        Feature(f"walk_{count}s", "sensor", "late", f"the bias, taken by itself, wanders within {2 * count} s")
        for count in WALK_MEANS
    ),
    Feature("walk_levels", "sensor", "always", "the bias, taken by itself, sits on two levels"),
    Feature("walk_jumps", "sensor", "always", "the bias, taken by itself, moves in jumps"),
    Feature("scatter_moving", "sensor", "moving", "second by second the rate scatters more when it moves"),
    Feature("scatter_accelerating", "sensor", "accelerating", "and more still when it accelerates"),
)

LOG_FLOOR = 0.25
"""Of the logarithm of a variance: an eighth of the amplitude."""

LEAST_DPS = 2e-3
"""Seconds scatter by so much at least, whatever the encoder: added to every spread so that nothing is measured in
shares of nothing."""

SLOW_FLOORS = np.array(
    [LOG_FLOOR] * (len(SLOW_MEANS) + 1)
    + [1.0, 0.3, 0.5, 0.3, 0.3]
    + [LOG_FLOOR] * len(WALK_MEANS)
    + [0.3, 0.3]
    + [LOG_FLOOR] * 2
)

STEP_EDGE = 8
SWING_MEAN, SWING_PERIODS_S, SWING_FINE = 5, (40.0, 200.0), 8
SWING_LEAST = 0.02


def block_residual_dps(seen: Cleaned, design: Design) -> Floats:
    """Mean rate of each block less that of the encoder, deg/s, shape (blocks,)."""
    rate_dps = means(seen.rate_dps, design.block)
    middles = np.concatenate([seen.encoder_deg[:1], 0.5 * (seen.encoder_deg[1:] + seen.encoder_deg[:-1])])
    edges = np.arange(len(rate_dps) + 1) * design.block
    edges[-1] = min(edges[-1], len(middles) - 1)
    residual_dps: Floats = rate_dps - np.diff(middles[edges]) / (np.diff(edges) * design.period_s)
    return residual_dps


def _centred_dps(seen: Cleaned, design: Design) -> Floats:
    residual_dps = block_residual_dps(seen, design)
    level = np.median(residual_dps[design.block_at_rest]) if design.block_at_rest.any() else 0.0
    centred: Floats = residual_dps - level
    return centred


def _left_dps(residual_dps: Floats, static: Floats, design: Design) -> Floats:
    left: Floats = residual_dps - residual_dps.mean() - design.basis @ static
    return left


def left_dps(seen: Cleaned, design: Design) -> Floats:
    """What the regressors leave of the block residuals, deg/s, shape (blocks,)."""
    residual_dps = _centred_dps(seen, design)
    return _left_dps(residual_dps, design.basis.T @ residual_dps, design)


def measure(seen: Cleaned, design: Design) -> Measured:
    """FEATURES of a recording or of a simulation."""
    residual_dps = _centred_dps(seen, design)
    static = design.basis.T @ residual_dps
    away_dps = smoothed(seen.rate_dps, design.period_s) - smoothed_difference(seen.encoder_deg, design.period_s)
    lags = design.lag_basis.T @ away_dps
    left = _left_dps(residual_dps, static, design)
    steady_dps = _steady(residual_dps - design.quick_basis @ (design.quick_basis.T @ residual_dps), design)
    warming = design.warming_basis.T @ np.diff(means(steady_dps, WARMING_BLOCKS))
    slow = np.concatenate([_slow(left, design), _walk(steady_dps), _scatter(left, design)])
    return Measured(
        np.concatenate([static, lags, warming, slow]),
        np.concatenate([design.floors, design.lag_floors, design.warming_floors, SLOW_FLOORS]),
    )


def _slow(left_dps: Floats, design: Design) -> Floats:
    """What the regressors leave: how it wanders, jumps and swings."""
    values = [_log_variance(np.diff(means(left_dps, count))) for count in SLOW_MEANS]
    values.append(_log_variance(left_dps[design.block_at_rest]))
    limit_dps = 4.0 * 1.4826 * float(np.median(np.abs(left_dps))) + LEAST_DPS
    held_dps = np.clip(left_dps, -limit_dps, limit_dps)
    even_dps = np.where(design.block_is_even, held_dps, 0.0)
    values += [_step(even_dps), _two_levels(held_dps[design.block_is_even]), swing_of(even_dps)[0]]
    values += [_ripple(left_dps, basis) for basis in (design.turn_basis, design.turn_rate_basis)]
    return np.array(values)


def _steady(bias_dps: Floats, design: Design) -> Floats:
    """The bias by itself, slow regressors left in it, as it is in the seconds that rest or turn steadily."""
    place = np.arange(len(bias_dps))
    even = design.block_is_even
    steady_dps: Floats = np.interp(place, place[even], bias_dps[even]) if even.any() else bias_dps
    return steady_dps


def _walk(steady_dps: Floats) -> Floats:
    """How the bias by itself wanders and jumps."""
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


def swing_of(bias_dps: Floats, block_s: float = 1.0) -> tuple[float, float]:
    """The best sine within SWING_PERIODS_S: logarithm of what it takes over what it leaves, and its period, s."""
    slow_dps = means(bias_dps, SWING_MEAN)
    if len(slow_dps) < SWING_MEAN:
        return 0.0, 0.0
    place = np.linspace(-1.0, 1.0, len(slow_dps))
    slow_dps = slow_dps - np.polyval(np.polyfit(place, slow_dps, 1), place)
    points = SWING_FINE * len(slow_dps)
    power = np.abs(np.fft.rfft(slow_dps, points)) ** 2
    period_s = points * SWING_MEAN * block_s / np.maximum(np.arange(len(power)), 0.5)
    power[(period_s < SWING_PERIODS_S[0]) | (period_s > SWING_PERIODS_S[1])] = 0.0
    best = int(np.argmax(power))
    total = float(slow_dps @ slow_dps) + len(slow_dps) * LEAST_DPS**2
    share = min(2.0 * float(power[best]) / len(slow_dps) / total, 1.0)
    return float(np.log((share + SWING_LEAST) / (1.0 - share + SWING_LEAST))), float(period_s[best])


def ripple_of(left_dps: Floats, basis: Floats) -> Floats:
    """Share of the mean square that each column of an orthonormal basis takes; shape (columns,)."""
    return np.square(basis.T @ left_dps) / (float(left_dps @ left_dps) + len(left_dps) * LEAST_DPS**2)


def _ripple(left_dps: Floats, basis: Floats) -> float:
    """Logarithm of what a basis takes for each of its columns, over what it leaves for each other dimension."""
    share = min(float(ripple_of(left_dps, basis).sum()), 1.0 - 1e-6)
    others = max(1, len(left_dps) - basis.shape[1])
    return float(np.log1p(share / basis.shape[1] / ((1.0 - share) / others)))
