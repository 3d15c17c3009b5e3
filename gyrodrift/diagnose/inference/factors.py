"""Covariance of a random effect between features, as factors from its realizations.

A slow disturbance of the bias moves many features together, differently in each session. Let R hold K realizations
minus their mean as rows. Then

    covariance = lambda diag(R' R) / K + (1 - lambda) R' R / K = scatter + L' L                     (4)
    log N(y; 0, D + L' L) = log N(y - L' a; 0, D) - a' a / 2 - log det(I + L D^-1 L') / 2           (5)

with a = (I + L D^-1 L')^-1 L D^-1 y, exactly. The factor lambda shrinks correlations from a few realizations
(J. Schaefer and K. Strimmer, A shrinkage approach to large-scale covariance matrix estimation, 2005). With Student
densities D is reweighted by the residual.
"""

from typing import NamedTuple

import numpy as np

from gyrodrift.io.compile import compiled_once
from gyrodrift.values.arrays import Floats, Integers

MOST_FACTORS = 10
"""Number of principal directions of the realizations; the rest of the variance counts as scatter. Chosen: nearly all
directions that 12 realizations of a session have."""

LEAST_MOVED = 1e-6
"""Variance below which factors do not change a feature, in units of the variance without a gap. Chosen: numerical, far
below 1."""

REWEIGHTED = 3
"""Number of solutions of equation (5); each uses the weights of the solution before. Chosen: a fixed number, for
speed."""


class Covariance(NamedTuple):
    """Equation (4): (F,) scatter, and (K, F) factors L."""

    scatter: Floats
    factors: Floats


def covariance_of(realized: Floats) -> Covariance:
    """Covariance of K realizations of F features, (K, F), minus their mean."""
    count = len(realized)
    variance = np.square(realized).mean(axis=0)
    moved = np.flatnonzero(variance > 0.0)
    if count < 3 or not len(moved):
        return Covariance(variance, np.zeros((0, len(variance))))
    share = shrinkage(realized[:, moved])
    unit = np.sqrt(variance[moved])
    _, lengths, directions = np.linalg.svd(realized[:, moved] / unit, full_matrices=False)
    factors = np.zeros((min(MOST_FACTORS, len(lengths)), len(variance)))
    factors[:, moved] = np.sqrt((1.0 - share) / count) * lengths[:MOST_FACTORS, None] * directions[:MOST_FACTORS] * unit
    return Covariance(variance - np.square(factors).sum(axis=0), factors)


def shrinkage(realized: Floats) -> float:
    """Shrinkage of the correlations of (K, F) realizations, 0 to 1; lambda of equation (4)."""
    count = len(realized)
    standard = realized / np.sqrt(np.square(realized).mean(axis=0))
    products = standard[:, :, None] * standard[:, None, :]
    correlation = products.mean(axis=0)
    variance = products.var(axis=0) / (count - 1)
    off = ~np.eye(len(correlation), dtype=np.bool_)
    return float(min(variance[off].sum() / max(np.square(correlation[off]).sum(), 1e-12), 1.0)) if off.any() else 1.0


@compiled_once()
def explained(residual: Floats, own: Floats, placed: Floats, variance: Floats, nu: float) -> tuple[Floats, Floats]:
    """(N, S, F) residual minus the part that factors explain, and (N,) log density of that part; equation (5).

    residual
        (N, S, F) difference minus prediction at N points of a template.
    own, placed
        (N, S, K, F) factors of the template, and (S, M, F) factors of the other effects of the set.
    variance
        (N, S, F) variance of the residual without these factors.
    """
    points, sessions, features = residual.shape
    number = own.shape[2] + placed.shape[1]
    unexplained, cost = residual.copy(), np.zeros(points)
    moved, factors = np.zeros(features, np.int64), np.zeros((number, features))
    for n in range(points):
        for s in range(sessions):
            used = _gather(own[n, s], placed[s], factors, moved)
            if used:
                values, variances = np.empty(used), np.empty(used)
                for u in range(used):
                    values[u], variances[u] = residual[n, s, moved[u]], variance[n, s, moved[u]]
                fitted, spent = _fitted(np.ascontiguousarray(factors[:, :used]), values, variances, nu)
                cost[n] -= spent
                for u in range(used):
                    unexplained[n, s, moved[u]] -= fitted[u]
    return unexplained, cost


@compiled_once()
def _gather(own: Floats, placed: Floats, factors: Floats, moved: Integers) -> int:
    """Fill `factors` and `moved` with the features that factors change; return their number."""
    used = 0
    for f in range(own.shape[1]):
        total = 0.0
        for k in range(len(factors)):
            value = own[k, f] if k < len(own) else placed[k - len(own), f]
            factors[k, used] = value
            total += value * value
        if total > LEAST_MOVED:
            moved[used] = f
            used += 1
    return used


@compiled_once(fastmath={"reassoc", "contract"})
def _fitted(factors: Floats, values: Floats, variances: Floats, nu: float) -> tuple[Floats, float]:
    """Part of the values that factors explain, and its negative log density; equation (5)."""
    number, used = factors.shape
    weights, weighted = 1.0 / variances, np.empty(used)
    fitted, root, amounts, spent = np.zeros(used), np.empty((number, number)), np.empty(number), 0.0
    for _ in range(REWEIGHTED):
        fitted[:] = 0.0
        for i in range(number):
            for u in range(used):
                weighted[u] = factors[i, u] * weights[u]
            for j in range(i + 1):
                root[i, j] = 1.0 if i == j else 0.0
                for u in range(used):
                    root[i, j] += weighted[u] * factors[j, u]
            amounts[i] = 0.0
            for u in range(used):
                amounts[i] += weighted[u] * values[u]
        spent = _solve(root, amounts)
        for i in range(number):
            spent += 0.5 * amounts[i] ** 2
            for u in range(used):
                fitted[u] += amounts[i] * factors[i, u]
        for u in range(used):
            weights[u] = (nu + 1.0) / (nu + (values[u] - fitted[u]) ** 2 / variances[u]) / variances[u]
    return fitted, spent


@compiled_once()
def _solve(root: Floats, amounts: Floats) -> float:
    """Solve a positive definite system in place by its lower triangle; return half of its log determinant."""
    half = 0.0
    for i in range(len(amounts)):
        for j in range(i + 1):
            for k in range(j):
                root[i, j] -= root[i, k] * root[j, k]
            root[i, j] = np.sqrt(root[i, i]) if i == j else root[i, j] / root[j, j]
            amounts[i] -= root[i, j] * amounts[j] if j < i else 0.0
        amounts[i] /= root[i, i]
        half += np.log(root[i, i])
    for i in range(len(amounts) - 1, -1, -1):
        for k in range(i + 1, len(amounts)):
            amounts[i] -= root[k, i] * amounts[k]
        amounts[i] /= root[i, i]
    return half
