"""Features of the recordings and of the simulator, without and with the causes, in units for people."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gyrodrift.diagnose.features.design_matrix import DesignMatrix
from gyrodrift.diagnose.features.feature import Feature, FeatureReading
from gyrodrift.diagnose.features.vector import FEATURES, rms_scale
from gyrodrift.diagnose.inference.evidence import pooled_z
from gyrodrift.diagnose.inference.explanation import Explanation
from gyrodrift.values.arrays import Floats

BAND = 2.0
"""Half width of a band in standard deviations. Chosen: by chance, 19 of 20 values lie within."""


@dataclass(frozen=True, slots=True, eq=False)
class Band:
    """(sessions,) expected values of a feature in the simulator, and the ends of the band of chance about them."""

    low: Floats
    middle: Floats
    high: Floats


@dataclass(frozen=True, slots=True, eq=False)
class FeatureComparison:
    """A feature in recordings and simulator, in the unit of its reading.

    z_before, z_after
        Deviation pooled over all sessions, in standard deviations of chance; after with the named causes.
    real
        (sessions,) values of the recordings, without the bias of a replay.
    before, after
        Values of the simulator, without and with the named causes. Their sizes are fitted on the other sessions.
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
    """Comparisons of all features that the sessions have, in the order of FEATURES.

    simulated
        (sessions, F) features of the rig without the causes, driven by the motion of each session.
    """
    evidence, scale = explanation.evidence, np.array([rms_scale(design) for design in designs])
    unit = explanation.scorer.observation.unit
    in_units, variance_in_units = explanation.held_out
    change, variance = in_units * unit, variance_in_units * np.square(unit)
    spread = np.sqrt(np.square(evidence.sigma) + variance)
    z_before, z_after = pooled_z(evidence.z), pooled_z(explanation.held_out_z)

    def compared(index: int, feature: Feature) -> FeatureComparison:
        divisor, middle, reading = scale[:, index], simulated[:, index], feature.reading
        return FeatureComparison(
            feature=feature,
            unit=reading.unit,
            z_before=float(z_before[index]),
            z_after=float(z_after[index]),
            real=reading.of((middle + evidence.difference[:, index]) / divisor),
            before=_band(reading, middle, evidence.sigma[:, index], divisor),
            after=_band(reading, middle + change[:, index], spread[:, index], divisor),
        )

    is_present = evidence.is_present
    return tuple(compared(index, feature) for index, feature in enumerate(FEATURES) if is_present[index])


def _band(reading: FeatureReading, middle: Floats, sigma: Floats, divisor: Floats) -> Band:
    """Band about expected values, in the unit of the reading."""
    ends = (reading.of((middle + deviates * sigma) / divisor) for deviates in (-BAND, 0.0, BAND))
    return Band(*ends)
