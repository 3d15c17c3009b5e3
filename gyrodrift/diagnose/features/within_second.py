"""Features of fast motion: lag of the rate behind the encoder, and its second and third order."""

import numpy as np

from gyrodrift.diagnose.features.feature import RMS_DPS, Feature, ResponseLaw
from gyrodrift.diagnose.features.orthogonal import Basis, orthonormal
from gyrodrift.diagnose.recording.smoothing import central_difference, gaussian
from gyrodrift.values.arrays import Floats

SMOOTH_S = 0.02
"""Standard deviation of the Gaussian that smooths the rates of gyro and encoder, s. Chosen: derivatives of the rate are
mostly noise without it, and it is far below a second."""

CONSTANTS = 3
"""Leading columns of the basis that are no features. By definition: a bias, a gain, and a gain that differs by
direction."""


def _lag(name: str, says: str, threshold: float, source: str) -> Feature:
    return Feature(
        name, "sensor", "accelerating", says, threshold, source, reading=RMS_DPS, response=ResponseLaw.LINEAR,
    )  # fmt: skip


LAG_FEATURES = (
    _lag("lag", "the rate lags behind the encoder", 3e-4, "0.3 ms of delay"),
    _lag("lag_bend", "fast changes of the rate are weakened or strengthened", 8e-6, "(2.8 ms)²: second order of that"),
    _lag("lag_twist", "the lag depends on how fast the rate changes", 1e-7, "(4.6 ms)³: third order of that"),
)
"""The regressors are the first, second and third derivative of the encoder's rate; coefficients are in s, s², s³."""


def lag_basis(encoder_deg: Floats, period_s: float) -> Basis:
    """Basis of LAG_FEATURES, shape (n, features), from angles without gaps and jumps."""
    rate_dps = encoder_rate_dps(encoder_deg, period_s)
    columns = np.empty((CONSTANTS + len(LAG_FEATURES), len(rate_dps)))
    columns[0], columns[1], columns[2] = 1.0, rate_dps, np.abs(rate_dps)
    for index in range(CONSTANTS, len(columns)):
        columns[index] = np.gradient(columns[index - 1] if index > CONSTANTS else rate_dps, period_s)
    return orthonormal(columns.T, np.array([feature.threshold for feature in LAG_FEATURES]), CONSTANTS)


def lag_coefficients(rate_dps: Floats, encoder_deg: Floats, basis: Basis, period_s: float) -> Floats:
    """LAG_FEATURES of a rate and an encoder, shape (features,)."""
    away_dps = smoothed(rate_dps - central_difference(encoder_deg, period_s), period_s)
    coefficients: Floats = basis.vectors.T @ away_dps
    return coefficients


def encoder_rate_dps(encoder_deg: Floats, period_s: float) -> Floats:
    """Rate of the encoder, smoothed with the Gaussian of `smoothed`.

    A Gaussian derivative of the angle would be less accurate: the angle reaches thousands of degrees, and the truncated
    weights of the derivative do not sum to exactly zero.
    """
    return smoothed(central_difference(encoder_deg, period_s), period_s)


def smoothed(rate_dps: Floats, period_s: float) -> Floats:
    """A rate smoothed with a Gaussian of SMOOTH_S."""
    return gaussian(rate_dps, SMOOTH_S / period_s)
