"""Features of the recordings beside those of the simulator, before and after the causes are added, for a person."""

from dataclasses import dataclass

import numpy as np

from firmware_sim.effects.catalogue import CATALOGUE
from gyrodrift.arrays import Floats
from gyrodrift.diagnose.diagnosis import Diagnosis, Drawn
from gyrodrift.diagnose.features.feature import Feature
from gyrodrift.diagnose.features.units import FeatureReading
from gyrodrift.diagnose.features.vector import FEATURES, NUMBER, rms_scale
from gyrodrift.diagnose.inference.verdict import together

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
        How far it is off over all sessions, in standard deviations of chance.
    real
        Shape (sessions,), less what the replay itself adds.
    after
        Under sizes fitted on the other sessions; None where no cause was found.
    """

    feature: Feature
    unit: str
    z_before: float
    z_after: float
    real: Floats
    before: Band
    after: Band | None


def compared_of(diagnosis: Diagnosis) -> list[FeatureComparison]:
    """Of every feature that stands out before or after, the worst before first."""
    verdict, drawn = diagnosis.verdict, diagnosis.drawn
    names = dict.fromkeys(odd.feature for odd in (*verdict.where, *verdict.leftover))
    left = {odd.feature: odd.z for odd in verdict.leftover}
    scale, base = (
        np.array([rms_scale(subject.design) for subject in drawn.subjects]),
        np.array([table.runs.mean(axis=0) for table in drawn.tables]),
    )
    change, spread = predicted(drawn)
    evidence = drawn.attribution.evidence
    z_before, z_after = together(evidence.z), together((evidence.difference - change) / spread)

    def compared(name: str) -> FeatureComparison:
        at = NUMBER[name]
        reading = FEATURES[at].reading
        by, middle = scale[:, at], base[:, at]
        return FeatureComparison(
            feature=FEATURES[at],
            unit=reading.unit,
            z_before=float(z_before[at]),
            z_after=float(left.get(name, z_after[at])),
            real=reading.of((middle + evidence.difference[:, at]) / by),
            before=_band(reading, middle, evidence.sigma[:, at], by),
            after=_band(reading, middle + change[:, at], spread[:, at], by) if verdict.causes else None,
        )

    return [compared(name) for name in names]


def predicted(drawn: Drawn) -> tuple[Floats, Floats]:
    """(sessions, F) what the effects found change, and its spread; each session under sizes fitted on the others."""
    attribution, causes = drawn.attribution, drawn.found.causes
    count = len(drawn.subjects)
    change, spread = np.zeros_like(attribution.evidence.difference), attribution.evidence.sigma.copy()
    for left in range(count if causes else 0):
        others = [session for session in range(count) if session != left] or None
        effects = [cause for cause in attribution.fitted(causes, others) if cause.name in CATALOGUE]
        mean, variance, allowance = attribution.prediction(effects)
        change[left] = mean[left]
        spread[left] = np.sqrt(spread[left] ** 2 + (variance + allowance)[left])
    return change, spread


def _band(reading: FeatureReading, middle: Floats, sigma: Floats, by: Floats) -> Band:
    ends = (reading.of((middle + deviates * sigma) / by) for deviates in (-BAND, 0.0, BAND))
    return Band(*ends)
