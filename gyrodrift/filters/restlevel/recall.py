"""What restlevel begins with where it remembers its sensor, and what it is sure of, to be remembered.

A remembered bias is one hypothesis more, with the spread that its age gives it; the sensor may still be as any other,
which the others say. Remembered noise is taken over with the first block if samples come as often as they did: what is
louder is motion, and a start in motion is not blind. Sure are rests of some length that hardly anything speaks against.
"""

from gyrodrift.filters.restlevel.model import RestlevelCoefficients, RestlevelState

SURE_PROBABILITY = 0.95
SURE_S, SURE_BY_WITNESS_S = 10.0, 1.5
"""A rest is sure where it is as probable as this for so long; by a witness sooner."""

SAME_PERIOD = 0.1
"""By so much, relative, the time between two samples may be another than remembered."""

RECALLED_BLOCKS = 10
"""Stationary blocks that remembered noise counts for: new ones may move it."""


def recall_noise(s: RestlevelState, seconds: float) -> None:
    """The first block has ended: take over the noise that is remembered, if samples come as often as they did."""
    period_s, noise, known = seconds / s.block.samples, s.noise, s.recalled
    if abs(period_s - known.period_s) > SAME_PERIOD * known.period_s or known.period_s == 0.0:
        return
    noise.sample_var = known.sample_var
    noise.stationary_blocks = RECALLED_BLOCKS
    noise.angle_walk_var = known.angle_walk_var
    noise.is_walk_measured = True
    noise.flicker_var = known.flicker_var
    if known.resolution_dps > 0.0:
        noise.has_steps = True
        if noise.resolution_dps < 0.0 or known.resolution_dps < noise.resolution_dps:
            noise.resolution_dps = known.resolution_dps


def note_sure_rest(s: RestlevelState, seconds: float, is_certain: bool) -> bool:  # noqa: FBT001 - compiled code takes none by name
    """A block has ended: keep what is known of the bias in a sure rest; whether it is. `is_certain`: by a witness."""
    sure = s.sure
    if s.rest_probability < SURE_PROBABILITY:
        sure.seconds = 0.0
        return False
    if sure.seconds == 0.0:
        sure.begin_dps, sure.begin_c = s.bias_dps, s.temp_c
    was_s = sure.seconds
    sure.seconds += seconds
    long_s = SURE_BY_WITNESS_S if is_certain else SURE_S
    if sure.seconds < long_s:
        return False
    if was_s < long_s or sure.rests == 0:
        sure.rests += 1
    if sure.rests == 1 and not sure.has_first:
        sure.has_first, sure.first_dps, sure.first_c, sure.first_s = True, sure.begin_dps, sure.begin_c, s.lived_s
        sure.first_dps_sigma = s.bias_sigma_dps
    sure.bias_dps, sure.bias_var, sure.t_s, sure.temp_c = s.bias_dps, s.moments.bias_var, s.lived_s, s.temp_c
    sure.period_s = seconds / s.block.samples
    return True


def remembered_weight(s: RestlevelState) -> float:
    """Of all remembered biases together."""
    weight = 0.0
    for each in s.remembered:
        weight += each.weight
    return weight


def begin_remembered(c: RestlevelCoefficients, s: RestlevelState) -> int:
    """A hypothesis for each remembered bias, in the first places; how many there are."""
    count = 0
    for each in s.remembered:
        if each.weight > 0.0:
            h = s.hypotheses[count]
            h.weight, h.bias_dps, h.bias_var = each.weight, each.bias_dps, each.bias_var + c.rate_walk_var
            h.yaw_deg = s.yaw_deg
            h.knows_bias = True
            count += 1
    return count
