"""Orthonormal bases: regressors that share something are told apart by their order."""

from typing import NamedTuple

import numpy as np

from gyrodrift.arrays import Floats

NEW_SHARE = 0.03
"""A column that is made of those before it but for less than this share says nothing new."""

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
    vectors = orthonormal_vectors(columns)[:, dropped:]
    amounts = vectors.T @ (columns[:, dropped:] * thresholds)
    return Basis(vectors, np.linalg.norm(amounts, axis=1))


def orthonormal_vectors(columns: Floats) -> Floats:
    """Vectors that span the columns, orthonormal, zero where a column says nothing new."""
    norms = np.maximum(np.sqrt(np.einsum("ij,ij->j", columns, columns)), TINY)
    if len(columns) >= 1500:  # faster by the products of the columns from 1500 rows on
        products = columns.T @ columns / norms / norms[:, None]
        if np.linalg.eigvalsh(products)[0] > APART**2:
            lower = np.asarray(np.linalg.cholesky(products), dtype=np.float64)
            if np.diag(lower).min() > NEW_SHARE:
                vectors: Floats = (np.linalg.inv(lower) / norms @ columns.T).T
                return vectors
    return _one_by_one(columns / norms)


def _one_by_one(units: Floats) -> Floats:
    """Vectors of columns of unit length, by Gram and Schmidt.

    A column that says nothing new has no part in those behind it: what is left of it is rounding and noise, and would
    turn them any way.
    """
    rows, count = units.shape
    vectors = np.zeros((rows, count))
    # Two rows for each column: a short recording does not show the last columns.
    for number in range(min(count, rows, max(1, rows // 2))):
        new, before = units[:, number], vectors[:, :number]
        for _ in range(2):  # twice is enough (W. Kahan, in B. N. Parlett 1980)
            new = new - before @ (before.T @ new)
        length = float(np.linalg.norm(new))
        if length > NEW_SHARE:
            vectors[:, number] = new / length
    return vectors
