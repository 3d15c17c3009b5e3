"""Probability that the levels of stationary blocks wander, as they do in a motion.

At rest or in a constant spin, block means agree within the noise of the sensor. Some motions scatter as little as the
noise: of a vehicle in slight bends, a boat, or a hovering bench. They have stationary blocks, too, but the block means
step from level to level. A level of such a motion is a coincidence, and weak evidence about the bias.
"""

from math import exp, log

from gyrodrift.filters.restlevel.rate_state import RateWander

SENSOR_BREAK, WANDER_BREAK = 0.02, 0.2
"""Probability that the next stationary block leaves the level: of a sensor with flicker, and of wandering levels.
Chosen."""

BREAK_LOG_ODDS = log(WANDER_BREAK / SENSOR_BREAK)
AGREEMENT_ODDS = (1.0 - SENSOR_BREAK) / (1.0 - WANDER_BREAK)
AGREEMENT_LOG_ODDS = log(AGREEMENT_ODDS)
"""Log likelihood ratios of a sequential probability ratio test: for wandering levels by a block that leaves the level,
and against them by a block that agrees. Derived: ratios of the two probabilities."""

WANDER_ODDS = 1.0 / 9.0
"""Prior odds that levels wander. Chosen: a probability of 0.1."""

FORGETTING = 0.98
"""Share of the log odds that a further block leaves. Chosen: about fifty blocks count."""

UNKNOWN_STEP_DPS = 10.0
STEP_GAIN = 0.1
"""Median step between levels before the first step, deg/s, and the smallest change of its logarithm by a step.
Chosen."""


def count_agreement(wander: RateWander) -> None:
    """Count a stationary block that follows a stationary block and agrees with its level."""
    wander.log_odds = FORGETTING * wander.log_odds - AGREEMENT_LOG_ODDS


def count_break(wander: RateWander, step_dps: float) -> None:
    """Count a stationary block that follows a stationary block and leaves its level by a step, deg/s."""
    wander.log_odds = FORGETTING * wander.log_odds + BREAK_LOG_ODDS
    wander.steps += 1
    gain = max(STEP_GAIN, 1.0 / wander.steps)
    wander.step_dps *= exp(gain if abs(step_dps) > wander.step_dps else -gain)


def forget_levels(wander: RateWander) -> None:
    """Forget all levels after a drop of the noise: the blocks so far were motion."""
    wander.log_odds = 0.0
    wander.steps = 0
    wander.step_dps = UNKNOWN_STEP_DPS


def wander_probability(wander: RateWander) -> float:
    """Probability that levels wander."""
    return 1.0 / (1.0 + exp(-wander.log_odds) / WANDER_ODDS)
