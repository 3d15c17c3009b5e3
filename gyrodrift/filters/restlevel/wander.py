"""Levels that wander: whether stationary blocks agree as those of a sensor do, or as those of a motion by chance.

A sensor at rest, or in a constant spin, gives block means that agree but for its noise. A motion whose scatter passes
for noise, as of a vehicle in gentle bends, a boat or a bench that hovers, has stationary blocks too, and their means
step from level to level. Such a level is a coincidence, and says little about the bias.
"""

from math import exp, log, pi, sqrt

from gyrodrift.filters.restlevel.noise import noise_odds
from gyrodrift.filters.restlevel.rate_state import NoiseModel, RateWander

SENSOR_BREAK, WANDER_BREAK = 0.02, 0.2
"""Probability that the next stationary block does not agree: of a sensor, flicker included, and of wandering levels."""

BREAK_LOG_ODDS = log(WANDER_BREAK / SENSOR_BREAK)
AGREEMENT_ODDS = (1.0 - SENSOR_BREAK) / (1.0 - WANDER_BREAK)
AGREEMENT_LOG_ODDS = log(AGREEMENT_ODDS)
"""What one block says for and against wandering: a sequential probability ratio."""

WANDER_ODDS = 1.0 / 9.0
"""Prior odds that levels wander."""

FORGETTING = 0.98
"""What is left of the evidence with each further block: it is that of some fifty."""

UNKNOWN_STEP_DPS = 10.0
STEP_GAIN = 0.1
"""The typical step between levels before one is seen, deg/s, and the least share of it that a step moves it by."""

CHANCE_LEVELS = 4.0
"""Where levels wander, so many come by chance for one that is a constant spin."""

SPINS_PER_DPS = 0.03
"""Probability density of the rates of constant spins, 1/(deg/s): even up to some 15 deg/s either way."""


def see_agreement(wander: RateWander) -> None:
    """A stationary block behind another one has the level that was there so far."""
    wander.log_odds = FORGETTING * wander.log_odds - AGREEMENT_LOG_ODDS


def see_break(wander: RateWander, step_dps: float) -> None:
    """A stationary block behind another one is this far away from the level that was there so far."""
    wander.log_odds = FORGETTING * wander.log_odds + BREAK_LOG_ODDS
    wander.steps += 1
    gain = max(STEP_GAIN, 1.0 / wander.steps)
    wander.step_dps *= exp(gain if abs(step_dps) > wander.step_dps else -gain)


def forget_levels(wander: RateWander) -> None:
    """The noise has turned out smaller: what passed for stationary so far was motion, and its levels say nothing."""
    wander.log_odds = 0.0
    wander.steps = 0
    wander.step_dps = UNKNOWN_STEP_DPS


def wander_probability(wander: RateWander) -> float:
    """That levels wander."""
    return 1.0 / (1.0 + exp(-wander.log_odds) / WANDER_ODDS)


def level_density(noise: NoiseModel, wander: RateWander, away_dps: float, bias_var: float) -> float:
    """Probability density of the level of a constant-rate segment that is no rest, 1/(deg/s).

    A constant spin has any rate. Levels that wander, and those of a motion that is louder than a sensor, lie about
    the bias: within a typical step, and within that noise.

    Parameters
    ----------
    noise, wander
        What is known of the sensor's noise and of its levels.
    away_dps, bias_var
        How far the level lies from the bias, and the variance of the bias.
    """
    by_chance = CHANCE_LEVELS * wander_probability(wander) * _cauchy_pdf(away_dps, wander.step_dps**2 + bias_var)
    return SPINS_PER_DPS + by_chance + loud_density(noise, away_dps, bias_var)


def loud_density(noise: NoiseModel, away_dps: float, bias_var: float) -> float:
    """The part of it that motions have which are louder than a sensor."""
    return (1.0 - noise_odds(noise)) * _cauchy_pdf(away_dps, noise.sample_var + bias_var)


def _cauchy_pdf(x: float, squared_width: float) -> float:
    """Density of the Cauchy distribution about 0: half of it lies within the width."""
    width = sqrt(squared_width)
    return width / (pi * (x * x + squared_width))
