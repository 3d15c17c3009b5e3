"""The threshold that no feature passes by chance: a family-wise error over all of them.

It is that of this rig and these motions: it comes from the null of these very sessions. Two ways to it are taken, and
the higher one holds: the largest feature of sets of sessions put together from the null runs, and Student's quantile of
as many runs, shared out over the features (Šidák), which knows how little so few runs say of the far tails.
"""

import numpy as np
from scipy.optimize import brentq
from scipy.stats import t as student

from gyrodrift.arrays import Floats

FAMILY_WISE_ERROR = 0.02
"""Probability that chance makes a deviation of any feature. Of the 5 % that a false alarm may have in all, the search
over causes and what is not exact in the null need their part."""

LEAST, MOST = 4.3, 1e6
"""Of the threshold: where chance is small beside the relevance thresholds, what is not exact in the null decides. Of
218 rigs drawn at random and driven through themselves, 8 went beyond 3.5 and 3 beyond 4.3; of 171 devices with what no
effect does, 1 lay in between."""

SETS = 400
SEED = 0


def pooled_z(z: Floats) -> Floats:
    """(F,) one normal deviate for all sessions: a common shift, or a scatter of either sign, whichever is clearer."""
    count = len(z)
    shift = z.mean(axis=0) * np.sqrt(count)
    scatter = np.linalg.norm(z, axis=0) - np.sqrt(count)
    found: Floats = np.where(scatter > np.abs(shift), scatter * np.where(shift < 0.0, -1.0, 1.0), shift)
    return found


def family_wise_threshold(nulls: Floats) -> float:
    """Of a pooled z.

    nulls
        (sessions, runs, F) differences without a gap, in units of sigma.
    """
    sessions, runs, features = nulls.shape
    degrees = sessions * runs - 1
    if degrees < 1:
        return float("inf")
    # A mean over sessions scatters about the centre of these runs, which has a scatter of its own.
    spread = np.sqrt(np.square(nulls).reshape(-1, features).sum(axis=0) / degrees * (1.0 + 1.0 / runs))
    spread = spread[spread > 0.0]
    if not len(spread):
        return float("inf")
    by_student = float(brentq(lambda z: _expected(z, spread, degrees) + np.log1p(-FAMILY_WISE_ERROR), 0.0, MOST))
    return max(LEAST, by_student, float(np.quantile(_largest(nulls), 1.0 - FAMILY_WISE_ERROR)))


def _expected(z: float, spread: Floats, degrees: int) -> float:
    """How many features of these spreads go beyond a z by chance."""
    return float(2.0 * student.sf(z / spread, degrees).sum())


def _largest(nulls: Floats) -> Floats:
    """(sets,) the largest pooled z of one run of each session, about the centre of the others.

    Sigma knows these runs too, which makes them smaller.
    """
    sessions, runs, _ = nulls.shape
    chosen = np.random.default_rng(SEED).integers(runs, size=(SETS, sessions))
    own = np.sqrt((sessions * runs + 1.0) / (sessions * runs - 1.0))
    drawn = nulls[np.arange(sessions), chosen]
    if runs > 1:
        drawn = drawn + drawn.mean(axis=1, keepdims=True) / (runs - 1.0)
    largest: Floats = own * np.array([np.abs(pooled_z(one)).max() for one in drawn])
    return largest
