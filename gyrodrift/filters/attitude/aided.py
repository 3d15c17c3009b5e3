"""Measurements of heading and of the bias about the vertical by a second source, for all hypotheses.

As in restlevel: a measurement is right or wrong, and each hypothesis is the mixture of both cases.
"""

import numpy as np

from gyrodrift.filters.aids.reading import WRONG_SHARE, AidedFilter, AidMoments, AidReading
from gyrodrift.filters.attitude.block import RAD, next_block
from gyrodrift.filters.attitude.hypotheses import BIAS, HEADING
from gyrodrift.filters.attitude.mixture import ordered
from gyrodrift.filters.attitude.model import AttitudeCoefficients, AttitudeState
from gyrodrift.filters.attitude.update import publish
from gyrodrift.filters.attitude.yaw import unwrap_headings
from gyrodrift.filters.gaps import add_correction
from gyrodrift.values.quaternion import heading_axis

LEAST_VAR = 1e-12
"""Smallest variance of a state that a measurement may lower, deg² and alike. Chosen: far below that of any sensor."""


def has_block_ended(s: AttitudeState) -> bool:
    """Whether the last sample ended a block."""
    return s.block.samples == 0


def rate_dps(s: AttitudeState) -> float:
    """Rate of the heading as measured, deg/s."""
    return s.heading_rate_dps


def moments(s: AttitudeState) -> AidMoments:
    """Moments of the Gaussian sum about the vertical."""
    h, axis = s.hypotheses, np.array(heading_axis(s.q))
    covariance = float(h.weight @ (h.cov[:, HEADING, BIAS] @ axis)) / RAD**2
    return AidMoments(s.bias_dps, s.yaw_deg, s.bias_sigma_dps**2, covariance, s.yaw_sigma_deg**2)


def take(_c: AttitudeCoefficients, s: AttitudeState, reading: AidReading) -> float:
    """Update all hypotheses, and give the probability that the measurement is right."""
    h, axis = s.hypotheses, np.array(heading_axis(s.q))
    expected = h.yaw_deg if reading.is_heading else np.degrees(h.bias @ axis)
    innovation = np.array([reading.difference(value) for value in expected.tolist()])
    carried = (h.cov[:, :, HEADING] if reading.is_heading else h.cov[:, :, BIAS] @ axis) / RAD**2
    if reading.is_heading:
        carried[:, HEADING] = np.maximum(carried[:, HEADING] - reading.shared_var, 0.0)
        carried[:, BIAS] -= reading.shared_covariance * axis
        most = np.sqrt(np.diagonal(h.cov, axis1=1, axis2=2) / RAD**2 * carried[:, HEADING : HEADING + 1])
        carried = np.clip(carried, -most, most)
    known_var = np.maximum(carried[:, HEADING] if reading.is_heading else carried[:, BIAS] @ axis, LEAST_VAR)
    variance = known_var + reading.own_var + reading.variance
    density = np.exp(-0.5 * innovation**2 / variance) / np.sqrt(2.0 * np.pi * variance)
    likelihood = (1.0 - WRONG_SHARE) * density + WRONG_SHARE / reading.range
    right = (1.0 - WRONG_SHARE) * density / likelihood
    taken = np.minimum(1.0, np.maximum(0.0, 1.0 - reading.own_var / known_var) * variance / known_var)
    spread = right * (taken * variance - (1.0 - right) * innovation**2)
    gain = carried / variance[:, None]
    h.correct(np.radians(right * innovation)[:, None] * gain)
    h.cov = h.cov - RAD**2 * spread[:, None, None] * gain[:, :, None] * gain[:, None, :]
    h.weight = h.weight * likelihood
    agreement = float(h.weight @ right / h.weight.sum())
    h.weight = h.weight / h.weight.sum()
    s.hypotheses = ordered(h)
    unwrap_headings(s.hypotheses)
    before_deg = s.yaw_deg
    publish(s)
    s.block = next_block(s.hypotheses.bias[0], s.hypotheses.scale[0])
    add_correction(s, s.yaw_deg - before_deg)
    return agreement


AIDED = AidedFilter(has_block_ended, rate_dps, moments, take)
"""How the attitude filter takes measurements."""
