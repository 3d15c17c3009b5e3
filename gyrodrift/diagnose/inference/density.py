"""The density of the observed differences: Student in each feature, with groups of features that an unknown may move.

    y_f ~ Student_nu(mean_f, C_f)                                                                  (1)
    C_f = null covariance + form error + scatter of random effects [+ unknown variance]            (2)

y_f is a vector over sessions. All variances are in the determinant. An unknown effect moves features of some groups.
The sum over its states is exact, because groups are independent given the effects.
"""

import math
from typing import NamedTuple

import numpy as np

from gyrodrift.io.compile import compiled_once
from gyrodrift.values.arrays import Floats, Integers, Mask

DEGREES_OF_FREEDOM = 20.0
"""Degrees of freedom of the Student density. Measured: between 12 and 30 the verdicts on 13 simulated rigs without a
gap stay the same; fewer degrees hide an unknown effect that moves one feature only."""

UNKNOWN_WIDTHS = (3.0, 10.0, 40.0)
"""Standard deviations by which an unknown effect moves a feature, equally probable. Chosen, not measured."""

UNKNOWN_COMMON = 0.8
"""Share of the variance of an unknown effect that all sessions have in common. Chosen: it acts in most sessions."""

UNKNOWN_SHARES = (0.05, 0.25, 0.75)
"""Shares of the features of a group that an unknown effect moves, equally probable. Chosen: one feature of a group,
some, most."""

UNKNOWN_IN_GROUP = 0.005
"""Prior probability that an unknown effect moves features of one group. Chosen: 18 groups give 9 % together."""

UNKNOWN_BROAD, BROAD_IN_GROUP = 0.01, 0.3
"""Prior probability of an unknown effect that moves many groups, and of each group then. Chosen: rarer than
effects on single groups, 9 % together, and it moves about a third of the groups."""

MOVED = 1e-3
"""Change in standard deviations below which a template does not change a feature. Chosen: numerical, since no density
changes noticeably."""


class LogDensities(NamedTuple):
    """Log densities of N points.

    without_unknown
        (N,) without an unknown effect.
    either
        (N,) summed over all states of the unknown effect, none of them included, with their prior.
    """

    without_unknown: Floats
    either: Floats


def log_no_unknown(groups: int) -> float:
    """Logarithm of the prior probability that no group is moved by an unknown effect."""
    narrow = (1.0 - UNKNOWN_BROAD) * (1.0 - UNKNOWN_IN_GROUP) ** groups
    return math.log(narrow + UNKNOWN_BROAD * (1.0 - BROAD_IN_GROUP) ** groups)


def log_densities(
    residual: Floats,
    mean: Floats,
    scatter: Floats,
    form: Floats,
    covariance: Floats,
    groups: "Groups",
    degrees: float = DEGREES_OF_FREEDOM,
) -> LogDensities:
    """Densities at N points of a template; the other effects of the set are fixed.

    residual
        (N, S, F) difference minus prediction.
    mean, scatter
        (N, S, F) mean and variance of the change by the template.
    form
        (N, S, F) standard deviation of the mean, with its sign; half of the variance is common to the sessions.
    covariance
        (F, S, S) covariance of the difference without the template.
    degrees
        Degrees of freedom of the Student density.
    """
    by_width = _by_width(
        residual, mean, scatter, form, covariance, groups.is_used, np.array((0.0, *UNKNOWN_WIDTHS)),
        degrees,
    )  # fmt: skip
    return LogDensities(*_summed(by_width, groups.of_feature, groups.number, np.array(UNKNOWN_SHARES)))


class Groups(NamedTuple):
    """Groups of features that an unknown effect moves together.

    of_feature
        (F,) index of the group of each feature.
    is_used
        (F,) whether any session compares the feature.
    """

    of_feature: Integers
    number: int
    is_used: Mask


@compiled_once()
def _log_student(
    residual: Floats, covariance: Floats, nu: float, constant: float, root: Floats, white: Floats
) -> float:
    """Logarithm of a multivariate Student density by a Cholesky factorization.

    constant
        Logarithm of the part that depends on `nu` and the number of sessions only.
    root, white
        Working memory: the factor with the inverse of its diagonal, and the whitened residual.
    """
    size = len(residual)
    log_determinant, determinant = 0.0, 1.0
    square = 0.0
    for i in range(size):
        for j in range(i):
            value = covariance[i, j]
            for k in range(j):
                value -= root[i, k] * root[j, k]
            root[i, j] = value * root[j, j]
        value, deviation = covariance[i, i], residual[i]
        for k in range(i):
            value -= root[i, k] * root[i, k]
            deviation -= root[i, k] * white[k]
        pivot = math.sqrt(max(value, 1e-9))
        root[i, i] = 1.0 / pivot
        white[i] = deviation * root[i, i]
        square += white[i] ** 2
        determinant *= pivot
        if not 1e-100 < determinant < 1e100:
            log_determinant += math.log(determinant)
            determinant = 1.0
    log_determinant += math.log(determinant)
    return constant - log_determinant - 0.5 * (nu + size) * math.log1p(square / nu)


@compiled_once()
def _by_width(
    residual: Floats, mean: Floats, scatter: Floats, form: Floats, covariance: Floats, is_used: Mask, widths: Floats,
    nu: float,
) -> Floats:  # fmt: skip
    """(N, F, widths) log densities of each feature at each width of an unknown; 0 for features that are not used."""
    points, sessions, features = mean.shape
    densities = np.zeros((points, features, len(widths)))
    alone = np.zeros((features, len(widths)))
    is_known = np.zeros(features, np.bool_)
    total = np.zeros((sessions, sessions))
    root, white, session_residual = np.zeros((sessions, sessions)), np.zeros(sessions), np.zeros(sessions)
    constant = math.lgamma(0.5 * (nu + sessions)) - math.lgamma(0.5 * nu) - 0.5 * sessions * math.log(nu * math.pi)
    for n in range(points):
        for f in range(features):
            if not is_used[f]:
                continue
            moves = 0.0
            for i in range(sessions):
                moves = max(moves, abs(mean[n, i, f]), scatter[n, i, f])
                session_residual[i] = residual[n, i, f]
            if moves < MOVED and is_known[f]:
                for v in range(len(widths)):
                    densities[n, f, v] = alone[f, v]
                continue
            is_known[f] |= moves < MOVED
            for v in range(len(widths)):
                _add_up(form[n, :, f], scatter[n, :, f], covariance[f], widths[v] ** 2, total)
                densities[n, f, v] = _log_student(session_residual, total, nu, constant, root, white)
                alone[f, v] = densities[n, f, v] if moves < MOVED else alone[f, v]
    return densities


@compiled_once()
def _add_up(form: Floats, scatter: Floats, covariance: Floats, unknown: float, total: Floats) -> None:
    """Write the lower half of the covariance of equation (2) of one feature; `unknown` is the variance by that."""
    for i in range(len(form)):
        for j in range(i + 1):
            total[i, j] = covariance[i, j] + 0.5 * form[i] * form[j] + UNKNOWN_COMMON * unknown
        total[i, i] += 0.5 * form[i] ** 2 + (1.0 - UNKNOWN_COMMON) * unknown + scatter[i]


@compiled_once()
def _summed(densities: Floats, of_feature: Integers, groups: int, shares: Floats) -> tuple[Floats, Floats]:
    """Sum over the states of the unknown effect; see `LogDensities`."""
    points, features, widths = densities.shape
    without_unknown, either = np.zeros(points), np.zeros(points)
    for n in range(points):
        still, moved = np.zeros(groups), np.zeros((groups, widths - 1, len(shares)))
        for f in range(features):
            if densities[n, f, 0] == 0.0:
                continue
            g = of_feature[f]
            still[g] += densities[n, f, 0]
            for v in range(1, widths):
                ratio = math.exp(min(densities[n, f, v] - densities[n, f, 0], 600.0))
                for k in range(len(shares)):
                    moved[g, v - 1, k] += densities[n, f, 0] + math.log(1.0 - shares[k] + shares[k] * ratio)
        narrow, broad = math.log(1.0 - UNKNOWN_BROAD), math.log(UNKNOWN_BROAD)
        for g in range(groups):
            top, mean_moved = _mean_power(moved[g], still[g])
            at_rest = math.exp(still[g] - top)
            without_unknown[n] += still[g]
            narrow += top + math.log((1.0 - UNKNOWN_IN_GROUP) * at_rest + UNKNOWN_IN_GROUP * mean_moved)
            broad += top + math.log((1.0 - BROAD_IN_GROUP) * at_rest + BROAD_IN_GROUP * mean_moved)
        top = max(narrow, broad)
        either[n] = top + math.log(math.exp(narrow - top) + math.exp(broad - top))
    return without_unknown, either


@compiled_once()
def _mean_power(logarithms: Floats, least: float) -> tuple[float, float]:
    """The largest of some logarithms and of `least`, and the mean of their powers over that of the largest.

    Loops, because numba needs seconds to compile reductions of slices.
    """
    rows, columns = logarithms.shape
    top, total = least, 0.0
    for row in range(rows):
        for column in range(columns):
            top = max(top, logarithms[row, column])
    for row in range(rows):
        for column in range(columns):
            total += math.exp(logarithms[row, column] - top)
    return top, total / (rows * columns)
