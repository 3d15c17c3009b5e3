"""The result of a diagnosis: everything that its files hold and its report draws."""

from dataclasses import dataclass, field
from typing import Any

from gyrodrift.diagnose.inference.detectable import Detectable
from gyrodrift.diagnose.inference.halves import Halves
from gyrodrift.diagnose.inference.posterior import ProbableSet
from gyrodrift.diagnose.inference.verdict import Verdict
from gyrodrift.diagnose.predictive_checks.feature_comparison import FeatureComparison
from gyrodrift.diagnose.predictive_checks.rate_errors import RateErrors
from gyrodrift.diagnose.predictive_checks.yaw_impact import YawImpact
from gyrodrift.diagnose.recording.facts import Contradiction
from gyrodrift.diagnose.recording.lacking import LackingValues
from gyrodrift.io.result_table import ResultTable


@dataclass(frozen=True, slots=True)
class DiagnosedSession:
    """A session that was used, and the rig's base values that were fitted to it."""

    name: str
    minutes: float
    sample_rate_hz: float
    bias_dps: float
    noise_dps_rthz: float
    has_host_times: bool
    has_temperature: bool
    has_counter: bool


@dataclass(frozen=True, slots=True)
class BaseValue:
    """A base value of the rig, and the median, smallest and largest value of the sessions; None if they show none."""

    name: str
    rig: float
    data: float | None
    low: float | None
    high: float | None


@dataclass(frozen=True, slots=True)
class Untestable:
    """An effect that the sessions cannot show, and what they, or only the baseline, lack."""

    effect: str
    why: str
    is_of_baseline: bool = False


@dataclass(frozen=True, slots=True, repr=False)
class Diagnosis(ResultTable):
    """Everything that is reported.

    contradictions
        Facts of the rig that the sessions contradict; the report begins with them.
    remarks
        Sentences on results of the recording checks and on limits of this result.
    withheld
        Names of the effects that were not tried.
    detectable
        Smallest size of each tried effect that these sessions would have shown.
    calibration
        Base values of the rig and of the sessions.
    next_step, next_profile_yaml
        What to record next, in a sentence; and the profile of a motion that separates open hypotheses, if there is one.
    seconds
        Duration of the diagnosis.
    rig_yaml
        The rig with the causes switched on at their fitted sizes, as a file for `simulate` and `firmware_sim`.
    posterior
        The sets of effects that have 0.95 of the probability together, the most probable first.
    threshold_z
        Pooled z beyond which a feature deviates.
    features
        Features of recordings and simulator, in the order of FEATURES.
    rate_errors
        Rate errors of some sessions, recorded and simulated.
    baseline
        Sessions of the baseline, calibrated like the sessions.
    lacking
        Values that the sessions or the baseline lack; None without a baseline.
    halves
        Whether both halves of the sessions give the same verdict; None with fewer than four sessions.
    """

    verdict: Verdict
    yaw_impact: YawImpact
    contradictions: tuple[Contradiction, ...]
    remarks: tuple[str, ...]
    untestable: tuple[Untestable, ...]
    withheld: tuple[str, ...]
    detectable: tuple[Detectable, ...]
    calibration: tuple[BaseValue, ...]
    next_step: str
    next_profile_yaml: str | None
    seconds: float
    sessions: tuple[DiagnosedSession, ...]
    rig_yaml: str
    posterior: tuple[ProbableSet, ...]
    threshold_z: float
    features: tuple[FeatureComparison, ...] = field(repr=False)
    rate_errors: RateErrors = field(repr=False)
    baseline: tuple[DiagnosedSession, ...] = field(default=(), repr=False)
    lacking: LackingValues | None = None
    halves: Halves | None = None

    def __repr__(self) -> str:
        names = ", ".join(cause.effect.name for cause in self.verdict.causes)
        return f"Diagnosis({self.verdict.kind.value}{f': {names}' if names else ''}, {len(self.sessions)} sessions)"

    def columns(self) -> dict[str, list[Any]]:
        """Parameters of the causes: effect, probability, parameter, value with its interval, unit."""
        rows = [(cause, parameter) for cause in self.verdict.causes for parameter in cause.parameters]
        return {
            "effect": [cause.effect.name for cause, _ in rows],
            "probability": [cause.probability for cause, _ in rows],
            "parameter": [parameter.name for _, parameter in rows],
            "value": [parameter.value for _, parameter in rows],
            "low": [parameter.low for _, parameter in rows],
            "high": [parameter.high for _, parameter in rows],
            "unit": [parameter.unit for _, parameter in rows],
        }
