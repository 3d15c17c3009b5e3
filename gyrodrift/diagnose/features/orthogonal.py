"""Orthonormal bases of regressors: a part common to two regressors counts for the first."""

from typing import NamedTuple

import numpy as np

from gyrodrift.values.arrays import Floats

NEW_SHARE = 0.03
"""Minimum share of a column's length that is orthogonal to all columns before it. Below it the column is redundant.
Chosen: far above the rounding error that remains of a redundant column."""

WELL_CONDITIONED = 1e-2
"""Smallest singular value of the unit columns for which their products are accurate to twelve digits. Derived: its
square is 1e-4, which costs 4 of 16 digits."""

TINY = 1e-300
"""Lower bound of a norm, so that a column of zeros does not divide by zero. Chosen: just above the least normal double,
2e-308."""


class Basis(NamedTuple):
    """Orthonormal vectors, (rows, columns), and thresholds of their coefficients, (columns,).

    A redundant column has a vector of zeros. Columns with coefficients as large as their relevance thresholds have
    coefficients on a vector; the threshold of the vector is the root of their sum of squares.
    """

    vectors: Floats
    thresholds: Floats


def orthonormal(columns: Floats, thresholds: Floats, dropped: int) -> Basis:
    """Basis of columns in their order, (rows, columns), orthogonal to the first `dropped` columns and without them."""
    vectors = orthonormal_vectors(columns)[:, dropped:]
    amounts = vectors.T @ (columns[:, dropped:] * thresholds)
    return Basis(vectors, np.linalg.norm(amounts, axis=1))


def orthonormal_vectors(columns: Floats) -> Floats:
    """Orthonormal vectors that span the columns; zeros for a redundant column."""
    norms = np.maximum(np.sqrt(np.einsum("ij,ij->j", columns, columns)), TINY)
    if len(columns) >= 1500:  # faster by a Cholesky decomposition from 1500 rows on
        products = columns.T @ columns / norms / norms[:, None]
        if np.linalg.eigvalsh(products)[0] > WELL_CONDITIONED**2:
            lower = np.asarray(np.linalg.cholesky(products), dtype=np.float64)
            if np.diag(lower).min() > NEW_SHARE:
                vectors: Floats = (np.linalg.inv(lower) / norms @ columns.T).T
                return vectors
    return _gram_schmidt(columns / norms)


def _gram_schmidt(units: Floats) -> Floats:
    """Orthonormal vectors of columns of unit length, by Gram-Schmidt orthogonalization.

    A redundant column becomes zeros, because its remainder is rounding error and would disturb the next vectors.
    """
    rows, count = units.shape
    vectors = np.zeros((rows, count))
    # At least two rows per column: in a short recording, the last columns are zeros.
    for number in range(min(count, rows, max(1, rows // 2))):
        new, before = units[:, number], vectors[:, :number]
        for _ in range(2):  # two passes are enough (W. Kahan, in B. N. Parlett 1980)
            new = new - before @ (before.T @ new)
        length = float(np.linalg.norm(new))
        if length > NEW_SHARE:
            vectors[:, number] = new / length
    return vectors
