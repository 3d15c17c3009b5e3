"""Generalised least squares with a local level: a regression under white noise and a bias that may walk.

The steady Kalman filter of the local level model is a whitening filter of one pole (A. C. Harvey, Forecasting,
Structural Time Series Models and the Kalman Filter, 1989, chapter 4), which makes generalised least squares ordinary.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.signal import lfilter

from gyrodrift.arrays import Floats

GAINS = (0.0, 0.003, 0.01, 0.03, 0.1, 0.3)
"""Gains of the filter, from a constant bias, 0, to a fast random walk."""

MAD_TO_SIGMA = 1.4826
"""The standard deviation of normal numbers over their median absolute deviation."""

LEAST_DPS = 1e-6
"""Added to a spread, so that it is never 0."""

LEAST_VARIANCE = 1e-12
COLLINEAR = 1e-9
"""Singular values of regressors below this share of the largest are no information."""


class Whitened(NamedTuple):
    """Columns, (blocks, some), and values, (blocks,), of a session, in standard deviations of white noise."""

    columns: Floats
    values: Floats


class Fit(NamedTuple):
    """Gain in log likelihood, coefficient (of two columns their amplitude), and its standard error."""

    log_likelihood_gain: float
    coefficient: float
    error: float


def whitened(effects: Sequence[Floats], values: Floats) -> list[Whitened]:
    """Columns of each effect, (blocks, 1 or 2), and values, through the filter that leaves the whitest residual."""
    every = np.column_stack(effects)
    gain = min(GAINS, key=lambda gain: _spread_left(innovations(gain, every), innovations(gain, values[:, None])[:, 0]))
    white = innovations(gain, values[:, None])[:, 0]
    sigma = MAD_TO_SIGMA * float(np.median(np.abs(white - np.median(white)))) + LEAST_DPS
    return [Whitened(innovations(gain, columns) / sigma, white / sigma) for columns in effects]


def innovations(gain: float, columns: Floats) -> Floats:
    """Innovations of the local level model with this steady gain; a constant bias is subtracted as a mean."""
    if gain == 0.0:
        away: Floats = columns - columns.mean(axis=0)
        return away
    filtered: Floats = lfilter([1.0, -1.0], [1.0, gain - 1.0], columns - columns[0], axis=0)
    return filtered


def fit(sessions: Sequence[Whitened]) -> Fit:
    """Fit one coefficient, or a sine and a cosine, to all sessions; zeros if the columns hold no information."""
    columns = np.concatenate([session.columns for session in sessions])
    values = np.concatenate([session.values for session in sessions])
    information = columns.T @ columns
    if not np.all(np.isfinite(information)) or np.linalg.matrix_rank(information) < len(information):
        return Fit(0.0, 0.0, 0.0)
    coefficients = np.linalg.solve(information, columns.T @ values)
    before = float(values @ values)
    after = float(np.square(values - columns @ coefficients).sum())
    variance = max(after / len(values), LEAST_VARIANCE)
    error = float(np.sqrt(variance * np.linalg.inv(information)[0, 0]))
    amplitude = float(coefficients[0]) if len(coefficients) == 1 else float(np.hypot(*coefficients))
    return Fit(0.5 * len(values) * float(np.log(before / max(after, LEAST_VARIANCE))), amplitude, error)


def _spread_left(columns: Floats, values: Floats) -> float:
    """Mean absolute residual of a regression on the columns."""
    scale = np.linalg.norm(columns, axis=0) + LEAST_VARIANCE
    unexplained = values - (columns / scale) @ np.linalg.lstsq(columns / scale, values, rcond=COLLINEAR)[0]
    return float(np.mean(np.abs(unexplained)))
