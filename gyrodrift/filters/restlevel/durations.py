"""Odds of a rest against spins and motions, from the scatter, duration and end of a segment.

A segment is a rest, a constant spin, or a level that a motion has by chance. A motion is as quiet as the sensor, or
noisy. Each kind has a density of its rate, a distribution of its duration and a share of gradual ends. The likelihood
of a kind is their product.
"""

from math import pi, sqrt

from gyrodrift.filters.beliefs import SPINS_PER_DPS, duration_odds
from gyrodrift.filters.restlevel.bias_state import Hypothesis
from gyrodrift.filters.restlevel.rate_state import RateWander
from gyrodrift.filters.restlevel.wander import wander_probability

CHANCE_LEVELS = 4.0
"""Number of chance levels for each constant spin, if levels wander. Chosen: they are more frequent than spins."""

CHANCE_STAYS, NOISY_STAYS = 0.9, 0.985
"""Probabilities that a chance level lasts for a further block, 3 s on average, and a noisy motion whose block means
scatter less than white noise, 20 s. Other noisy motions have no such end. Chosen."""

GRADUAL_REST, GRADUAL_SPIN, GRADUAL_CHANCE = 0.01, 0.1, 0.9
"""Shares of rests, spins and chance levels that end gradually. Chosen: a chance level may be the flat part of a
curve."""


def begin_rest(h: Hypothesis, wander: RateWander, odds: float, sample_var: float, away_dps: float) -> None:
    """Set the prior odds of a rest, and the densities of chance levels and noisy motions at the rate of a segment.

    Parameters
    ----------
    h
        Hypothesis of rest, with the bias before the rest.
    wander
        Agreement of levels.
    odds
        Prior odds of a rest. Odds above 1 are odds against constant spins only: noisy motions are as frequent as rests.
    sample_var
        Variance of the samples, (deg/s)².
    away_dps
        Distance of the mean of the segment from the bias, deg/s.
    """
    by_chance = CHANCE_LEVELS * wander_probability(wander)
    h.rest_odds, h.odds = odds, 1.0
    h.chance_density = by_chance * _cauchy_pdf(away_dps, wander.step_dps * wander.step_dps + h.bias_var)
    h.noisy_density = max(1.0, odds) * _cauchy_pdf(away_dps, sample_var + h.bias_var)


def weigh_rest(h: Hypothesis, seconds: float, sensor_odds: float) -> None:
    """Weigh a rest by its scatter and its length; this replaces the earlier weight of the rest.

    `sensor_odds` is the likelihood ratio of `noise.sensor_odds`.
    """
    motion_density = _spin_density(seconds) + h.chance_density + _noisy_density(h, sensor_odds)
    _weigh(h, h.rest_odds * sensor_odds / motion_density)


def weigh_vibrating_rest(h: Hypothesis, seconds: float, level_density: float) -> None:
    """Weigh a rest in vibration by its level and its length; its scatter is no evidence.

    `level_density` is that of a rest, 1/(deg/s).
    """
    motion_density = _spin_density(seconds) + h.chance_density + h.noisy_density
    _weigh(h, h.rest_odds * level_density / motion_density)


def weigh_gradual_end(h: Hypothesis, seconds: float, sensor_odds: float) -> None:
    """Weigh a rest that has ended gradually."""
    by_motion = h.chance_density + _noisy_density(h, sensor_odds)
    no_rest = GRADUAL_SPIN * _spin_density(seconds) + GRADUAL_CHANCE * by_motion
    _weigh(h, h.rest_odds * sensor_odds * GRADUAL_REST / no_rest)


def outlast_motions(h: Hypothesis, averages_out: bool) -> None:  # noqa: FBT001 - compiled code takes none by name
    """Multiply the densities of motions by the probabilities that such a level lasts for a further block.

    `averages_out` states that the block means scatter less than white noise.
    """
    h.chance_density *= CHANCE_STAYS
    if averages_out:
        h.noisy_density *= NOISY_STAYS


def _weigh(h: Hypothesis, odds: float) -> None:
    """Replace the odds that the weight contains."""
    h.weight *= odds / h.odds
    h.odds = odds


def _spin_density(seconds: float) -> float:
    """Density of spins that last so long, divided by the probability that a rest does, 1/(deg/s)."""
    return SPINS_PER_DPS / duration_odds(seconds)


def _noisy_density(h: Hypothesis, sensor_odds: float) -> float:
    """Density of noisy motions, 1/(deg/s); 0 for a segment that is as quiet as a sensor."""
    return (1.0 - sensor_odds) * h.noisy_density


def _cauchy_pdf(x: float, squared_width: float) -> float:
    """Density of the Cauchy distribution about 0. Half of the distribution lies within the width."""
    width = sqrt(squared_width)
    return width / (pi * (x * x + squared_width))
