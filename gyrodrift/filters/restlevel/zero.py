"""Yaw sigma of restlevel: its restart at a zero, and the share of the scale factor.

At a zero yaw is known by definition. So each hypothesis gets the yaw of the zero, with no variance and no covariance
with its bias. A later bias estimate then corrects only the yaw turned since the zero.
"""

from dataclasses import replace
from math import sqrt

from gyrodrift.filters.restlevel.bias_state import Hypothesis
from gyrodrift.filters.restlevel.model import RestlevelCoefficients, RestlevelParams, RestlevelState
from gyrodrift.filters.restlevel.step import TURN_DEG


def zero_yaw(s: RestlevelState) -> None:
    """Restart the yaw sigma at the last sample; `s.yaw_deg` stays."""
    if s.samples == 0:
        return
    for h in s.hypotheses:
        if h.weight > 0.0:
            _zero_hypothesis(h, s)
    s.start_yaw_deg, s.travelled_deg, s.travelled_s, s.yaw_sigma_deg = s.yaw_deg, 0.0, 0.0, 0.0
    moments, gone_s = s.moments, s.block.seconds
    moments.covariance = moments.bias_var * gone_s
    moments.yaw_var = moments.covariance * gone_s


def _zero_hypothesis(h: Hypothesis, s: RestlevelState) -> None:
    """Set the yaw of a hypothesis to the output yaw within a block.

    A hypothesis of motion adds the whole block at its end. With t seconds of the block gone, it will add -t·bias too
    much. Its yaw, variance and covariance begin with the opposite. A hypothesis of rest adds nothing.
    """
    checkpoint, gone_s = h.checkpoint, s.block.seconds
    now_deg = s.moments.yaw_deg + s.block.angle_deg - s.bias_dps * gone_s
    checkpoint.yaw_deg, checkpoint.yaw_var, checkpoint.covariance = now_deg, 0.0, 0.0
    if h.is_at_rest:
        h.yaw_deg, h.yaw_var, h.covariance = now_deg, 0.0, 0.0
        return
    h.yaw_deg = s.moments.yaw_deg + (h.bias_dps - s.bias_dps) * gone_s
    h.covariance = h.bias_var * gone_s
    h.yaw_var = h.covariance * gone_s


def scale_sigma_deg(c: RestlevelCoefficients, s: RestlevelState) -> float:
    """Share of `s.yaw_sigma_deg` from scale and cross-axis errors since the zero, deg."""
    net_deg = s.yaw_deg - s.start_yaw_deg
    return c.scale_sigma * sqrt(net_deg * net_deg + TURN_DEG * s.travelled_deg)


def with_scale_sigma(params: RestlevelParams, sigma: float) -> RestlevelParams:
    """Parameters with the standard error of a calibrated scale, if it is below `scale_percent`."""
    return replace(params, scale_percent=min(params.scale_percent, 100.0 * sigma))
