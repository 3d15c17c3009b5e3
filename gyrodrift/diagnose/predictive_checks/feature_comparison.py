"""Features of the recordings beside those of the simulator, before and after the causes are added, in known units."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.design_matrix import DesignMatrix
from gyrodrift.diagnose.features.feature import Feature
from gyrodrift.diagnose.features.units import FeatureReading
from gyrodrift.diagnose.features.vector import FEATURES, rms_scale
from gyrodrift.diagnose.inference.family_wise import pooled_z
from gyrodrift.diagnose.inference.fit import fitted_without
from gyrodrift.diagnose.inference.surrogate import Cause, Surrogate

BAND = 2.0
"""Standard deviations: nineteen in twenty lie within, where chance alone is at work."""


@dataclass(frozen=True, slots=True, eq=False)
class Band:
    """What a simulator expects of a feature, and how far chance alone may take it; shape (sessions,) each."""

    low: Floats
    middle: Floats
    high: Floats


@dataclass(frozen=True, slots=True, eq=False)
class FeatureComparison:
    """A feature in the units of its reading.

    z_before, z_after
        How far it deviates, pooled over all sessions, in standard deviations of chance; with the effects of the
        catalogue alone after.
    real
        Shape (sessions,), less what the replay itself adds.
    before, after
        Of the simulator; after under sizes fitted on the other sessions.
    """

    feature: Feature
    unit: str
    z_before: float
    z_after: float
    real: Floats
    before: Band
    after: Band


def feature_comparisons_of(
    surrogate: Surrogate, causes: Sequence[Cause], simulated: Floats, designs: Sequence[DesignMatrix]
) -> tuple[FeatureComparison, ...]:
    """Of every feature, in the order of FEATURES.

    simulated
        (sessions, F) features of the rig as it stands, driven through each session's motion.
    """
    evidence, scale = surrogate.evidence, np.array([rms_scale(design) for design in designs])
    change, spread = _held_out_prediction(surrogate, causes)
    z_before, z_after = pooled_z(evidence.z), pooled_z((evidence.difference - change) / spread)

    def compared(at: int, feature: Feature) -> FeatureComparison:
        by, middle, reading = scale[:, at], simulated[:, at], feature.reading
        return FeatureComparison(
            feature=feature,
            unit=reading.unit,
            z_before=float(z_before[at]),
            z_after=float(z_after[at]),
            real=reading.of((middle + evidence.difference[:, at]) / by),
            before=_band(reading, middle, evidence.sigma[:, at], by),
            after=_band(reading, middle + change[:, at], spread[:, at], by),
        )

    return tuple(compared(at, feature) for at, feature in enumerate(FEATURES))


def _held_out_prediction(surrogate: Surrogate, causes: Sequence[Cause]) -> tuple[Floats, Floats]:
    """(sessions, F) what the effects found change, and its spread; each session under sizes fitted on the others."""
    evidence = surrogate.evidence
    change, spread = np.zeros_like(evidence.difference), evidence.sigma.copy()
    for held_out in range(len(evidence.names) if causes else 0):
        effects = [cause for cause in fitted_without(surrogate, causes, held_out) if not cause.is_out_of_catalogue]
        predicted = surrogate.prediction(effects)
        change[held_out] = predicted.change[held_out]
        spread[held_out] = np.sqrt(spread[held_out] ** 2 + (predicted.variance + predicted.discrepancy)[held_out])
    return change, spread


def _band(reading: FeatureReading, middle: Floats, sigma: Floats, by: Floats) -> Band:
    ends = (reading.of((middle + deviates * sigma) / by) for deviates in (-BAND, 0.0, BAND))
    return Band(*ends)
