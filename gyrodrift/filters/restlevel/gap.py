"""A gap in the samples of restlevel: yaw is held, and nothing of the present block or segment goes on after it."""

from gyrodrift.filters.beliefs import drift_var
from gyrodrift.filters.gaps import count_gap, gap_length_s, turn_var
from gyrodrift.filters.restlevel.hypotheses import forget_segments, predict, reopen
from gyrodrift.filters.restlevel.mixture import collapse
from gyrodrift.filters.restlevel.model import RestlevelCoefficients, RestlevelState


def pass_gap(c: RestlevelCoefficients, s: RestlevelState, step_s: float, rate_dps: float) -> None:
    """Go over a gap to a sample that comes `step_s` later with this rate, deg/s. The sample then begins a block."""
    block = s.block
    seconds = gap_length_s(s.watch, step_s)
    gap_var = turn_var(seconds, s.rate_dps + rate_dps - 2.0 * s.bias_dps)
    bias_var = drift_var(seconds, c.rate_walk_var, c.rate_ramp_dps_s, c.turn_on_var)
    predict(c, s, block.angle_deg, block.seconds)
    for h in s.hypotheses:
        h.is_at_rest = h.was_at_rest = False
        h.yaw_var += gap_var
        h.bias_var += bias_var
    s.lived_s += block.seconds + step_s
    forget_segments(s)
    s.witness.was_certain, s.witness.still, s.witness.moving = False, 0, 0
    block.seconds = block.angle_deg = block.sum_dps = block.sum_squares = 0.0
    block.samples = block.repeats = 0
    collapse(c, s)
    if count_gap(s.watch, step_s) and c.turn_on_var > 0.0:
        reopen(c, s)
    s.rate_dps = rate_dps
