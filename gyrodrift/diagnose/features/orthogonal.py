"""Orthonormal bases: regressors that share something are told apart by their order."""

from typing import NamedTuple

import numpy as np

from gyrodrift.arrays import Floats, Mask

NEW_SHARE = 1e-3
"""A column that is made of those before it but for less than this share says nothing new."""

TINY = 1e-300
"""Keeps the norm of a column of zeros from dividing by zero."""


class Basis(NamedTuple):
    """Orthonormal vectors, (rows, columns), zero where a column says nothing new; and thresholds, (columns,).

    A threshold is what coefficients as large as the relevance thresholds of the columns make on a vector.
    """

    vectors: Floats
    thresholds: Floats


def orthonormal(columns: Floats, thresholds: Floats, dropped: int) -> Basis:
    """Of columns in their order: what two share counts for the first. The first ones are taken out, then dropped."""
    norms = _norms(columns)
    vectors, triangle = np.linalg.qr(columns / norms)
    amounts = triangle[dropped:, dropped:] * (norms[dropped:] * thresholds)
    vectors = vectors[:, dropped:] * np.sign(np.diag(triangle)[dropped:]) * _is_new(triangle)[dropped:]
    return Basis(vectors, np.linalg.norm(amounts, axis=1))


def orthonormal_vectors(columns: Floats) -> Floats:
    """Vectors that span the columns, orthonormal, of either sign, zero where a column says nothing new."""
    vectors, triangle = np.linalg.qr(columns / _norms(columns))
    kept: Floats = vectors * _is_new(triangle)
    return kept


def _norms(columns: Floats) -> Floats:
    norms: Floats = np.maximum(np.linalg.norm(columns, axis=0), TINY)
    return norms


def _is_new(triangle: Floats) -> Mask:
    new: Mask = np.abs(np.diag(triangle)) > NEW_SHARE
    return new
