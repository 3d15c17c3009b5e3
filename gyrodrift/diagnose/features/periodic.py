"""Periodic components of what the regressors leave: over time, and over the angle."""

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.block_means import LEAST_DPS, block_means
from gyrodrift.diagnose.features.block_residuals import BlockResiduals
from gyrodrift.diagnose.features.feature import ResponseLaw, Statistic
from gyrodrift.diagnose.features.units import OVER_CHANCE, OVER_REMAINDER

PERIODS_S = (40.0, 200.0)
"""Between these a period is looked for."""

PERIOD_MEAN = 5
"""Blocks in a mean, and the fewest means in which a period is looked for."""

FINE = 8
"""Points of the periodogram for each independent one: a tone between two loses next to nothing."""

LEAST_SHARE = 0.02
"""Added to what a sine takes and to what it leaves: bounds the logarithm of their ratio at 3.9 either way."""

MOST_SHARE = 1.0 - 1e-6
"""Bounds the logarithm where the components of the angle take all."""


def periodic_component(bias_dps: Floats, block_s: float = 1.0) -> tuple[float, float]:
    """The best sine within PERIODS_S: logarithm of what it takes over what it leaves, and its period, s."""
    slow_dps = block_means(bias_dps, PERIOD_MEAN)
    if len(slow_dps) < PERIOD_MEAN:
        return 0.0, 0.0
    place = np.linspace(-1.0, 1.0, len(slow_dps))
    slow_dps = slow_dps - np.polyval(np.polyfit(place, slow_dps, 1), place)
    points = FINE * len(slow_dps)
    power = np.abs(np.fft.rfft(slow_dps, points)) ** 2
    period_s = points * PERIOD_MEAN * block_s / np.maximum(np.arange(len(power)), 0.5)
    power[(period_s < PERIODS_S[0]) | (period_s > PERIODS_S[1])] = 0.0
    best = int(np.argmax(power))
    total = float(slow_dps @ slow_dps) + len(slow_dps) * LEAST_DPS**2
    share = min(2.0 * float(power[best]) / len(slow_dps) / total, 1.0)
    return float(np.log((share + LEAST_SHARE) / (1.0 - share + LEAST_SHARE))), float(period_s[best])


def angle_shares(unexplained_dps: Floats, vectors: Floats) -> Floats:
    """Share of the mean square that each of some orthonormal vectors takes; shape (columns,)."""
    total = float(unexplained_dps @ unexplained_dps) + len(unexplained_dps) * LEAST_DPS**2
    return np.square(vectors.T @ unexplained_dps) / total


def angle_periodic_component(unexplained_dps: Floats, vectors: Floats) -> float:
    """Logarithm of one more than what each vector takes, over what is left for each other dimension."""
    share = min(float(angle_shares(unexplained_dps, vectors).sum()), MOST_SHARE)
    others = max(1, len(unexplained_dps) - vectors.shape[1])
    return float(np.log1p(share / vectors.shape[1] / ((1.0 - share) / others)))


# fmt: off
PERIODIC: tuple[Statistic[BlockResiduals], ...] = (
    Statistic(
        "swing", "sensor", "always", "the bias swings with a period", 0.5,
        "0.5 in ln of a ratio of variances: a quarter of the amplitude", reading=OVER_REMAINDER,
        response=ResponseLaw.LOG_VARIANCE, compute=lambda seen: periodic_component(seen.even_dps)[0],
    ),
    Statistic(
        "ripple", "sensor", "moving", "the bias changes several times per turn", 0.3,
        "0.3 in ln of a ratio of variances: a third more than chance gives", reading=OVER_CHANCE,
        response=ResponseLaw.LOG_VARIANCE,
        compute=lambda seen: angle_periodic_component(seen.unexplained_dps, seen.design.turn_basis),
    ),
    Statistic(
        "angle_ripple", "encoder", "moving", "the angle errs several times per turn", 0.3,
        "0.3 in ln of a ratio of variances: a third more than chance gives", reading=OVER_CHANCE,
        response=ResponseLaw.LOG_VARIANCE,
        compute=lambda seen: angle_periodic_component(seen.unexplained_dps, seen.design.turn_rate_basis),
    ),
)
# fmt: on
