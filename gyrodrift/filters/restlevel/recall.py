"""Start with a memory of the sensor, and the sure rests that a memory is made from.

Each remembered bias is an additional hypothesis, with a variance that grows with its age. The hypotheses of an unknown
sensor remain. Remembered noise is used from the first block on if the sample period is the same. So motion is
recognized at once, even without a rest at the start. A rest is sure if it is long and very probable.
"""

from math import sqrt

from gyrodrift.filters.restlevel.bias_state import SureRest
from gyrodrift.filters.restlevel.model import RestlevelCoefficients, RestlevelState

SURE_PROBABILITY = 0.95
SURE_S, SURE_BY_WITNESS_S = 10.0, 1.5
"""Probability of a sure rest, and its shortest length, s: by the rate alone, and with an external rest sensor.
Chosen."""

SAME_PERIOD = 0.1
"""Largest relative difference of the sample period from the remembered period. Chosen."""

RECALLED_BLOCKS = 10
"""Number of stationary blocks that remembered noise counts for. Chosen: half of `NOISE_BLOCKS`, so that new blocks can
change it."""


def recall_noise(s: RestlevelState, seconds: float) -> None:
    """Take over the remembered noise at the end of the first block, if the sample period is the same."""
    period_s, noise, recalled = seconds / s.block.samples, s.noise, s.recalled
    if abs(period_s - recalled.period_s) > SAME_PERIOD * recalled.period_s or recalled.period_s == 0.0:
        return
    noise.sample_var = recalled.sample_var
    noise.stationary_blocks = RECALLED_BLOCKS
    noise.angle_walk_var = recalled.angle_walk_var
    noise.is_walk_measured = True
    noise.flicker_var = recalled.flicker_var
    if recalled.resolution_dps > 0.0:
        noise.has_steps = True
        if noise.resolution_dps < 0.0 or recalled.resolution_dps < noise.resolution_dps:
            noise.resolution_dps = recalled.resolution_dps


def note_sure_rest(
    sure: SureRest,
    rest_probability: float,
    bias_dps: float,
    bias_var: float,
    temp_c: float,
    lived_s: float,
    seconds: float,
    is_certain: bool,  # noqa: FBT001 - compiled code takes none by name
) -> bool:
    """Store the bias of an axis if the present block belongs to a sure rest; return whether it does.

    Parameters
    ----------
    sure
        Sure rests, which are changed.
    rest_probability
        Probability of rest.
    bias_dps, bias_var, temp_c
        Bias, deg/s, its variance, and temperature, °C.
    lived_s, seconds
        Time since the first sample, and length of the block, s.
    is_certain
        Whether an external rest sensor confirms the rest.
    """
    if rest_probability < SURE_PROBABILITY:
        sure.seconds = 0.0
        return False
    if sure.seconds == 0.0:
        sure.begin_dps, sure.begin_c = bias_dps, temp_c
    before_s = sure.seconds
    sure.seconds += seconds
    long_s = SURE_BY_WITNESS_S if is_certain else SURE_S
    if sure.seconds < long_s:
        return False
    if before_s < long_s or sure.rests == 0:
        sure.rests += 1
    if sure.rests == 1 and not sure.has_first:
        sure.has_first, sure.first_dps, sure.first_c, sure.first_s = True, sure.begin_dps, sure.begin_c, lived_s
        sure.first_dps_sigma = sqrt(max(0.0, bias_var))
    sure.bias_dps, sure.bias_var, sure.t_s, sure.temp_c = bias_dps, bias_var, lived_s, temp_c
    return True


def remembered_weight(s: RestlevelState) -> float:
    """Probability of all remembered biases together."""
    weight = 0.0
    for memory in s.remembered:
        weight += memory.weight
    return weight


def begin_remembered(c: RestlevelCoefficients, s: RestlevelState) -> None:
    """Set a hypothesis for each remembered bias, in the first slots."""
    count = 0
    for memory in s.remembered:
        if memory.weight > 0.0:
            h = s.hypotheses[count]
            h.weight, h.bias_dps, h.bias_var = memory.weight, memory.bias_dps, memory.bias_var + c.rate_walk_var
            h.yaw_deg = s.yaw_deg
            h.knows_bias = True
            count += 1
