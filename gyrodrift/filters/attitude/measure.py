"""Kalman updates of all hypotheses by three states that are measured directly."""

import numpy as np

from gyrodrift.filters.attitude.hypotheses import STATES, Hypotheses
from gyrodrift.values.arrays import Floats

MOST_SQUARED = 25.0
"""Largest squared distance that counts in a likelihood. Chosen: beyond five sigmas no model of the motion holds."""


def measure(h: Hypotheses, error: Floats, states: slice, values: Floats, variance: Floats) -> Floats:
    """Update `error` (n, 21) and the covariances by three states; log likelihoods (n) but for a constant.

    Parameters
    ----------
    h
        Hypotheses; only the covariances change.
    error
        Error states so far; changed in place.
    states
        The three states.
    values
        Measured errors (n, 3).
    variance
        Covariances of the measurement (3, 3) or (n, 3, 3).
    """
    cov = h.cov
    inverse, innovation = innovations(h, error, states, values, variance)
    gain = cov[:, :, states] @ inverse
    error += (gain @ innovation)[:, :, 0]
    cov = cov - gain @ cov[:, states, :]
    h.cov = 0.5 * (cov + cov.transpose(0, 2, 1))
    return log_likelihoods(inverse, innovation)


def measure_in_part(
    h: Hypotheses, error: Floats, states: slice, values: Floats, variance: Floats, shares: Floats
) -> Floats:
    """Update as `measure`, with gains multiplied by `shares` (n, 21, 21); covariances stay true (Joseph form)."""
    cov, eye = h.cov, np.eye(STATES)
    inverse, innovation = innovations(h, error, states, values, variance)
    gain = shares @ cov[:, :, states] @ inverse
    error += (gain @ innovation)[:, :, 0]
    kept = eye - gain @ eye[states]
    h.cov = kept @ cov @ kept.transpose(0, 2, 1) + gain @ variance @ gain.transpose(0, 2, 1)
    return log_likelihoods(inverse, innovation)


def log_likelihoods(inverse: Floats, innovation: Floats) -> Floats:
    """Log likelihoods (n) but for a constant, of inverse covariances (n, 3, 3) and innovations (n, 3, 1)."""
    if len(inverse) == 1:
        return np.zeros(1)
    squared = (innovation.transpose(0, 2, 1) @ inverse @ innovation)[:, 0, 0]
    log_det = np.log(np.asarray(np.linalg.det(inverse), dtype=np.float64))
    log_likelihood: Floats = 0.5 * (log_det - np.minimum(squared, MOST_SQUARED))
    return log_likelihood


def innovations(h: Hypotheses, error: Floats, states: slice, values: Floats, variance: Floats) -> tuple[Floats, Floats]:
    """Inverse covariances (n, 3, 3) of the innovations, and the innovations (n, 3, 1)."""
    spread = h.cov[:, states, states] + variance
    inverse = np.asarray(np.linalg.inv(spread), dtype=np.float64)
    return inverse, (values - error[:, states])[:, :, None]
