"""Features of the recordings beside those of the simulator, before and after the causes are added, in known units."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.design_matrix import DesignMatrix
from gyrodrift.diagnose.features.feature import Feature, FeatureReading
from gyrodrift.diagnose.features.vector import FEATURES, rms_scale
from gyrodrift.diagnose.inference.evidence import pooled_z
from gyrodrift.diagnose.inference.explanation import Explanation

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
    explanation: Explanation, simulated: Floats, designs: Sequence[DesignMatrix]
) -> tuple[FeatureComparison, ...]:
    """Of every feature that the sessions have, in the order of FEATURES.

    simulated
        (sessions, F) features of the rig as it stands, driven through each session's motion.
    """
    evidence, scale = explanation.evidence, np.array([rms_scale(design) for design in designs])
    unit = explanation.scorer.observation.unit
    change, variance = (held * power for held, power in zip(explanation.held_out, (unit, np.square(unit)), strict=True))
    spread = np.sqrt(np.square(evidence.sigma) + variance)
    z_before, z_after = pooled_z(evidence.z), pooled_z(explanation.held_out_z)

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

    is_present = evidence.is_present
    return tuple(compared(at, feature) for at, feature in enumerate(FEATURES) if is_present[at])


def _band(reading: FeatureReading, middle: Floats, sigma: Floats, by: Floats) -> Band:
    ends = (reading.of((middle + deviates * sigma) / by) for deviates in (-BAND, 0.0, BAND))
    return Band(*ends)
