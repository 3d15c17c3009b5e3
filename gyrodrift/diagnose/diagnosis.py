"""The whole of it: sessions and a rig in, a verdict with all that it rests on out."""

import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from firmware_sim.measure import COUNTS_MOST
from firmware_sim.rig import Base, Rig
from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.block_residuals import block_residual_dps
from gyrodrift.diagnose.inference.alternatives import alternatives_of
from gyrodrift.diagnose.inference.detectable import detectable
from gyrodrift.diagnose.inference.linear_model import linear_model_of
from gyrodrift.diagnose.inference.pooling import evidence_of
from gyrodrift.diagnose.inference.ranking import lookalikes, ranking
from gyrodrift.diagnose.inference.search import search
from gyrodrift.diagnose.inference.surrogate import Cause, Surrogate
from gyrodrift.diagnose.inference.verdict import Verdict, verdict_of
from gyrodrift.diagnose.predictive_checks.feature_comparison import feature_comparisons_of
from gyrodrift.diagnose.predictive_checks.residual_checks import residual_checks_of
from gyrodrift.diagnose.predictive_checks.yaw_impact import yaw_impact_of
from gyrodrift.diagnose.recording.recording import Recording
from gyrodrift.diagnose.result import BaseValue, DiagnosedSession, Diagnosis, Untestable
from gyrodrift.diagnose.simulate.candidate import Candidate
from gyrodrift.diagnose.simulate.candidates import KINDS, candidates
from gyrodrift.diagnose.simulate.distribute import SimulationPlan, checked_recording, response_tables
from gyrodrift.diagnose.simulate.hints import hints_of
from gyrodrift.diagnose.simulate.response_table import ResponseTable
from gyrodrift.diagnose.simulate.twin import Subject, subject_of
from gyrodrift.diagnose.simulate.whole_set import change_of
from gyrodrift.errors import DataError
from gyrodrift.simulation.sessions import rig_yaml

ENOUGH_SESSIONS = 3
"""With two, sizes are fitted on one alone."""


class DiagnosisRequest(NamedTuple):
    """What is to be diagnosed."""

    paths: Sequence[Path]
    rig: Rig
    withheld: frozenset[str]
    jobs: int
    cluster: str | None
    progress: Callable[[str, int, int], None]


class Simulated(NamedTuple):
    """Everything that the sessions and the rig give to go on.

    tried
        Candidates of which the sessions can speak, and that are not withheld.
    """

    subjects: list[Subject]
    tables: tuple[ResponseTable, ...]
    tried: list[Candidate]
    untestable: tuple[Untestable, ...]


class Inferred(NamedTuple):
    """What follows from that, and the surrogate with all that was simulated on the way."""

    verdict: Verdict
    causes: tuple[Cause, ...]
    surrogate: Surrogate


def diagnose(asked: DiagnosisRequest) -> Diagnosis:
    """Explain the gap between a rig and recordings.

    Raises
    ------
    DataError
        Where no session can be used, with what is wrong with each.
    """
    begun_s = time.monotonic()
    paths, recordings, remarks = _recordings(asked.paths)
    remarks += _limits(recordings, asked.rig.base)
    simulated = _simulated(asked, paths, recordings)
    inferred = _inferred(simulated)
    verdict, surrogate, subjects = inferred.verdict, inferred.surrogate, simulated.subjects
    effects = tuple(cause.effect for cause in verdict.causes)
    designs = [subject.design for subject in subjects]
    residuals_dps = [block_residual_dps(subject.seen, subject.design) for subject in subjects]
    without_causes = np.array([table.runs.mean(axis=0) for table in simulated.tables])
    result = Diagnosis(
        verdict=verdict,
        linear_model=linear_model_of(residuals_dps, designs, verdict.causes),
        yaw_impact=yaw_impact_of(subjects, effects),
        remarks=tuple(remarks),
        untestable=simulated.untestable,
        withheld=tuple(sorted(asked.withheld)),
        detectable=detectable(surrogate.evidence),
        calibration=_calibration(asked.rig.base, subjects),
        next_step=_next(verdict, simulated.untestable, recordings),
        seconds=0.0,
        sessions=tuple(_session(subject) for subject in subjects),
        rig_yaml=rig_yaml(asked.rig.model_copy(update={"effects": (*asked.rig.effects, *effects)})),
        ranking=ranking(surrogate, inferred.causes),
        lookalikes=lookalikes(surrogate.evidence),
        features=feature_comparisons_of(surrogate, inferred.causes, without_causes, designs),
        residuals=residual_checks_of(subjects, verdict.causes),
    )
    return replace(result, seconds=time.monotonic() - begun_s)


def _simulated(asked: DiagnosisRequest, paths: Sequence[Path], recordings: Sequence[Recording]) -> Simulated:
    """Calibrate the rig to each session, and work out the responses of all candidates in each."""
    subjects = [subject_of(recording, asked.rig) for recording in recordings]
    hints = hints_of(subjects)
    tried, untestable = _testable(candidates(hints), recordings, asked.withheld)
    plan = SimulationPlan(tuple(paths), tuple(subjects), asked.rig, hints, tuple(tried))
    tables = response_tables(plan, asked.jobs, asked.cluster, asked.progress)
    return Simulated(subjects, tables, tried, untestable)


def _inferred(simulated: Simulated) -> Inferred:
    """Search for causes, see what else there is to each, and judge."""

    def simulate(causes: Sequence[Cause]) -> Floats:
        sized = [(cause.candidate, cause.size) for cause in causes]
        return change_of(sized, simulated.subjects, simulated.tables)

    result = search(evidence_of(simulated.tables, simulated.tried), simulate)
    alternatives, surrogate = alternatives_of(result, simulate)
    return Inferred(verdict_of(result, alternatives), result.found.causes, surrogate)


def _recordings(asked: Iterable[Path]) -> tuple[list[Path], list[Recording], list[str]]:
    """Those that passed the recording checks, with their paths, and what is to be said of all."""
    paths: list[Path] = []
    recordings: list[Recording] = []
    remarks: list[str] = []
    for path in asked:
        one = checked_recording(path)
        remarks += one.remarks
        if one.recording is not None:
            paths.append(path)
            recordings.append(one.recording)
    if not recordings:
        raise DataError("; ".join(remarks))
    return paths, recordings, remarks


def _limits(recordings: Sequence[Recording], base: Base) -> list[str]:
    """What cannot be right or cannot be checked: rates that the rig would clip, a fit that nothing was held out of."""
    remarks = []
    most_dps = COUNTS_MOST * base.dps_per_lsb
    largest_dps = max(float(np.nanmax(np.abs(recording.rate_dps))) for recording in recordings)
    if largest_dps > most_dps:
        holds = f"16 bits of {base.dps_per_lsb:g} deg/s hold {most_dps:.3g} deg/s"
        remarks.append(f"the sessions reach {largest_dps:.3g} deg/s, and {holds}: is the rig's dps_per_lsb right?")
    if len(recordings) == 1:
        remarks.append("one session only: nothing could be held out from the fit, so that all of this is its own judge")
    return remarks


def _testable(
    every: Sequence[Candidate], recordings: Sequence[Recording], withheld: frozenset[str]
) -> tuple[list[Candidate], tuple[Untestable, ...]]:
    """Candidates that the recordings can speak of; those they cannot, with why."""
    lacking = {
        "motion": ("no motion", not any(recording.moves for recording in recordings)),
        "host": ("no host times", any(recording.host_s is None for recording in recordings)),
        "temperature": ("no temperature", any(recording.temp_c is None for recording in recordings)),
        "counter": ("no counter", not all(recording.has_counter for recording in recordings)),
    }
    why = {candidate.name: lacking[need][0] for candidate in every for need in candidate.needs if lacking[need][1]}
    tried = [c for c in every if c.name not in why and c.name not in withheld]
    return tried, tuple(Untestable(name, reason) for name, reason in why.items())


def _session(subject: Subject) -> DiagnosedSession:
    recording, base = subject.seen.recording, subject.rig.base
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
    """What is fitted to each session before anything is compared."""
    found = []
    for name in ("sample_rate_hz", "noise_dps_rthz", "bias_dps"):
        values = [float(getattr(subject.rig.base, name)) for subject in subjects]
        found.append(BaseValue(name, getattr(base, name), float(np.median(values)), min(values), max(values)))
    return tuple(found)


def _next(verdict: Verdict, untestable: Sequence[Untestable], recordings: Sequence[Recording]) -> str:
    """One sentence."""
    tied = [cause for cause in verdict.causes if cause.tied_with]
    if tied:
        names = ", ".join([tied[0].effect.name, *tied[0].tied_with])
        return f"To tell {names} apart, {KINDS[tied[0].effect.name].looks_like.separated_by}."
    if len(recordings) < ENOUGH_SESSIONS:
        return "Record more sessions: with three and more the fit can be checked on what it has not seen."
    if untestable:
        lacking = untestable[0]
        return (
            f"Record with a device that sends more: {lacking.why} in these sessions, so that {lacking.effect} cannot "
            "be tested."
        )
    if verdict.unexplained:
        worst = verdict.unexplained[0]
        return f"Record more of what is left over ({worst.regime}: {worst.says}), at several speeds and temperatures."
    return "These sessions separate what they show; record again after the next change of the rig."
