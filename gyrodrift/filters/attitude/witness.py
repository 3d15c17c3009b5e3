"""A rest sensor beside gyro and accelerometer: wheels, a charger, a disarmed state."""

import numpy as np

from gyrodrift.filters.attitude.block import RAD
from gyrodrift.filters.attitude.evidence import JUMP
from gyrodrift.filters.attitude.hypotheses import BIAS, REST
from gyrodrift.filters.attitude.model import AttitudeCoefficients, AttitudeState
from gyrodrift.filters.attitude.rests import RestCandidate, RestKind, last_window
from gyrodrift.filters.contradictions import FIT_SIGMAS, MOST_FIRST, count_contradiction, count_fit

STILL = RestKind(3, 100.0, 100.0, 2.0)
"""Window of a rest by a witness: as short as three blocks, with up to 15 deg/s of scatter. Chosen."""


def certain_rest(c: AttitudeCoefficients, s: AttitudeState) -> RestCandidate | None:
    """Candidate of a witness that is believed; None without one."""
    w, block = s.witness, s.block
    if block.still == 0 or block.moving > 0 or block.still < block.samples:
        w.blocks, w.is_believed = 0, True
        return None
    w.blocks += 1
    if not w.is_believed or w.blocks < STILL.blocks:
        return None
    candidate = last_window(s.windows, STILL, c.limits)
    if candidate is not None and fits_bias(c, s, candidate):
        count_fit(w)
        return candidate
    count_contradiction(w)
    return None


def fits_bias(c: AttitudeCoefficients, s: AttitudeState, candidate: RestCandidate) -> bool:
    """Whether the rates may be the bias of any hypothesis, or a first bias."""
    h = s.hypotheses
    jump_var = (JUMP * c.bias_sigma) ** 2 + (0.1 * RAD) ** 2
    spread = np.sqrt(np.diagonal(h.cov[:, BIAS, BIAS], axis1=1, axis2=2) + jump_var + candidate.gyro_var)
    is_near = (np.abs(candidate.gyro - h.bias) < FIT_SIGMAS * spread).all(axis=1)
    may_be_first = ~h.knows_bias & bool((np.abs(candidate.gyro) < MOST_FIRST * c.bias_sigma).all())
    return bool((is_near | may_be_first).any())


def keep_rests(s: AttitudeState) -> None:
    """Remove all hypotheses but those of rest."""
    h = s.hypotheses
    if (h.regime == REST).any():
        h = h.select(h.regime == REST)
        h.weight = h.weight / h.weight.sum()
        s.hypotheses = h
