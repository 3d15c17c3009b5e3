"""Densities of the mean rates of a rest candidate under a rest, and under an even turn or a motion."""

from typing import NamedTuple

import numpy as np

from gyrodrift.filters.attitude.block import RAD
from gyrodrift.filters.attitude.hypotheses import BIAS, Hypotheses
from gyrodrift.filters.attitude.model import AttitudeCoefficients
from gyrodrift.filters.attitude.rests import QUIET, RestCandidate
from gyrodrift.filters.beliefs import MAX_RAMP_S, PARTS, SPINS_PER_DPS
from gyrodrift.values.arrays import Floats, Mask

MOTION_SPREAD = 1.0
MOTION_SHARE, NOISY_MOTION_SHARE = 0.05, 0.5
"""Motions that keep their means by chance: spread of their rates in each axis, deg/s, and their number per even turn,
in quiet and in noisy windows. Chosen: hands and boats turn so while they look still."""

JUMP_SHARE, JUMP = 0.03, 0.4
"""Share of rests before which the bias jumped, and the size of jumps over the spread of the bias. Chosen: about as rare
as raw parts (`PARTS`)."""

ONE_KIND = 0.8
"""Share of parts whose three axes are of one kind. Chosen: data sheets state one limit for all axes."""

ALIGNMENT = 0.03
"""Share of a rate that the level axes see. Derived: errors of the tilt by 0.3 m/s² of bias of the accelerometer,
0.3/9.81."""

MISTAKE_SHARE = 0.005
"""Share of rests before which the bias was learned in an even turn, so that it has its prior again. Such a rest is
nearer to 0 than the bias believed. Chosen: rarer than jumps."""

MODEL_ERROR = 0.1
"""Error of the bias that its covariance does not contain, deg/s, where a rest is tested.
Measured: recordings of five rigs, median heading error."""


SAME_RATE = 0.005
"""Error of a bias that its covariance does not contain, deg/s, where a rest is tested once a bias is known.
Chosen: flicker of common parts within seconds."""


def must_agree(h: Hypotheses, m: RestCandidate) -> Mask:
    """Hypotheses (n) with a sure bias, if a candidate is a noisy rest: it has to agree with their bias.

    A straight drive or a gentle bend looks the same as a rest with a running engine.
    """
    spread = np.trace(h.cov[:, BIAS, BIAS], axis1=1, axis2=2)
    is_sure: Mask = h.knows_bias & (spread < 3.0 * (MODEL_ERROR * RAD) ** 2)
    return is_sure & (m.kind.blocks > QUIET.blocks)


class RestEvidence(NamedTuple):
    """Logarithms of the densities of the mean rates, 1/(deg/s)³: rest, and no rest for each unit of odds."""

    rest: float
    motion: float


def level_basis(up: Floats) -> Floats:
    """Matrix (3, 3) whose rows are two level axes and the vertical, in the sensor frame."""
    first = np.zeros(3)
    first[np.abs(up).argmin()] = 1.0
    first -= (first @ up) * up
    first /= np.sqrt(first @ first)
    return np.array((first, np.cross(up, first), up))


def weigh(
    c: AttitudeCoefficients,
    h: Hypotheses,
    i: int,
    m: RestCandidate,
    up: Floats,
    variance: Floats,
    turn_on_bias: Floats,
) -> RestEvidence:
    """Densities of a candidate's rates for hypothesis i.

    up is the vertical (3) in the sensor, and variance (3, 3) that of the mean rates as a measurement, (rad/s)².
    turn_on_bias (3) is the mean of the prior of an unknown bias, rad/s.
    """
    basis = level_basis(up)
    rate, off = basis @ m.gyro / RAD, basis @ (m.gyro - h.bias[i]) / RAD
    spread = basis @ (h.cov[i, BIAS, BIAS] + variance) @ basis.T / RAD**2
    model_var = SAME_RATE**2 if h.knows_bias[i] else MODEL_ERROR**2
    wide = spread + (model_var + ALIGNMENT**2 * float(rate @ rate)) * np.eye(3)
    level = normal_density(off[:2], wide[:2, :2])
    if h.knows_bias[i]:
        jump = (JUMP * c.bias_sigma / RAD) ** 2 * np.eye(3)
        jumps = JUMP_SHARE * min(1.0, float(h.moving_s[i]) / MAX_RAMP_S)
        rest = normal_density(off, wide)
        if not must_agree(h, m)[i]:
            rest = (1.0 - jumps) * rest + jumps * normal_density(off, wide + jump)
        prior = spread + (c.bias_sigma / RAD) ** 2 * np.eye(3)
        if float(rate @ rate) < float(h.bias[i] @ h.bias[i]) / RAD**2:
            rest += MISTAKE_SHARE * normal_density(rate, prior)
    else:
        turn_on = rate - basis @ turn_on_bias / RAD
        level, rest = first_rest_densities(c, turn_on, float(off[2]), float(spread[2, 2]))
    share = MOTION_SHARE if m.kind.blocks <= QUIET.blocks else NOISY_MOTION_SHARE
    chance = normal_density(off, wide + MOTION_SPREAD**2 * np.eye(3))
    chance += level * normal_density(off[2:], wide[2:, 2:] + MOTION_SPREAD**2)
    return RestEvidence(float(np.log(rest + 1e-300)), float(np.log(SPINS_PER_DPS * level + share * chance + 1e-300)))


def first_rest_densities(c: AttitudeCoefficients, rate: Floats, off: float, variance: float) -> tuple[float, float]:
    """Densities before any rest has shown the bias: of the level rates, 1/(deg/s)², and of all of a rest, 1/(deg/s)³.

    The level rates, as distances from the mean of the prior, are biases in every case, and show the kind of the part.
    """
    prior_var = (c.bias_sigma / RAD) ** 2
    level = rest = vertical = 0.0
    for share, wider in PARTS:
        density = share * normal_density(rate[:2], (wider * wider * prior_var + MODEL_ERROR**2) * np.eye(2))
        along = normal_density(np.array((off,)), np.array(((variance * wider * wider + MODEL_ERROR**2,),)))
        level += density
        rest += density * along
        vertical += share * along
    return level, ONE_KIND * rest + (1.0 - ONE_KIND) * level * vertical


def normal_density(off: Floats, spread: Floats) -> float:
    """Density of the normal distribution with this covariance (k, k) at a distance (k) from its mean."""
    squared = float(off @ np.linalg.solve(spread, off))
    return float(np.exp(-0.5 * squared) / np.sqrt(np.linalg.det(2.0 * np.pi * spread)))
