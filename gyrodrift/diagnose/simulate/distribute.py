"""The response tables of all sessions: simulated here, in processes of this machine, or by the workers of a cluster."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from firmware_sim.rig import Rig
from gyrodrift.cluster import ClusterWorkers
from gyrodrift.diagnose.recording.checked import checked_session
from gyrodrift.diagnose.simulate.candidate import Candidate, Hints
from gyrodrift.diagnose.simulate.candidates import candidates
from gyrodrift.diagnose.simulate.response_table import ResponseTable
from gyrodrift.diagnose.simulate.responses import null_runs_of, response_table
from gyrodrift.diagnose.simulate.twin import Subject, subject_of
from gyrodrift.errors import DataError
from gyrodrift.parallel import fork_pool, usable_jobs
from gyrodrift.progress import OnProgress
from gyrodrift.session.checks.stated import AS_WRITTEN, ReadingOptions

REPLAYED = "sessions replayed"


class Origin(NamedTuple):
    """Where a recording comes from: a session, which of its parts it is, from 0, and how its table was read."""

    path: Path
    part: int
    reading: ReadingOptions = AS_WRITTEN


@dataclass(frozen=True, slots=True, eq=False)
class SimulationPlan:
    """What is to be simulated: recordings, loaded, checked and cleaned, with their origins in the same order.

    tried
        Of the candidates that the hints give, those that are to be simulated.
    least_noise_dps_rthz
        Less noise than that no recording of this device has.
    """

    origins: tuple[Origin, ...]
    subjects: tuple[Subject, ...]
    rig: Rig
    hints: Hints
    tried: tuple[Candidate, ...]
    least_noise_dps_rthz: float


class SessionTask(NamedTuple):
    """One recording's share for a worker of a cluster, which reads it itself: its path has to hold there."""

    origin: Origin
    rig: Rig
    hints: Hints
    names: frozenset[str]
    null_runs: int
    least_noise_dps_rthz: float


def response_tables(
    plan: SimulationPlan, jobs: int, cluster: str | None, progress: OnProgress
) -> tuple[ResponseTable, ...]:
    """The tables in the order of the sessions.

    Raises
    ------
    UsageError
        Where the cluster cannot be reached.
    GyrodriftError
        Where it is lost.
    """
    if cluster is not None:
        return _on_cluster(plan, cluster, progress)
    numbers = range(len(plan.subjects))
    if usable_jobs(jobs) == 1:
        return _counted((_table(plan, number) for number in numbers), len(numbers), progress)
    # A forked process has the plan as it is: sessions are neither sent nor read again.
    with fork_pool(min(jobs, len(numbers)), _hold, plan) as pool:
        return _counted(pool.map(_held_table, numbers), len(numbers), progress)


def _table(plan: SimulationPlan, number: int) -> ResponseTable:
    return response_table(plan.subjects[number], plan.tried, null_runs_of(len(plan.subjects)))


_held: list[SimulationPlan] = []
"""In a process of the pool: what it was forked for."""


def _hold(plan: SimulationPlan) -> None:
    _held.append(plan)


def _held_table(number: int) -> ResponseTable:
    return _table(_held[0], number)


def _on_cluster(plan: SimulationPlan, address: str, progress: OnProgress) -> tuple[ResponseTable, ...]:
    names = frozenset(candidate.name for candidate in plan.tried)
    null_runs = null_runs_of(len(plan.origins))
    tasks = [
        SessionTask(
            origin._replace(path=origin.path.resolve()),
            plan.rig,
            plan.hints,
            names,
            null_runs,
            plan.least_noise_dps_rthz,
        )
        for origin in plan.origins
    ]
    workers = ClusterWorkers(address, "a diagnosis")
    try:
        progress(REPLAYED, 0, len(tasks))
        found: list[ResponseTable] = workers.results(workers.submit(read_and_simulate, tasks))
        progress(REPLAYED, len(tasks), len(tasks))
    finally:
        workers.close()
    return tuple(found)


def read_and_simulate(task: SessionTask) -> ResponseTable:
    """A session on a worker of a cluster.

    Raises
    ------
    DataError
        Where it cannot be read, or does not go through the checks any more.
    """
    path, part, reading = task.origin
    recordings = checked_session(path, reading).recordings
    if part >= len(recordings):
        raise DataError(f"{path}: changed while it was being diagnosed")
    tried = [candidate for candidate in candidates(task.hints, task.rig) if candidate.name in task.names]
    return response_table(subject_of(recordings[part], task.rig, task.least_noise_dps_rthz), tried, task.null_runs)


def _counted(tables: Iterable[ResponseTable], of: int, progress: OnProgress) -> tuple[ResponseTable, ...]:
    found = []
    progress(REPLAYED, 0, of)
    for number, table in enumerate(tables, 1):
        progress(REPLAYED, number, of)
        found.append(table)
    return tuple(found)
