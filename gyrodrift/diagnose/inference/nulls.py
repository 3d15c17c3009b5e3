"""Pooled null runs of all sessions: their mean, their variance, and the errors that sessions have in common."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from gyrodrift.diagnose.features.vector import OF_MOTION
from gyrodrift.diagnose.simulate.response_table import ResponseTable
from gyrodrift.values.arrays import Floats

PRIOR_RUNS = 2.0
"""Weight of the prior assumption of independent sessions, in null runs. Chosen: less than the 4 null runs that each
session has at least."""


class PooledNulls(NamedTuple):
    """Differences of S sessions in F features, and their scatter without a gap.

    difference
        (S, F) recording minus simulation, minus the mean of the nulls.
    away
        (S, runs, F) nulls minus their mean.
    variance
        (S, F) variance of a null: that of all sessions, or more if the nulls of a session scatter more.
    common_share
        (F,) ratio of the variance of a mean over sessions to that of independent sessions.
    rebuilding
        (F,) squared error by rebuilding the motion; the error is the same in all sessions.
    """

    difference: Floats
    away: Floats
    variance: Floats
    common_share: Floats
    rebuilding: Floats


def pooled_nulls(tables: Sequence[ResponseTable]) -> PooledNulls:
    """Pool the nulls of the sessions that have a feature."""
    nulls = np.array([table.nulls for table in tables])
    differences = np.array([table.difference for table in tables])
    has = nulls.any(axis=1) | (differences != 0.0)
    runs = np.maximum(has.sum(axis=0) * nulls.shape[1], 1)
    mean = nulls.sum(axis=(0, 1)) / runs
    center = np.where(has, mean, 0.0)
    away = nulls - center[:, None]
    variance = np.square(away).sum(axis=(0, 1)) / np.maximum(runs - 1, 1)
    own = np.maximum(variance, 0.5 * (variance + np.square(away).mean(axis=1)))
    rebuilding = np.where(OF_MOTION, beyond_chance(mean, variance / runs), 0.0)
    return PooledNulls(differences - center, away, own, common_share(away), rebuilding)


def beyond_chance(mean: Floats, variance: Floats) -> Floats:
    """(F,) squared mean of a difference beyond chance: the error that all sessions share by rebuilding their motion.

    The mean of the null is the error of the second rebuilding. The error of the first one is assumed to be as large, of
    either sign.

    variance
        Variance of the mean by chance.
    """
    excess: Floats = np.maximum(np.square(mean) - variance, 0.0)
    return excess


def common_share(nulls: Floats) -> Floats:
    """(F,) ratio of the variance of a mean over sessions to that of independent sessions; at least 1.

    Sessions of the same motion share the error of rebuilding it.

    nulls
        (sessions, runs, F) differences without a gap. In a run, equal motions are drawn with equal random numbers.
    """
    sessions, runs, _ = nulls.shape
    if sessions == 1 or runs == 1:
        return np.ones(nulls.shape[-1])
    own = np.square(nulls).mean(axis=(0, 1))
    together = np.square(nulls.mean(axis=0)).sum(axis=0) / (runs - 1)
    ratio = sessions * together / np.where(own > 0.0, own, 1.0)
    shrunk = (PRIOR_RUNS + (runs - 1) * ratio) / (PRIOR_RUNS + runs - 1)
    share: Floats = np.clip(shrunk, 1.0, sessions)
    return share
