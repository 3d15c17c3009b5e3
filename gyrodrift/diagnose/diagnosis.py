"""The diagnosis: from recordings and a rig to a verdict and everything that the report shows."""

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from firmware_sim.rig import Base, Rig
from gyrodrift.diagnose.baseline_comparison import (
    explained_baseline,
    with_corrected_reference,
    without_baseline,
)
from gyrodrift.diagnose.inference.baseline import against_one
from gyrodrift.diagnose.inference.detectable import detectable
from gyrodrift.diagnose.inference.halves import on_halves
from gyrodrift.diagnose.inference.verdict import Verdict, is_small, with_negligible, withdrawn
from gyrodrift.diagnose.predictive_checks.feature_comparison import feature_comparisons_of
from gyrodrift.diagnose.predictive_checks.rate_errors import rate_errors_of
from gyrodrift.diagnose.predictive_checks.yaw_impact import cost_deg, yaw_impact_of
from gyrodrift.diagnose.recording.facts import Contradiction, contradictions
from gyrodrift.diagnose.result import BaseValue, DiagnosedSession, Diagnosis
from gyrodrift.diagnose.simulate.calibration import host_delay_s, host_jitter_s
from gyrodrift.diagnose.simulate.twin import Subject
from gyrodrift.diagnose.stages import (
    YAW_IMPACT,
    DiagnosisRequest,
    adopted,
    axes_remarks,
    inferred_of,
    named_apart,
    recordings_of,
    simulated_of,
    with_facts,
    with_recorded_axes,
    with_stated_axes,
    without_columns_of_one_set,
)
from gyrodrift.diagnose.what_next import what_next
from gyrodrift.simulation.sessions import rig_yaml


def diagnose(request: DiagnosisRequest) -> Diagnosis:
    """Explain the gap between a rig and recordings.

    Raises
    ------
    DataError
        If no session can be used; the message says why for each session.
    """
    begun_s = time.monotonic()
    recordings, remarks = recordings_of(request.paths, request.progress, request.reading)
    lacking = None
    if request.baseline:
        request, lacking = without_columns_of_one_set(request, recordings)
        if lacking.of_one_set:
            recordings, remarks = recordings_of(request.paths, request.progress, request.reading)
        remarks += lacking.remarks
    base = request.rig.base
    against = contradictions(recordings, base.dps_per_lsb, base.encoder_cpr)
    stated = request.rig
    # An unstated rig has the steps of the baseline: coarser steps of the recordings are a gap.
    facts = against if request.is_rig_stated or not request.baseline else ()
    request = request._replace(rig=with_recorded_axes(with_facts(stated, facts), recordings))
    remarks += axes_remarks(stated, recordings)
    baseline: tuple[DiagnosedSession, ...] = ()
    if request.baseline:
        explained = explained_baseline(request, recordings)
        request = request._replace(rig=explained.rig, least_noise_dps_rthz=explained.least_noise_dps_rthz)
        recordings = with_corrected_reference(explained.response, recordings)
        simulated = simulated_of(request, recordings, partial(against_one, baseline=explained.baseline))
        tables = without_baseline(simulated.tables, simulated.subjects, explained.baseline)
        simulated = simulated._replace(tables=tables)
        inferred = inferred_of(simulated, request.jobs, request.progress, explained.background)
        remarks += explained.remarks
        baseline = tuple(_session(subject) for subject in explained.subjects)
    else:
        simulated = simulated_of(request, recordings)
        inferred = inferred_of(simulated, request.jobs, request.progress)
    explanation, subjects = inferred.explanation, simulated.subjects
    verdict = _with_negligible(inferred.verdict, subjects)
    untestable = named_apart(simulated.untestable, lacking)
    following = what_next(verdict, explanation, subjects, untestable, request.rig)
    designs = [subject.design for subject in subjects]
    without_causes = np.array([table.runs.mean(axis=0) for table in simulated.tables])
    request.progress(YAW_IMPACT, 0, 0)
    yaw_impact = yaw_impact_of(subjects, verdict.causes)
    if yaw_impact.is_worse_with_causes:
        verdict = withdrawn(verdict)
    result = Diagnosis(
        verdict=verdict,
        halves=on_halves(explanation),
        yaw_impact=yaw_impact,
        contradictions=against if request.is_rig_stated or not request.baseline else _of_any_rig(against),
        remarks=tuple(remarks),
        untestable=untestable,
        withheld=tuple(sorted(request.withheld)),
        detectable=detectable(explanation.scorer, explanation.evidence.effects()),
        calibration=_calibration(request.rig.base, subjects),
        next_step=following.sentence,
        next_profile_yaml=following.profile_yaml,
        seconds=0.0,
        sessions=tuple(_session(subject) for subject in subjects),
        rig_yaml=rig_yaml(with_stated_axes(_adopted(request.rig, verdict), stated)),
        posterior=explanation.posterior.probable_sets(),
        threshold_z=explanation.evidence.threshold_z,
        features=feature_comparisons_of(explanation, without_causes, designs),
        rate_errors=rate_errors_of(subjects, verdict.causes),
        baseline=baseline,
        lacking=lacking,
    )
    return replace(result, seconds=time.monotonic() - begun_s)


def _of_any_rig(against: Sequence[Contradiction]) -> tuple[Contradiction, ...]:
    """Contradictions between gyro and encoder. The rest does not count, as nobody stated the rig for this device."""
    return tuple(item for item in against if item.fact == "turn_ratio")


def _adopted(rig: Rig, verdict: Verdict) -> Rig:
    """The rig with those causes of a verdict that go into `rig.yaml`."""
    return adopted(rig, [cause for cause in verdict.causes if cause.is_adopted])


def _with_negligible(verdict: Verdict, subjects: Sequence[Subject]) -> Verdict:
    """Move small causes that hardly change yaw to `negligible`."""
    small = [cause for cause in verdict.causes if is_small(cause)]
    return with_negligible(verdict, {cause.effect.name: cost_deg(subjects, verdict.causes, cause) for cause in small})


def _session(subject: Subject) -> DiagnosedSession:
    recording, base = subject.cleaned.recording, subject.rig.base
    return DiagnosedSession(
        name=recording.name,
        minutes=recording.seconds / 60.0,
        sample_rate_hz=1.0 / recording.period_s,
        bias_dps=base.bias_dps,
        noise_dps_rthz=base.noise_dps_rthz,
        has_host_times=recording.host_s is not None,
        has_temperature=recording.temp_c is not None,
        has_counter=recording.has_counter,
    )


def _calibration(base: Base, subjects: Sequence[Subject]) -> tuple[BaseValue, ...]:
    """Base values of the rig and of the sessions to which they were calibrated."""
    return tuple(
        _base_value(name, float(getattr(base, name)), [value(subject) for subject in subjects])
        for name, value in CALIBRATED.items()
    )


def _base_value(name: str, rig: float, values: Sequence[float | None]) -> BaseValue:
    stated = [value for value in values if value is not None]
    if not stated:
        return BaseValue(name, rig, None, None, None)
    return BaseValue(name, rig, float(np.median(stated)), min(stated), max(stated))


def _of_base(name: str) -> Callable[[Subject], float]:
    return lambda subject: float(getattr(subject.rig.base, name))


CALIBRATED: dict[str, Callable[[Subject], float | None]] = {
    "sample_rate_hz": _of_base("sample_rate_hz"),
    "noise_dps_rthz": _of_base("noise_dps_rthz"),
    "bias_dps": _of_base("bias_dps"),
    "host_delay_s": lambda subject: host_delay_s(subject.cleaned.recording),
    "host_jitter_s": lambda subject: host_jitter_s(subject.cleaned.recording),
    "encoder_phase_deg": lambda subject: float(subject.posterior.mean.angle_deg[0]),
}
"""Base values that may differ from session to session, with the function that gives the value of a session; None if the
session does not show it."""
