"""Orthonormal bases: regressors that share something are told apart by their order."""

from typing import NamedTuple

import numpy as np

from gyrodrift.arrays import Floats, Mask

NEW_SHARE = 0.03
"""A column that is made of those before it but for less than this share says nothing new."""

ROWS_EACH = 2
"""So many rows a column takes; a short recording says nothing of the last ones."""

TALL = 1500
"""Rows from which on it saves time to go by the products of the columns."""

APART = 1e-2
"""Columns of which each has so much new are told apart by their products to twelve digits."""

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
    vectors, triangle = _factors(columns, norms, dropped)
    amounts = triangle[dropped:, dropped:] * (norms[dropped:] * thresholds)
    vectors *= (np.sign(np.diag(triangle)) * _is_new(triangle))[dropped:]
    return Basis(vectors, np.linalg.norm(amounts, axis=1))


def orthonormal_vectors(columns: Floats) -> Floats:
    """Vectors that span the columns, orthonormal, of either sign, zero where a column says nothing new."""
    vectors, triangle = _factors(columns, _norms(columns), 0)
    kept: Floats = vectors * _is_new(triangle)
    return kept


def _factors(columns: Floats, norms: Floats, dropped: int) -> tuple[Floats, Floats]:
    """Orthonormal vectors but for the first, and the triangle that makes columns of unit length of all of them."""
    if len(columns) >= TALL:
        products = columns.T @ columns / norms / norms[:, None]
        if np.linalg.eigvalsh(products)[0] > APART**2:
            lower = np.asarray(np.linalg.cholesky(products), dtype=np.float64)
            vectors: Floats = (np.linalg.inv(lower)[dropped:] / norms @ columns.T).T
            return vectors, lower.T
    rows, count = columns.shape
    told = min(count, rows, max(1, rows // ROWS_EACH))
    whole, triangle = np.linalg.qr((columns / norms)[:, :told])
    more = count - told
    whole, triangle = np.pad(whole, ((0, 0), (0, more))), np.pad(triangle, ((0, more), (0, more)))
    return whole[:, dropped:], triangle


def _norms(columns: Floats) -> Floats:
    norms: Floats = np.maximum(np.sqrt(np.einsum("ij,ij->j", columns, columns)), TINY)
    return norms


def _is_new(triangle: Floats) -> Mask:
    new: Mask = np.abs(np.diag(triangle)) > NEW_SHARE
    return new
