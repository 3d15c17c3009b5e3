"""Features of the block residuals: wander, scatter and periods of the bias beyond the regressors."""

import numpy as np

from gyrodrift.diagnose.features.block_means import LEAST_DPS, block_means, log_variance
from gyrodrift.diagnose.features.block_residuals import BlockResiduals
from gyrodrift.diagnose.features.feature import (
    AMPLITUDE_DPS,
    OVER_CHANCE,
    OVER_REST,
    ResponseLaw,
    Statistic,
)
from gyrodrift.diagnose.recording.order_statistics import median
from gyrodrift.values.arrays import Floats

WANDER_MEANS = (2, 5, 10, 20, 50)
WALK_MEANS = (5, 20, 60, 120)
"""Blocks in the means whose successive differences are features, for residuals and for the bias. Chosen: about even on
a logarithmic scale, from seconds to minutes."""

EIGHTH = (0.25, "0.25 in ln of a variance: an eighth of the amplitude")
"""Relevance threshold of the logarithm of a variance, and its meaning. Chosen: the yaw by a wandering bias then changes
by an eighth."""


def _wander(count: int) -> Statistic[BlockResiduals]:
    return Statistic(
        f"wander_{count}s", "sensor", "late", f"the bias wanders within {2 * count} s", *EIGHTH, reading=AMPLITUDE_DPS,
        response=ResponseLaw.LOG_VARIANCE, compute=lambda blocks: _log_step_variance(blocks.unexplained_dps, count),
    )  # fmt: skip


def _walk(count: int) -> Statistic[BlockResiduals]:
    return Statistic(
        f"walk_{count}s", "sensor", "late", f"the bias, taken by itself, wanders within {2 * count} s", *EIGHTH,
        reading=AMPLITUDE_DPS, response=ResponseLaw.LOG_VARIANCE,
        compute=lambda blocks: _log_step_variance(blocks.bias_dps, count),
    )  # fmt: skip


def _log_step_variance(dps: Floats, count: int) -> float:
    """Logarithm of the variance of differences between successive means of `count` blocks."""
    return log_variance(np.diff(block_means(dps, count)))


def _moving_against_rest(blocks: BlockResiduals) -> float:
    """Log ratio of the variances in motion and at rest."""
    rests = blocks.design.regimes.block_at_rest
    return log_variance(blocks.unexplained_dps[~rests]) - log_variance(blocks.unexplained_dps[rests])


def _accelerating_against_steady(blocks: BlockResiduals) -> float:
    """Log ratio of the variances of two halves of the moving blocks: larger and smaller change of the rate."""
    regimes = blocks.design.regimes
    moving_dps = blocks.unexplained_dps[~regimes.block_at_rest]
    change_dps = np.abs(np.gradient(regimes.block_rate_dps))[~regimes.block_at_rest]
    is_quick = change_dps > median(change_dps) if len(change_dps) else np.zeros(0, bool)
    return log_variance(moving_dps[is_quick]) - log_variance(moving_dps[~is_quick])


# fmt: off
WANDER: tuple[Statistic[BlockResiduals], ...] = (
    *(_wander(count) for count in WANDER_MEANS),
    Statistic(
        "wander_rest", "sensor", "rest", "the bias wanders at rest", *EIGHTH, reading=AMPLITUDE_DPS,
        response=ResponseLaw.LOG_VARIANCE,
        compute=lambda blocks: log_variance(blocks.unexplained_dps[blocks.design.regimes.block_at_rest]),
    ),
)
"""Features of the residuals after all static regressors."""

WALK: tuple[Statistic[BlockResiduals], ...] = (
    *(_walk(count) for count in WALK_MEANS),
)
"""Features of the bias, with slow regressors."""

SCATTER: tuple[Statistic[BlockResiduals], ...] = (
    Statistic(
        "scatter_moving", "sensor", "moving", "the rate scatters more in motion, second by second", *EIGHTH,
        reading=OVER_REST, response=ResponseLaw.LOG_VARIANCE, compute=_moving_against_rest,
    ),
    Statistic(
        "scatter_accelerating", "sensor", "accelerating", "the rate scatters more while it accelerates", *EIGHTH,
        reading=OVER_REST, response=ResponseLaw.LOG_VARIANCE, compute=_accelerating_against_steady,
    ),
)
# fmt: on
"""Features that compare the scatter of two sets of blocks."""


def angle_shares(unexplained_dps: Floats, vectors: Floats) -> Floats:
    """Share of the sum of squares that an orthonormal vector explains; shape (columns,)."""
    total = float(unexplained_dps @ unexplained_dps) + len(unexplained_dps) * LEAST_DPS**2
    return np.square(vectors.T @ unexplained_dps) / total


def angle_periodic_component(unexplained_dps: Floats, vectors: Floats) -> float:
    """log(1 + F), where F is the mean square explained per vector over the mean square of the remaining dimensions."""
    # The upper limit keeps the ratio finite if the vectors explain everything.
    share = min(float(angle_shares(unexplained_dps, vectors).sum()), 1.0 - 1e-6)
    remaining = max(1, len(unexplained_dps) - vectors.shape[1])
    return float(np.log1p(share / vectors.shape[1] / ((1.0 - share) / remaining)))


# fmt: off
PERIODIC: tuple[Statistic[BlockResiduals], ...] = (
    Statistic(
        "ripple", "sensor", "moving", "the bias changes several times per turn", 0.3,
        "0.3 in ln of a ratio of variances: a third more than chance gives", reading=OVER_CHANCE,
        response=ResponseLaw.LOG_VARIANCE,
        compute=lambda blocks: angle_periodic_component(blocks.unexplained_dps, blocks.design.turn_basis),
    ),
    Statistic(
        "angle_ripple", "encoder", "moving", "the angle errs several times per turn", 0.3,
        "0.3 in ln of a ratio of variances: a third more than chance gives", reading=OVER_CHANCE,
        response=ResponseLaw.LOG_VARIANCE,
        compute=lambda blocks: angle_periodic_component(blocks.unexplained_dps, blocks.design.turn_rate_basis),
    ),
)
# fmt: on
