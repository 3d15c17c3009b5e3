"""Observed differences between recordings and simulation, with their covariance where there is no gap."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gyrodrift.diagnose.inference.nulls import pooled_nulls
from gyrodrift.diagnose.simulate.response_table import ResponseTable
from gyrodrift.values.arrays import Floats, Mask

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
    pooled = pooled_nulls(tables)
    sessions = len(tables)
    thresholds = np.array([table.thresholds for table in tables])
    correlation = (pooled.common_share - 1.0) / max(sessions - 1, 1)
    rebuilding = np.broadcast_to(pooled.rebuilding, pooled.variance.shape)
    covariance = (
        _mixed(pooled.variance, correlation) + _mixed(rebuilding, np.ones_like(correlation))
        + _mixed(np.square(thresholds), np.full_like(correlation, SHARED_RELEVANCE))
    )  # fmt: skip
    return _in_units(pooled.difference, covariance, is_compared)


def _mixed(variance: Floats, correlation: Floats) -> Floats:
    """(F, S, S) covariance of variances (S, F) with one correlation between all sessions, (F,)."""
    root = np.sqrt(variance).T
    between = correlation[:, None, None] * root[:, :, None] * root[:, None, :]
    diagonal = np.eye(len(variance)) * ((1.0 - correlation)[:, None] * variance.T)[:, :, None]
    covariance: Floats = between + diagonal
    return covariance


def _in_units(difference: Floats, covariance: Floats, is_compared: Mask) -> Observation:
    """The observation in units of the standard deviation without a gap; features that are not compared have 0 and 1."""
    variance = np.diagonal(covariance, axis1=1, axis2=2).T
    unit = np.where(is_compared & (variance > 0.0), np.sqrt(variance), 1.0)
    scaled = covariance / (unit.T[:, :, None] * unit.T[:, None, :])
    compared = is_compared.T
    scaled = np.where(compared[:, :, None] & compared[:, None, :], scaled, 0.0)
    sessions = np.arange(len(unit))
    scaled[:, sessions, sessions] = np.maximum(np.where(compared, scaled[:, sessions, sessions], 1.0), LEAST_VARIANCE)
    return Observation(np.where(is_compared, difference / unit, 0.0), unit, scaled, is_compared)
