"""Results of a diagnosis for other simulators: named effects, and noise, bias and sample rate of the recordings.

A simulator that was compared as a baseline has noise and effects of its own. Then the values are what it lacks.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import sqrt

import numpy as np

from gyrodrift.diagnose.inference.verdict import NamedCause
from gyrodrift.diagnose.report.files import headline
from gyrodrift.diagnose.result import DiagnosedSession, Diagnosis

Interval = tuple[float, float]

ADDED = {
    "scale_factor": "error_percent",
    "scale_asymmetry": "error_percent",
    "nonlinearity": "error_percent_fs",
    "vibration_rectification": "bias_dps_at_100_dps",
    "temp_bias": "slope_dps_per_c",
    "temp_scale": "slope_percent_per_c",
    "latency": "delay_ms",
    "clock_drift": "ppm",
}
"""Effects whose parameter adds up: two of them act like a single effect with the sum."""


@dataclass(frozen=True, slots=True)
class ExportedEffect:
    """A named effect with the numbers of its equation.

    Parameters have the unit at the end of their names; `intervals` are 95 % credible ones of those that were fitted.
    `in_simulator` has the parameters of the same effect in the rig or in the baseline; None without it.
    """

    name: str
    parameters: Mapping[str, float]
    intervals: Mapping[str, Interval]
    probability: float
    tied_with: tuple[str, ...]
    in_simulator: Mapping[str, float] | None


@dataclass(frozen=True, slots=True)
class MeasuredValue:
    """Median over the sessions, with the smallest and the largest value."""

    value: float
    low: float
    high: float

    def times(self, factor: float) -> "MeasuredValue":
        """Value in another unit."""
        return MeasuredValue(self.value * factor, self.low * factor, self.high * factor)


@dataclass(frozen=True, slots=True)
class Exported:
    """Everything that an export may contain.

    says
        The verdict in a sentence.
    noise_dps_rthz, bias_dps
        White noise and constant bias of the recordings, less those of the baseline.
    upper_bounds
        Smallest detectable size of effects that were not named: a larger effect would have been named.
    """

    says: str
    effects: tuple[ExportedEffect, ...]
    sample_rate_hz: float
    noise_dps_rthz: MeasuredValue
    bias_dps: MeasuredValue
    upper_bounds: Mapping[str, float]

    def effect(self, name: str) -> ExportedEffect | None:
        """An effect by name; None if it was not named."""
        return next((effect for effect in self.effects if effect.name == name), None)


def exported_of(diagnosis: Diagnosis) -> Exported:
    """Causes with a probability of 0.5 or more, as in `rig.yaml`, and noise, bias and rate of the sessions."""
    named = [cause for cause in diagnosis.verdict.causes if cause.is_adopted]
    has_baseline = bool(diagnosis.baseline)
    return Exported(
        says=headline(diagnosis),
        effects=tuple(_effect(cause, has_baseline=has_baseline) for cause in named),
        sample_rate_hz=float(np.median([session.sample_rate_hz for session in diagnosis.sessions])),
        noise_dps_rthz=_added_noise(diagnosis.sessions, diagnosis.baseline),
        bias_dps=_added_bias(diagnosis.sessions, diagnosis.baseline),
        upper_bounds={item.effect: item.value for item in diagnosis.detectable if item.value is not None},
    )


def _effect(cause: NamedCause, *, has_baseline: bool) -> ExportedEffect:
    parameters: dict[str, float] = cause.effect.model_dump(exclude={"name"})
    if cause.cause.phases_deg is not None:  # the phase differs from session to session
        parameters.pop("phase_deg", None)
    intervals = {item.name: (item.low, item.high) for item in cause.parameters}
    in_simulator = None if cause.in_rig is None else cause.in_rig.model_dump(exclude={"name"})
    added = ADDED.get(cause.effect.name)
    if has_baseline and in_simulator is not None and added is not None:
        has = float(in_simulator[added])
        parameters[added] -= has
        intervals[added] = (intervals[added][0] - has, intervals[added][1] - has)
    name = cause.effect.name
    return ExportedEffect(name, parameters, intervals, cause.probability, cause.tied_with, in_simulator)


def _added_noise(sessions: Sequence[DiagnosedSession], baseline: Sequence[DiagnosedSession]) -> MeasuredValue:
    """Independent noises add by their squares."""
    has = float(np.median([session.noise_dps_rthz for session in baseline])) if baseline else 0.0
    return _measured([sqrt(max(0.0, session.noise_dps_rthz**2 - has**2)) for session in sessions])


def _added_bias(sessions: Sequence[DiagnosedSession], baseline: Sequence[DiagnosedSession]) -> MeasuredValue:
    has = float(np.median([session.bias_dps for session in baseline])) if baseline else 0.0
    return _measured([session.bias_dps - has for session in sessions])


def _measured(values: Sequence[float]) -> MeasuredValue:
    return MeasuredValue(float(np.median(values)), min(values), max(values))
