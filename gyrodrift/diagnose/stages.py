"""Stages of a diagnosis: load and check recordings, simulate them, infer causes, and put the causes into the rig."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from firmware_sim.rig import Rig, with_axes
from gyrodrift.diagnose.inference.conclusion import Conclusion, conclude
from gyrodrift.diagnose.inference.verdict import NamedCause
from gyrodrift.diagnose.recording.checked import checked_session
from gyrodrift.diagnose.recording.checks import together_s
from gyrodrift.diagnose.recording.facts import Contradiction
from gyrodrift.diagnose.recording.gravity import shows_gravity
from gyrodrift.diagnose.recording.lacking import LackingValues, lacking_values
from gyrodrift.diagnose.recording.recording import Recording
from gyrodrift.diagnose.result import Untestable
from gyrodrift.diagnose.simulate.candidate import Candidate, Need
from gyrodrift.diagnose.simulate.candidates import KINDS, candidates
from gyrodrift.diagnose.simulate.distribute import REPLAYED, SimulationPlan, response_tables, set_simulator
from gyrodrift.diagnose.simulate.hints import hints_of
from gyrodrift.diagnose.simulate.response_table import ResponseTable, Sized
from gyrodrift.diagnose.simulate.responses import Compared, plausible
from gyrodrift.diagnose.simulate.twin import Subject, subject_of
from gyrodrift.io.progress import OnProgress, ignore_progress
from gyrodrift.session.checks.stated import AS_WRITTEN, ReadingOptions
from gyrodrift.values.errors import DataError

CORRECTED: dict[str, Callable[[float], float | int]] = {"encoder_cpr": round, "dps_per_lsb": float}
"""Facts of the rig that are replaced if the sessions contradict them, with the type of their values."""


CHECKED, CALIBRATED, SEARCHED = "sessions checked", "rig calibrated to sessions", "search for causes"
YAW_IMPACT, REPORT = "yaw errors and tuning", "report"
"""Stages, as the progress names them."""

SHARES = {CHECKED: 2.0, CALIBRATED: 5.0, REPLAYED: 50.0, SEARCHED: 8.0, YAW_IMPACT: 2.0, REPORT: 3.0}
"""Share of each stage in the duration. Measured on 3 sessions of 5 minutes with 2 processes."""


class DiagnosisRequest(NamedTuple):
    """The input of a diagnosis.

    withheld
        Effects that are not tried.
    baseline
        Earlier recordings of the device: a difference that they show, too, is no gap.
    least_noise_dps_rthz
        Least noise that the rig is calibrated to.
    reading, baseline_reading
        Columns and units as stated by a person, of the sessions and of the baseline.
    is_rig_stated
        Whether a person states the rig. Otherwise facts of a baseline replace its facts, without a warning.
    """

    paths: Sequence[Path]
    rig: Rig
    withheld: frozenset[str]
    jobs: int
    progress: OnProgress
    baseline: Sequence[Path] = ()
    least_noise_dps_rthz: float = 0.0
    reading: ReadingOptions = AS_WRITTEN
    baseline_reading: ReadingOptions = AS_WRITTEN
    is_rig_stated: bool = True


class Simulated(NamedTuple):
    """The simulations of all sessions.

    subjects, tables
        Calibrated sessions, and their response tables.
    tried
        Candidates that the sessions can show, and that are not withheld.
    untestable
        Effects that the sessions cannot show.
    unseparated
        Untestable effects that act like a tested effect in these sessions, and that are not withheld.
    """

    subjects: list[Subject]
    tables: tuple[ResponseTable, ...]
    tried: list[Candidate]
    untestable: tuple[Untestable, ...]
    unseparated: tuple[str, ...] = ()


def simulated_of(
    request: DiagnosisRequest, recordings: Sequence[Recording], compared: Compared | None = None
) -> Simulated:
    """Calibrate the rig to each session, and compute the responses of all candidates in each.

    compared
        Function that subtracts a baseline from the differences of a table.
    """
    subjects = []
    for done, recording in enumerate(recordings):
        request.progress(CALIBRATED, done, len(recordings))
        subjects.append(subject_of(recording, request.rig, request.least_noise_dps_rthz))
    hints = hints_of(subjects)
    has_axes = request.rig.base.three_axes is not None
    tried, untestable = testable_among(candidates(hints, request.rig), recordings, request.withheld, has_axes=has_axes)
    untested = [item.effect for item in untestable if item.effect not in request.withheld]
    unseparated = tuple(name for name in untested if KINDS[name].acts_like is not None)
    tables = response_tables(SimulationPlan(tuple(subjects), tuple(tried), compared), request.jobs, request.progress)
    return Simulated(subjects, tables, plausible(tried, tables), untestable, unseparated)


def inferred_of(
    simulated: Simulated, jobs: int, progress: OnProgress = ignore_progress, background: Sequence[Sized] = ()
) -> Conclusion:
    """Find the posterior over sets of effects, and the verdict; `background` are random effects that act anyway."""
    progress(SEARCHED, 0, 0)
    with set_simulator(simulated.subjects, simulated.tables, simulated.tried, jobs) as simulate:
        return conclude(simulated.tables, simulated.tried, simulate, simulated.unseparated, background)


def recordings_of(
    paths: Sequence[Path], progress: OnProgress = ignore_progress, reading: ReadingOptions = AS_WRITTEN
) -> tuple[list[Recording], list[str]]:
    """Recordings that passed the checks, with remarks."""
    recordings: list[Recording] = []
    remarks: list[str] = []
    for done, path in enumerate(paths):
        progress(CHECKED, done, len(paths))
        session = checked_session(path, reading)
        remarks += session.remarks
        recordings += session.recordings
    if not recordings:
        raise DataError("; ".join(remarks))
    together_s(recordings)
    if len(recordings) == 1:
        remarks.append("one session only: nothing could be held out, so the fit is not checked")
    return recordings, remarks


def without_columns_of_one_set(
    request: DiagnosisRequest, recordings: Sequence[Recording]
) -> tuple[DiagnosisRequest, LackingValues]:
    """The request that reads no column that only the sessions or only the baseline have.

    Raises
    ------
    DataError
        No recording of the baseline can be used.
    """
    of_baseline, _ = recordings_of(request.baseline, request.progress, request.baseline_reading)
    lacking = lacking_values(recordings, of_baseline)
    reading = replace(request.reading, without=lacking.of_one_set)
    baseline_reading = replace(request.baseline_reading, without=lacking.of_one_set)
    return request._replace(reading=reading, baseline_reading=baseline_reading), lacking


WITHOUT_AXES = "no rates about x and y"


def lacking_for(recordings: Sequence[Recording]) -> dict[Need, tuple[str, bool]]:
    """Data that effects need: the words for their absence, and whether some recording lacks them."""
    return {
        Need.MOTION: ("no motion", not any(recording.has_motion for recording in recordings)),
        Need.HOST: ("no host times", any(recording.host_s is None for recording in recordings)),
        Need.TEMPERATURE: ("no temperature", any(recording.temp_c is None for recording in recordings)),
        Need.AXES: (WITHOUT_AXES, any(recording.gyro_xy_dps is None for recording in recordings)),
        Need.COUNTER: ("no counter", not all(recording.counts_samples for recording in recordings)),
    }


def testable_among(
    every: Sequence[Candidate], recordings: Sequence[Recording], withheld: frozenset[str], *, has_axes: bool
) -> tuple[list[Candidate], tuple[Untestable, ...]]:
    """Candidates that the recordings can show, and effects that they cannot show with the reason.

    has_axes
        Whether three axes are compared.
    """
    lacking = {**lacking_for(recordings), Need.AXES: (WITHOUT_AXES, not has_axes)}
    why = {candidate.name: lacking[need][0] for candidate in every for need in candidate.needs if lacking[need][1]}
    tried = [c for c in every if c.name not in why and c.name not in withheld]
    return tried, tuple(Untestable(name, reason) for name, reason in why.items())


def named_apart(untestable: Sequence[Untestable], lacking: LackingValues | None) -> tuple[Untestable, ...]:
    """Untestable effects; where only the baseline lacks a column, its name says so."""
    if lacking is None:
        return tuple(untestable)
    return tuple(
        replace(item, is_of_baseline=True) if lacking.lacks_in_baseline(item.why.removeprefix("no ")) else item
        for item in untestable
    )


def adopted(rig: Rig, causes: Sequence[NamedCause]) -> Rig:
    """The rig with the causes. An effect that the rig has with another size is replaced, or removed if it is gone."""
    names = {cause.effect.name for cause in causes}
    kept = tuple(effect for effect in rig.effects if effect.name not in names)
    new = tuple(cause.effect for cause in causes if not _is_gone(cause))
    return rig.model_copy(update={"effects": (*kept, *new)})


def _is_gone(cause: NamedCause) -> bool:
    """Whether an effect of the rig is gone: the recordings show less than a tenth of it."""
    if cause.in_rig is None or KINDS[cause.effect.name].less_is_more:
        return False
    name = cause.cause.candidate.parameter
    return abs(float(getattr(cause.effect, name))) < 0.1 * abs(float(getattr(cause.in_rig, name)))


def with_recorded_axes(rig: Rig, recordings: Sequence[Recording]) -> Rig:
    """The rig with three axes if all recordings have them, else with a single axis.

    It has no accelerometer if a recording shows no gravity.
    """
    if any(recording.gyro_xy_dps is None for recording in recordings):
        return with_axes(rig, 1)
    rig = with_axes(rig, 3)
    if all(map(shows_gravity, recordings)) or rig.base.three_axes is None:
        return rig
    axes = rig.base.three_axes.model_copy(update={"mps2_per_lsb": 0.0})
    return rig.model_copy(update={"base": rig.base.model_copy(update={"three_axes": axes})})


def axes_remarks(stated: Rig, recordings: Sequence[Recording]) -> list[str]:
    """A sentence if recordings and rig differ in their axes, or if only some recordings have three axes."""
    with_three = sum(recording.gyro_xy_dps is not None for recording in recordings)
    has_three = stated.base.three_axes is not None
    if with_three == len(recordings):
        return [] if has_three else ["the recordings have three axes, and the rig has one: three are simulated"]
    if with_three:
        return [f"only {with_three} of {len(recordings)} recordings have three axes: the yaw rate alone is compared"]
    return ["the rig has three axes, and the recordings have one: the yaw rate alone is compared"] if has_three else []


def with_stated_axes(rig: Rig, stated: Rig) -> Rig:
    """The rig with the axes of the stated rig, if that has three."""
    if stated.base.three_axes is None:
        return rig
    return rig.model_copy(update={"base": rig.base.model_copy(update={"three_axes": stated.base.three_axes})})


def with_facts(rig: Rig, against: Sequence[Contradiction]) -> Rig:
    """The rig with those facts of the sessions that contradict it."""
    shown = {
        contradiction.fact: contradiction.sessions
        for contradiction in against
        if contradiction.sessions and contradiction.fact in CORRECTED
    }
    update = {name: CORRECTED[name](value) for name, value in shown.items()}
    return rig.model_copy(update={"base": rig.base.model_copy(update=update)})
