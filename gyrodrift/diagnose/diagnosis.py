"""The whole of it: sessions and a rig in, a verdict out."""

import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np

from firmware_sim.measure import COUNTS_MOST
from firmware_sim.rig import Base, Rig
from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.vector import measure
from gyrodrift.diagnose.inference.evidence import evidence_of
from gyrodrift.diagnose.inference.linear_model import SecondOpinion, second_opinion
from gyrodrift.diagnose.inference.search import Attribution, Cause, Found
from gyrodrift.diagnose.inference.verdict import Verdict, detectable, verdict_of
from gyrodrift.diagnose.inference.yaw_impact import Worth, worth_of
from gyrodrift.diagnose.recording.recording import Recording
from gyrodrift.diagnose.simulate.candidate import Candidate
from gyrodrift.diagnose.simulate.candidates import KINDS, candidates
from gyrodrift.diagnose.simulate.distribute import SimulationPlan, checked_recording, response_tables
from gyrodrift.diagnose.simulate.hints import hints_of
from gyrodrift.diagnose.simulate.responses import ResponseTable
from gyrodrift.diagnose.simulate.twin import Subject, subject_of
from gyrodrift.errors import DataError

RUNS_OF_CHANCE = 4
"""Realisations of an effect in which chance plays a part."""


@dataclass(frozen=True, slots=True, eq=False)
class Drawn:
    """What the report draws from: sessions and their tables in the same order, the search over causes and its end."""

    subjects: tuple[Subject, ...]
    tables: tuple[ResponseTable, ...]
    attribution: Attribution
    found: Found
    withheld: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Diagnosis:
    """Everything that is reported."""

    verdict: Verdict
    second: SecondOpinion
    worth: Worth
    remarks: tuple[str, ...]
    untestable: dict[str, str]
    detectable: dict[str, dict[str, float | str]]
    calibration: dict[str, dict[str, float]]
    next: str
    seconds: float
    sessions: tuple[str, ...]
    rig: Rig
    drawn: Drawn = field(repr=False)


class DiagnosisRequest(NamedTuple):
    """What is to be diagnosed."""

    paths: Sequence[Path]
    rig: Rig
    withheld: frozenset[str]
    jobs: int
    cluster: str | None
    progress: Callable[[str, int, int], None]


def diagnose(asked: DiagnosisRequest) -> Diagnosis:
    """Explain the gap between a rig and recordings.

    Raises
    ------
    DataError
        Where no session can be used, with what is wrong with each.
    """
    begun_s = time.monotonic()
    paths, recordings, remarks = _recordings(asked.paths)
    remarks += _beyond_the_rig(recordings, asked.rig.base)
    subjects = [subject_of(recording, asked.rig) for recording in recordings]
    hints = hints_of(subjects)
    tried, untestable = _testable(candidates(hints), recordings, asked.withheld)
    plan = SimulationPlan(tuple(paths), tuple(subjects), asked.rig, hints, tuple(tried))
    tables = response_tables(plan, asked.jobs, asked.cluster, asked.progress)
    evidence = evidence_of(tables, tried)
    attribution = Attribution(evidence, lambda causes: _simulated(causes, subjects, tables))
    found = attribution.search()
    verdict = verdict_of(attribution, found)
    worth = worth_of(subjects, tuple(cause.effect for cause in verdict.causes))
    if len(recordings) == 1:
        remarks.append(
            "one session only: nothing could be kept apart from the fit, so that all of this is its own judge"
        )
    return Diagnosis(
        verdict=verdict,
        second=second_opinion(subjects, verdict),
        worth=worth,
        remarks=tuple(remarks),
        untestable=untestable,
        detectable=detectable(attribution),
        calibration=_calibration(asked.rig.base, subjects),
        next=_next(verdict, untestable, recordings),
        seconds=time.monotonic() - begun_s,
        sessions=tuple(recording.name for recording in recordings),
        rig=asked.rig.model_copy(update={"effects": (*asked.rig.effects, *(cause.effect for cause in verdict.causes))}),
        drawn=Drawn(tuple(subjects), tables, attribution, found, tuple(sorted(asked.withheld))),
    )


def _recordings(asked: Iterable[Path]) -> tuple[list[Path], list[Recording], list[str]]:
    """Those that came through the gates, with their paths, and what is to be said of all."""
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


def _beyond_the_rig(recordings: Sequence[Recording], base: Base) -> list[str]:
    """Rates that the rig cannot put out: its own would be clipped."""
    most_dps = COUNTS_MOST * base.dps_per_lsb
    largest_dps = max(float(np.nanmax(np.abs(recording.rate_dps))) for recording in recordings)
    if largest_dps <= most_dps:
        return []
    holds = f"16 bits of {base.dps_per_lsb:g} deg/s hold {most_dps:.3g} deg/s"
    return [f"the sessions reach {largest_dps:.3g} deg/s, and {holds}: is the rig's dps_per_lsb right?"]


def _testable(
    every: Sequence[Candidate], recordings: Sequence[Recording], withheld: frozenset[str]
) -> tuple[list[Candidate], dict[str, str]]:
    """Candidates that the recordings can speak of; those they cannot, with why."""
    lacking = {
        "motion": ("no motion", not any(recording.moves for recording in recordings)),
        "host": ("no host times", any(recording.host_s is None for recording in recordings)),
        "temperature": ("no temperature", any(recording.temp_c is None for recording in recordings)),
        "counter": ("no counter", not all(recording.has_counter for recording in recordings)),
    }
    untestable = {
        candidate.name: lacking[need][0] for candidate in every for need in candidate.needs if lacking[need][1]
    }
    tried = [c for c in every if c.name not in untestable and c.name not in withheld]
    return tried, untestable


def _simulated(causes: Sequence[Cause], subjects: Sequence[Subject], tables: Sequence[ResponseTable]) -> Floats:
    """(sessions, F) what a whole set of causes does to the features."""
    effects = tuple(cause.answer.candidate.make(cause.size) for cause in causes if not cause.is_strange)
    share = float(np.prod([cause.answer.candidate.noise_share for cause in causes]))
    runs = 1 if all(cause.answer.candidate.realisations == 1 for cause in causes) else RUNS_OF_CHANCE

    def played(subject: Subject, seed: int) -> Floats:
        seen = subject.with_noise(share).replayed(effects, seed)
        for cause in causes:
            if cause.answer.candidate.shape is not None:
                seen = subject.with_shape(cause.answer.candidate.shape, cause.size, seed, seen)
        return measure(seen, subject.design, subject.facts).values

    changes = [
        np.mean([played(subject, seed) - table.runs[seed] for seed in range(runs)], axis=0)
        for subject, table in zip(subjects, tables, strict=True)
    ]
    return np.array(changes)


def _calibration(base: Base, subjects: Sequence[Subject]) -> dict[str, dict[str, float]]:
    """Base values of the rig beside those of the data: middle over sessions, and least and most."""
    found = {}
    for name in ("sample_rate_hz", "noise_dps_rthz", "bias_dps"):
        values = [float(getattr(subject.rig.base, name)) for subject in subjects]
        middle = float(np.median(values))
        found[name] = {"rig": float(getattr(base, name)), "data": middle, "low": min(values), "high": max(values)}
    return found


def _next(verdict: Verdict, untestable: dict[str, str], recordings: Sequence[Recording]) -> str:
    """One sentence."""
    tied = [cause for cause in verdict.causes if cause.tied_with]
    if tied:
        names = ", ".join([tied[0].effect.name, *tied[0].tied_with])
        return f"To tell {names} apart, {KINDS[tied[0].effect.name].looks_like.separated_by}."
    if len(recordings) < ENOUGH_SESSIONS:
        return "Record more sessions: with three and more the fit can be checked on what it has not seen."
    if untestable:
        name, why = next(iter(untestable.items()))
        return f"Record with a device that sends more: {why} in these sessions, so that {name} cannot be tested."
    if verdict.leftover:
        odd = verdict.leftover[0]
        return f"Record more of what is left over ({odd.regime}: {odd.says}), at several speeds and temperatures."
    return "These sessions separate what they show; record again after the next change of the rig."


ENOUGH_SESSIONS = 3
