"""Observed differences between recordings and simulation, with their covariance where there is no gap."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gyrodrift.arrays import Floats, Mask
from gyrodrift.diagnose.features.vector import OF_MOTION
from gyrodrift.diagnose.inference.pooling import beyond_chance, common_share, variance_of_mean
from gyrodrift.diagnose.simulate.response_table import ResponseTable

SHARED_RELEVANCE = 0.5
"""Share of the relevance variance that all sessions have in common: the same small error of the rig in each."""

LEAST_VARIANCE = 0.05
"""Least variance of a feature in its own unit: a few null runs do not determine less."""


@dataclass(frozen=True, slots=True, eq=False)
class Observation:
    """Differences of S sessions in F features.

    difference
        (S, F) recording minus simulation, in `unit`.
    unit
        (S, F) standard deviation without a gap, relevance included, in the units of the features.
    covariance
        (F, S, S) of `difference` without a gap.
    is_compared
        (S, F) whether the difference is compared.
    """

    difference: Floats
    unit: Floats
    covariance: Floats
    is_compared: Mask

    def of_sessions(self, rows: Sequence[int]) -> "Observation":
        """Some of the sessions."""
        covariance = self.covariance[:, rows][:, :, rows]
        return Observation(self.difference[rows], self.unit[rows], covariance, self.is_compared[rows])

    @property
    def sessions(self) -> int:
        """Number of sessions."""
        return len(self.difference)


def observation_of(tables: Sequence[ResponseTable], is_compared: Mask) -> Observation:
    """Pool the null runs of all sessions.

    The covariance of a feature has three terms: its null variance in each session, partly common to all sessions; the
    common error of rebuilding the motion; and the squared relevance threshold.
    """
    nulls = np.array([table.nulls for table in tables])
    thresholds = np.array([table.thresholds for table in tables])
    sessions, runs, _ = nulls.shape
    center = nulls.mean(axis=(0, 1))
    away = nulls - center
    pooled = np.square(away).sum(axis=(0, 1)) / max(sessions * runs - 1, 1)
    own = np.maximum(pooled, 0.5 * (pooled + np.square(away).mean(axis=1)))
    correlation = shared_correlation(away)
    common = np.where(OF_MOTION, beyond_chance(center, pooled / (sessions * runs)), 0.0)
    smoother = np.array([table.smoother for table in tables])
    common += beyond_chance(smoother.mean(axis=0), variance_of_mean(smoother))
    covariance = (
        _mixed(own, correlation) + _mixed(np.broadcast_to(common, own.shape), np.ones(len(common)))
        + _mixed(np.square(thresholds), np.full(own.shape[1], SHARED_RELEVANCE))
    )  # fmt: skip
    difference = np.array([table.difference for table in tables]) - center
    return _in_units(difference, covariance, is_compared)


def shared_correlation(away: Floats) -> Floats:
    """(F,) correlation between sessions, 0 to 1, for which the variance of their mean is `common_share` times as large.

    away
        (S, runs, F) null differences about their mean. Run by run their motions are drawn by the same random numbers.
    """
    sessions = len(away)
    correlation: Floats = (common_share(away) - 1.0) / max(sessions - 1, 1)
    return correlation


def _mixed(variance: Floats, correlation: Floats) -> Floats:
    """(F, S, S) covariance of variances (S, F) with one correlation between all sessions, (F,)."""
    root = np.sqrt(variance).T
    between = correlation[:, None, None] * root[:, :, None] * root[:, None, :]
    diagonal = np.eye(len(variance)) * ((1.0 - correlation)[:, None] * variance.T)[:, :, None]
    covariance: Floats = between + diagonal
    return covariance


def _in_units(difference: Floats, covariance: Floats, is_compared: Mask) -> Observation:
    variance = np.diagonal(covariance, axis1=1, axis2=2).T
    unit = np.where(is_compared & (variance > 0.0), np.sqrt(variance), 1.0)
    scaled = covariance / (unit.T[:, :, None] * unit.T[:, None, :])
    compared = is_compared.T
    scaled = np.where(compared[:, :, None] & compared[:, None, :], scaled, 0.0)
    sessions = np.arange(len(unit))
    scaled[:, sessions, sessions] = np.maximum(np.where(compared, scaled[:, sessions, sessions], 1.0), LEAST_VARIANCE)
    return Observation(np.where(is_compared, difference / unit, 0.0), unit, scaled, is_compared)
