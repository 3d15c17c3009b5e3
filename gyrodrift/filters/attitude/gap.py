"""A gap in the samples of the attitude filter: attitude is held, and no window or segment goes on after it."""

from math import radians

import numpy as np

from gyrodrift.filters.attitude.block import RAD, integrals, next_block
from gyrodrift.filters.attitude.hypotheses import BIAS, HEADING, UNDECIDED
from gyrodrift.filters.attitude.mixture import merge_and_prune
from gyrodrift.filters.attitude.model import AttitudeCoefficients, AttitudeState
from gyrodrift.filters.attitude.rests import Segment
from gyrodrift.filters.attitude.update import end_block, publish
from gyrodrift.filters.attitude.velocity import forget_velocity
from gyrodrift.filters.beliefs import drift_var
from gyrodrift.filters.gaps import count_gap, gap_length_s, turn_var
from gyrodrift.values.quaternion import heading_axis
from gyrodrift.values.vectors import Vector


def pass_gap(c: AttitudeCoefficients, s: AttitudeState, step_s: float, gyro: Vector) -> None:
    """Go over a gap to a sample that comes `step_s` later with these rates, deg/s. The sample then begins a block."""
    if s.block.samples > 0:
        end_block(c, s, integrals(s.block))
    h, seconds = s.hypotheses, gap_length_s(s.watch, step_s)
    level_var, heading_var = turn_variances(s, seconds, gyro)
    h.cov[:, :HEADING, :HEADING] += level_var * np.eye(HEADING)
    h.cov[:, HEADING, HEADING] += heading_var
    h.cov[:, BIAS, BIAS] += drift_var(seconds, c.walk_var, c.drift_rate, c.bias_sigma**2) * np.eye(3)
    h.regime[:] = UNDECIDED
    forget_velocity(h)
    s.lived_s += step_s
    s.windows.blocks, s.segment = 0, Segment()
    s.gyro_dps, s.suspect_s = gyro, 0.0
    if count_gap(s.watch, step_s) and c.bias_sigma > 0.0:
        reopen(c, s)
    publish(s)
    s.block = next_block(s.hypotheses.bias[0], s.hypotheses.scale[0])


def turn_variances(s: AttitudeState, seconds: float, gyro: Vector) -> tuple[float, float]:
    """Variances of the unknown turn in a gap, rad²: about each level axis, and about the vertical."""
    pairs = zip(gyro, s.gyro_dps, s.bias_xyz_dps, strict=True)
    rx, ry, rz = (after + before - 2.0 * bias for after, before, bias in pairs)
    ax, ay, az = heading_axis(s.q)
    heading_dps = ax * rx + ay * ry + az * rz
    level_dps = max(0.0, rx * rx + ry * ry + rz * rz - heading_dps * heading_dps) ** 0.5
    return RAD * RAD * turn_var(seconds, level_dps), RAD * RAD * turn_var(seconds, heading_dps)


def reopen(c: AttitudeCoefficients, s: AttitudeState) -> None:
    """Give the bias its turn-on prior around the last estimate. The next window may be a rest from the start."""
    h = s.hypotheses
    x, y, z = s.bias_xyz_dps
    s.turn_on_bias = np.array((radians(x), radians(y), radians(z)))
    h.bias[:] = s.turn_on_bias
    h.cov[:, BIAS, :] = 0.0
    h.cov[:, :, BIAS] = 0.0
    h.cov[:, BIAS, BIAS] = c.bias_sigma**2 * np.eye(3)
    h.knows_bias[:] = False
    s.windows.total, s.remembers = 0, False
    s.hypotheses = merge_and_prune(h)
