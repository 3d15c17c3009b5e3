"""Levels that wander: whether stationary blocks agree as those of a sensor do, or as those of a motion by chance.

A sensor at rest, or in a constant spin, gives block means that agree but for its noise. A motion whose scatter passes
for noise, as of a vehicle in gentle bends, a boat or a bench that hovers, has stationary blocks too, and their means
step from level to level. Such a level is a coincidence, and says little about the bias.
"""

from math import exp, log

from gyrodrift.filters.restlevel.rate_state import RateWander

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


def count_agreement(wander: RateWander) -> None:
    """A stationary block behind another one has the level that was there so far."""
    wander.log_odds = FORGETTING * wander.log_odds - AGREEMENT_LOG_ODDS


def count_break(wander: RateWander, step_dps: float) -> None:
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
