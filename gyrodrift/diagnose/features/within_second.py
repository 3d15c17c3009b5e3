"""What the rate does within a second, beside the encoder: lags, and what is weakened or twisted in quick motion."""

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.feature import RMS_DPS, Feature, ResponseLaw
from gyrodrift.diagnose.features.orthogonal import Basis, orthonormal
from gyrodrift.diagnose.recording.smoothing import central_difference, gaussian

SMOOTH_S = 0.02
"""Standard deviation of the Gaussian that rate and encoder both go through."""

CONSTANTS = 3
"""Columns of the basis that are no features: a bias, a gain, a gain of either direction."""


def _lag(name: str, says: str, threshold: float, source: str) -> Feature:
    return Feature(
        name, "sensor", "accelerating", says, threshold, source, reading=RMS_DPS, response=ResponseLaw.LINEAR,
    )  # fmt: skip


LAG_FEATURES = (
    _lag("lag", "the rate lags behind the encoder", 3e-4, "0.3 ms of delay"),
    _lag("lag_bend", "fast changes of the rate are weakened or strengthened", 8e-6, "(2.8 ms)²: second order of that"),
    _lag("lag_twist", "the lag depends on how fast the rate changes", 1e-7, "(4.6 ms)³: third order of that"),
)
"""Regressors are the first, second and third derivative of the encoder's rate; coefficients are in s, s², s³."""


def lag_basis(encoder_deg: Floats, period_s: float) -> Basis:
    """The basis of LAG_FEATURES of an encoder without holes and jumps, vectors of shape (n, features)."""
    rate_dps = encoder_rate_dps(encoder_deg, period_s)
    columns = np.empty((CONSTANTS + len(LAG_FEATURES), len(rate_dps)))
    columns[0], columns[1], columns[2] = 1.0, rate_dps, np.abs(rate_dps)
    for number in range(CONSTANTS, len(columns)):
        columns[number] = np.gradient(columns[number - 1] if number > CONSTANTS else rate_dps, period_s)
    return orthonormal(columns.T, np.array([feature.threshold for feature in LAG_FEATURES]), CONSTANTS)


def lag_coefficients(rate_dps: Floats, encoder_deg: Floats, basis: Basis, period_s: float) -> Floats:
    """LAG_FEATURES of a rate beside an encoder, shape (features,)."""
    away_dps = smoothed(rate_dps - central_difference(encoder_deg, period_s), period_s)
    coefficients: Floats = basis.vectors.T @ away_dps
    return coefficients


def encoder_rate_dps(encoder_deg: Floats, period_s: float) -> Floats:
    """Rate of the encoder through the same Gaussian as `smoothed` puts a rate through.

    Gaussian derivatives of the angle itself would leak: it is thousands of degrees, and their weights end somewhere.
    """
    return smoothed(central_difference(encoder_deg, period_s), period_s)


def smoothed(rate_dps: Floats, period_s: float) -> Floats:
    """A rate through a Gaussian of SMOOTH_S."""
    return gaussian(rate_dps, SMOOTH_S / period_s)
