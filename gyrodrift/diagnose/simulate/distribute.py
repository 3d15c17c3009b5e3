"""Simulations of all sessions, in processes of this machine or by workers of a cluster."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import NamedTuple

from firmware_sim.rig import Rig
from gyrodrift.diagnose.recording.checked import checked_session
from gyrodrift.diagnose.recording.recording import Recording
from gyrodrift.diagnose.recording.reference_response import ReferenceResponse
from gyrodrift.diagnose.simulate.candidate import Candidate
from gyrodrift.diagnose.simulate.candidate_kind import Hints
from gyrodrift.diagnose.simulate.candidates import candidates
from gyrodrift.diagnose.simulate.repeats import is_shared, twins_of, with_shared
from gyrodrift.diagnose.simulate.response_table import ResponseTable, SimulatedSet, Sized, key
from gyrodrift.diagnose.simulate.responses import Compared, change_in, null_runs_of, points_of, response_table, together
from gyrodrift.diagnose.simulate.twin import Subject, subject_of
from gyrodrift.io.parallel import ClusterWorkers, workers
from gyrodrift.io.progress import OnProgress
from gyrodrift.session.checks.stated import AS_WRITTEN, ReadingOptions
from gyrodrift.values.arrays import Floats
from gyrodrift.values.errors import DataError

REPLAYED = "sessions replayed"


class Origin(NamedTuple):
    """Source of a recording: file, part of its session from 0, reading options, and response of the reference.

    temp_c
        Constant temperature of a recording without one; None leaves it as it is.
    """

    path: Path
    part: int
    reading: ReadingOptions = AS_WRITTEN
    response: ReferenceResponse | None = None
    temp_c: float | None = None

    def applied(self, recording: Recording) -> Recording:
        """The recording as read, with the corrected reference and the constant temperature."""
        corrected = recording if self.response is None else self.response.applied(recording)
        return corrected if self.temp_c is None else corrected.at_temperature(self.temp_c)


@dataclass(frozen=True, slots=True, eq=False)
class SimulationPlan:
    """Plan of the simulations.

    origins, subjects
        Sources of the recordings, and the recordings with their calibrated rigs, in the same order.
    tried
        Candidates to simulate.
    least_noise_dps_rthz
        Lower bound of the calibrated noise.
    compared
        Function that subtracts a baseline from the differences of a table; None without a baseline.
    """

    origins: tuple[Origin, ...]
    subjects: tuple[Subject, ...]
    rig: Rig
    hints: Hints
    tried: tuple[Candidate, ...]
    least_noise_dps_rthz: float
    compared: Compared | None = None


def response_tables(
    plan: SimulationPlan, jobs: int, cluster: str | None, progress: OnProgress
) -> tuple[ResponseTable, ...]:
    """Response tables in the order of the sessions.

    An effect has one size in all sessions. So the first session tells which sizes are simulated in all others.

    Raises
    ------
    UsageError
        The cluster cannot be reached.
    GyrodriftError
        The cluster was lost.
    """
    if cluster is not None:
        return _on_cluster(plan, cluster, progress)
    numbers = range(len(plan.subjects))
    with workers(min(jobs, len(numbers)), plan) as local:
        progress(REPLAYED, 0, len(numbers))
        tables = [*local.map(_table, [(0, None)])]
        progress(REPLAYED, 1, len(numbers))
        for done, table in enumerate(local.map(_table, [*enumerate(_points_by_session(plan, tables[0]), 1)]), 2):
            progress(REPLAYED, done, len(numbers))
            tables.append(table)
    return with_shared(tables, twins_of(plan.subjects), plan.tried)


def _points_by_session(plan: SimulationPlan, first: ResponseTable) -> list[dict[str, int]]:
    """Number of grid points to simulate in each session but the first, by key of the candidate."""
    shared = {key(candidate) for candidate in plan.tried if is_shared(candidate)}
    points = points_of(first)
    own = {name: 0 if name in shared else count for name, count in points.items()}
    return [own if twins else points for twins in twins_of(plan.subjects)[1:]]


def _table(plan: SimulationPlan, session: tuple[int, Mapping[str, int] | None]) -> ResponseTable:
    """Simulate a session, by its index, at some grid points."""
    index, points = session
    return response_table(plan.subjects[index], plan.tried, null_runs_of(len(plan.subjects)), points, plan.compared)


def _on_cluster(plan: SimulationPlan, address: str, progress: OnProgress) -> tuple[ResponseTable, ...]:
    origins = [origin._replace(path=origin.path.resolve()) for origin in plan.origins]
    simulate = partial(
        read_and_simulate,
        rig=plan.rig,
        hints=plan.hints,
        names=frozenset(candidate.name for candidate in plan.tried),
        null_runs=null_runs_of(len(origins)),
        least_noise_dps_rthz=plan.least_noise_dps_rthz,
        compared=plan.compared,
    )
    with closing(ClusterWorkers(address, "a diagnosis")) as shared:
        progress(REPLAYED, 0, len(origins))
        tables: list[ResponseTable] = shared.results(shared.submit(simulate, origins[:1]))
        progress(REPLAYED, 1, len(origins))
        sent = [*zip(origins[1:], _points_by_session(plan, tables[0]), strict=True)]
        if sent:
            tables += shared.results(shared.submit(partial(_simulated_from, simulate), sent))
        progress(REPLAYED, len(origins), len(origins))
    return with_shared(tables, twins_of(plan.subjects), plan.tried)


def _simulated_from(simulate: Callable[..., ResponseTable], sent: tuple[Origin, Mapping[str, int]]) -> ResponseTable:
    """Simulate a session, by its origin, at some grid points."""
    origin, points = sent
    return simulate(origin, points=points)


def read_and_simulate(
    origin: Origin,
    rig: Rig,
    hints: Hints,
    names: frozenset[str],
    null_runs: int,
    least_noise_dps_rthz: float,
    points: Mapping[str, int] | None = None,
    compared: Compared | None = None,
) -> ResponseTable:
    """Read and simulate a session on a worker of a cluster, which needs access to the same path.

    points, compared
        As in `response_table`.

    Raises
    ------
    DataError
        The session cannot be read, or does not pass the checks any more.
    """
    recordings = checked_session(origin.path, origin.reading).recordings
    if origin.part >= len(recordings):
        raise DataError(f"{origin.path}: changed while it was being diagnosed")
    tried = [candidate for candidate in candidates(hints, rig) if candidate.name in names]
    subject = subject_of(origin.applied(recordings[origin.part]), rig, least_noise_dps_rthz)
    return response_table(subject, tried, null_runs, points, compared)


class _Sessions(NamedTuple):
    """Sessions in which sets are simulated, and candidates by key, since functions cannot be sent to processes."""

    subjects: Sequence[Subject]
    tables: Sequence[ResponseTable]
    candidates: dict[str, Candidate]


_Sent = tuple[list[tuple[str, float, Floats | None]], int]
"""Key, size and phases of each candidate of a set, and the session in which it is simulated."""


@contextmanager
def set_simulator(
    subjects: Sequence[Subject], tables: Sequence[ResponseTable], tried: Sequence[Candidate], jobs: int
) -> Iterator[Callable[[Sequence[Sized]], SimulatedSet]]:
    """Simulate whole sets of candidates in all sessions at once, by up to `jobs` processes."""
    sessions = _Sessions(subjects, tables, {key(candidate): candidate for candidate in tried})
    with workers(min(jobs, len(subjects)), sessions) as local:

        def simulate(effects: Sequence[Sized]) -> SimulatedSet:
            sent = [(key(effect.candidate), effect.size, effect.phases_deg) for effect in effects]
            return together([*local.map(_change_of_sent, [(sent, index) for index in range(len(subjects))])])

        yield simulate


def _change_of_sent(sessions: _Sessions, sent: _Sent) -> SimulatedSet:
    """Simulate a set in one session, in a process that got the set as keys."""
    keys_and_sizes, index = sent
    effects = [Sized(sessions.candidates[name], size, phases_deg) for name, size, phases_deg in keys_and_sizes]
    return change_in(effects, index, sessions.subjects[index], sessions.tables[index])
