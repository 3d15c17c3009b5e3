"""Rests against all that is no rest: how a segment scatters, how long it lasts and how it ends.

A segment is a rest, a constant spin, or a level that a motion has by chance. Motions are as quiet as a sensor, or loud.
Each kind has a density of its rate, a distribution of its duration and a share of gradual ends, which are multiplied.
"""

from math import pi, sqrt

from gyrodrift.filters.restlevel.bias_state import Hypothesis
from gyrodrift.filters.restlevel.rate_state import RateWander
from gyrodrift.filters.restlevel.wander import wander_probability

SPINS_PER_DPS = 0.03
"""Probability density of the rates of constant spins, 1/(deg/s): even up to some 15 deg/s in both directions."""

CHANCE_LEVELS = 4.0
"""Number of levels by chance for each constant spin, where levels wander."""

LEVEL_S = 12.0
"""Share of rests that last longer than t: 1/√(1 + (t/12)²), half of them 20 s. Spins: to the power 1.5, half 15 s."""

CHANCE_STAYS = 0.9
"""Probability that a level by chance lasts for one more block, 3 s on average. A noisy motion has no such end."""

GRADUAL_REST, GRADUAL_SPIN, GRADUAL_CHANCE = 0.01, 0.1, 0.9
"""Share of rests, of spins, and of levels by chance (the flat part of a curve) that end gradually."""


def begin_rest(h: Hypothesis, wander: RateWander, odds: float, sample_var: float, away_dps: float) -> None:
    """Set the densities of all that is no rest at the rate of a segment.

    Parameters
    ----------
    h
        A hypothesis of rest, with the bias from before it.
    wander
        How levels wander.
    odds
        Prior odds of a rest. Odds above 1 are odds against constant spins: loud motions are as frequent as rests.
    sample_var
        Variance of the samples, (deg/s)².
    away_dps
        Distance of the segment's mean from the bias.
    """
    by_chance = CHANCE_LEVELS * wander_probability(wander)
    h.rest_odds, h.odds = odds, 1.0
    h.chance_density = by_chance * _cauchy_pdf(away_dps, wander.step_dps * wander.step_dps + h.bias_var)
    h.noisy_density = max(1.0, odds) * _cauchy_pdf(away_dps, sample_var + h.bias_var)


def weigh_rest(h: Hypothesis, seconds: float, sensor_odds: float) -> None:
    """Weigh a rest by its scatter and by how long it has lasted; this replaces the weighing before.

    `sensor_odds` as in `noise.sensor_odds`.
    """
    _weigh(
        h,
        h.rest_odds * sensor_odds / (_spin_density(seconds) + h.chance_density + _noisy_density(h, sensor_odds)),
    )


def weigh_gradual_end(h: Hypothesis, seconds: float, sensor_odds: float) -> None:
    """Weigh a rest that has ended gradually."""
    by_motion = h.chance_density + _noisy_density(h, sensor_odds)
    no_rest = GRADUAL_SPIN * _spin_density(seconds) + GRADUAL_CHANCE * by_motion
    _weigh(h, h.rest_odds * sensor_odds * GRADUAL_REST / no_rest)


def outlast_motions(h: Hypothesis) -> None:
    """Count a further block of a rest: a level by chance has ended by then, with its probability."""
    h.chance_density *= CHANCE_STAYS


def _weigh(h: Hypothesis, odds: float) -> None:
    h.weight *= odds / h.odds
    h.odds = odds


def _spin_density(seconds: float) -> float:
    """Density of spins that last so long, divided by the share of rests that do."""
    return SPINS_PER_DPS / sqrt(sqrt(1.0 + seconds * seconds / (LEVEL_S * LEVEL_S)))


def _noisy_density(h: Hypothesis, sensor_odds: float) -> float:
    return (1.0 - sensor_odds) * h.noisy_density


def _cauchy_pdf(x: float, squared_width: float) -> float:
    """Density of the Cauchy distribution about 0: half of it lies within the width."""
    width = sqrt(squared_width)
    return width / (pi * (x * x + squared_width))
