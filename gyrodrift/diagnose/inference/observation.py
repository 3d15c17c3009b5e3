"""Observed differences between recordings and simulation, with their covariance where there is no gap."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from gyrodrift.diagnose.inference.density import DEGREES_OF_FREEDOM
from gyrodrift.diagnose.inference.nulls import pooled_nulls
from gyrodrift.diagnose.simulate.response_table import ResponseTable
from gyrodrift.values.arrays import Floats, Mask

SHARED_RELEVANCE = 0.5
"""Share of the relevance variance that all sessions have in common. Chosen: half, since the rig has the same small
error of the rig in each."""

LEAST_VARIANCE = 0.05
"""Least variance of a feature in its own unit. Chosen: a few null runs do not determine less."""


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
    relevance, device
        (S, F) variances that `covariance` has by the relevance thresholds, and by the device from recording to
        recording, in squares of `unit`; both are partly common to the sessions.
    degrees
        Degrees of freedom of the Student density.
    """

    difference: Floats
    unit: Floats
    covariance: Floats
    is_compared: Mask
    relevance: Floats | float = 0.0
    device: Floats | float = 0.0
    degrees: float = DEGREES_OF_FREEDOM

    def of_sessions(self, rows: Sequence[int]) -> "Observation":
        """Some of the sessions."""
        relevance, device = (np.broadcast_to(part, self.unit.shape)[rows] for part in (self.relevance, self.device))
        return replace(
            self,
            difference=self.difference[rows],
            unit=self.unit[rows],
            covariance=self.covariance[:, rows][:, :, rows],
            is_compared=self.is_compared[rows],
            relevance=relevance,
            device=device,
        )

    def without_device(self, explained: Floats) -> "Observation":
        """The observation with less variance by the device, because a model of the device explains (S, F) of it."""
        total = self.relevance + self.device
        remaining = self.relevance + np.maximum(self.device - explained, 0.0)
        shared = np.full(self.unit.shape[1], SHARED_RELEVANCE)
        covariance = (
            self.covariance + _mixed(remaining, shared) - _mixed(np.broadcast_to(total, remaining.shape), shared)
        )
        return replace(self, covariance=covariance, device=remaining - self.relevance)

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
    degrees = min(DEGREES_OF_FREEDOM, *(table.degrees for table in tables))
    observation = _in_units(pooled.difference, covariance, is_compared)
    sigmas = [table.device_sigma / own for table, own in zip(tables, observation.unit, strict=True)]
    device: Floats = np.where(is_compared, np.square(np.array(sigmas)), 0.0)
    relevance: Floats = np.where(is_compared, np.square(thresholds / observation.unit), 0.0) - device
    return replace(observation, relevance=np.maximum(relevance, 0.0), device=device, degrees=degrees)


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
