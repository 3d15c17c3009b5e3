"""The rate of a segment about the vertical, by the rules of one axis: its gate, its slope, and its slide.

In a level turn gravity stands still, as in a rest, so three axes know no more than one. A rate that leaves the level of
a rest slowly is a turn that begins. The bias is then the one before it began to slide.
"""

import numpy as np

from gyrodrift.filters.attitude.block import RAD
from gyrodrift.filters.attitude.evidence import SAME_RATE
from gyrodrift.filters.attitude.hypotheses import BIAS, HEADING, REST, STATES, Hypotheses
from gyrodrift.filters.attitude.model import BLOCKS_PER_WINDOW, AttitudeCoefficients, AttitudeState
from gyrodrift.filters.attitude.rests import GYRO_SPREAD, LONGEST, QUIET, RestCandidate, Windows
from gyrodrift.filters.restlevel.durations import GRADUAL_REST, GRADUAL_SPIN
from gyrodrift.filters.restlevel.segments import (
    GATE_SIGMAS,
    GRADUAL_DPS_S,
    LONG_GATE_SIGMAS,
    LONG_SEGMENT_S,
    SLOPE_SIGMAS,
)
from gyrodrift.filters.restlevel.slide import follow_slide, mark_safe
from gyrodrift.values.arrays import Floats

NEWEST = int(BLOCKS_PER_WINDOW)
"""Newest blocks that are compared with a segment. Derived: a block of one axis."""


def leaves_level(c: AttitudeCoefficients, s: AttitudeState, m: RestCandidate) -> bool:
    """Whether the newest blocks of a quiet window leave the level of the present segment."""
    segment = s.segment
    before = segment.level_blocks - NEWEST
    if m.kind is not QUIET or before <= 0:
        return False
    off = mean_vertical(s.windows, 0, NEWEST, segment.up) - segment.level
    variance = level_var(c, s, 1.0 / NEWEST + 1.0 / before, 0.5 * segment.level_blocks)
    return off * off > GATE_SIGMAS * GATE_SIGMAS * variance


def resumes_level(c: AttitudeCoefficients, s: AttitudeState, m: RestCandidate) -> bool:
    """Whether a quiet window has the level of the segment that ended before it."""
    segment = s.segment
    if m.kind is not QUIET:
        return True
    sigmas = LONG_GATE_SIGMAS if segment.seconds >= LONG_SEGMENT_S else GATE_SIGMAS
    off = float(m.gyro @ segment.up) - segment.level
    variance = level_var(c, s, 1.0 / QUIET.blocks + 1.0 / LONGEST, segment.ago + QUIET.blocks)
    return off * off < sigmas * sigmas * variance


def slopes(c: AttitudeCoefficients, s: AttitudeState, m: RestCandidate) -> bool:
    """Whether the halves of a quiet window after a gradual end differ, so that its rate is no level."""
    up, half = m.up, QUIET.blocks // 2
    if not s.segment.ended_gradually or m.kind is not QUIET or not up.any():
        return False
    slope = mean_vertical(s.windows, 0, half, up) - mean_vertical(s.windows, half, half, up)
    return slope * slope > SLOPE_SIGMAS * SLOPE_SIGMAS * 2.0 / half * s.noise_var / c.block_s


def mean_vertical(w: Windows, ago: int, blocks: int, up: Floats) -> float:
    """Mean rate about a direction, rad/s, over some blocks that end `ago` blocks before the newest one."""
    end = (w.total - 1) % LONGEST + LONGEST + 1 - ago
    return GYRO_SPREAD * float(w.rows[end - blocks : end, :3].sum(axis=0) @ up) / blocks


def level_var(c: AttitudeCoefficients, s: AttitudeState, shares: float, apart: float) -> float:
    """Variance of the difference of two mean rates, (rad/s)².

    `shares` is the sum of the inverse numbers of their blocks, and the bias drifts for `apart` blocks between them.
    """
    drift, flicker = c.drift_rate * apart * c.block_s, SAME_RATE * RAD
    return s.noise_var / c.block_s * shares + drift * drift + flicker * flicker


def follow_level(s: AttitudeState) -> None:
    """Update the level of a segment that goes on with the newest block."""
    segment = s.segment
    segment.level_blocks = min(segment.level_blocks + 1, LONGEST)
    segment.level = mean_vertical(s.windows, NEWEST, segment.level_blocks - NEWEST, segment.up)


def begin_level(s: AttitudeState, m: RestCandidate) -> None:
    """Begin the level and the slide of a segment."""
    segment, segment.up = s.segment, m.up
    segment.level, segment.level_blocks = float(m.gyro @ segment.up), m.kind.blocks
    segment.undone, segment.ended_gradually = 0.0, False
    begin_slide(s)


def begin_slide(s: AttitudeState) -> None:
    """Begin the slide of the bias."""
    take_bias(s)
    mark_safe(s.segment.rest)


def take_bias(s: AttitudeState) -> bool:
    """Take the bias of the most probable rest about the vertical; False without a rest."""
    h, segment = s.hypotheses, s.segment
    rests = np.flatnonzero(h.regime == REST)[:1]
    for i in rests:
        segment.rest.bias_dps = float(h.bias[i] @ segment.up) / RAD
        segment.rest.bias_var = float(segment.up @ h.cov[i, BIAS, BIAS] @ segment.up) / RAD**2
    return len(rests) > 0


def follow_bias(c: AttitudeCoefficients, s: AttitudeState, seconds: float) -> None:
    """Update the slide of the bias after an update of a rest, `seconds` after the one before."""
    if take_bias(s):
        follow_slide(c.drift_rate / RAD, s.segment.rest, seconds)


def end_level(c: AttitudeCoefficients, s: AttitudeState) -> None:
    """End a segment whose level the newest blocks have left; after a gradual end the bias is the safe one.

    The next window has blocks of the new level alone.
    """
    segment, w = s.segment, s.windows
    step = mean_vertical(w, 0, NEWEST, segment.up) - mean_vertical(w, NEWEST, NEWEST, segment.up)
    is_gradual = abs(step) < GRADUAL_DPS_S * RAD * NEWEST * c.block_s
    w.blocks = NEWEST if is_gradual else 1
    if is_gradual and take_bias(s):
        segment.ended_gradually = True
        segment.undone = (segment.rest.safe.bias_dps - segment.rest.bias_dps) * RAD
        turn_back(s, segment.undone, GRADUAL_REST / GRADUAL_SPIN)


def resume_level(s: AttitudeState, m: RestCandidate) -> None:
    """Resume a segment with its bias before a gradual end."""
    segment = s.segment
    if segment.ended_gradually:
        turn_back(s, -segment.undone, GRADUAL_SPIN / GRADUAL_REST)
    segment.undone, segment.ended_gradually, segment.level_blocks = 0.0, False, m.kind.blocks


def turn_back(s: AttitudeState, change: float, odds: float) -> None:
    """Change the biases of rests about the vertical, rad/s, with their headings since the rest, and their odds."""
    h: Hypotheses = s.hypotheses
    is_rest = h.regime == REST
    error = np.zeros((len(h.weight), STATES))
    error[is_rest, BIAS] = change * s.segment.up
    error[is_rest, HEADING] = -change * h.moving_s[is_rest]
    h.correct(error)
    h.weight = h.weight * np.where(is_rest, odds, 1.0)
    h.weight = h.weight / h.weight.sum()
