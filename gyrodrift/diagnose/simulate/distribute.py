"""The response tables of all sessions: simulated here, in processes of this machine, or by the workers of a cluster."""

from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from multiprocessing import get_context
from pathlib import Path
from typing import NamedTuple

from firmware_sim.rig import Rig
from gyrodrift.cluster import ClusterWorkers
from gyrodrift.diagnose.recording.checks import CheckedRecording, check_recording
from gyrodrift.diagnose.recording.numbering import backlog_of
from gyrodrift.diagnose.recording.recording import recording_of
from gyrodrift.diagnose.simulate.candidate import Candidate, Hints
from gyrodrift.diagnose.simulate.candidates import candidates
from gyrodrift.diagnose.simulate.response_table import ResponseTable
from gyrodrift.diagnose.simulate.responses import null_runs_of, response_table
from gyrodrift.diagnose.simulate.twin import Subject, subject_of
from gyrodrift.errors import DataError
from gyrodrift.progress import OnProgress
from gyrodrift.session.calibrated import calibration_of, with_calibration
from gyrodrift.session.files import load_session

REPLAYED = "sessions replayed"


@dataclass(frozen=True, slots=True, eq=False)
class SimulationPlan:
    """What is to be simulated: sessions, loaded, checked and cleaned, with their paths in the same order.

    tried
        Of the candidates that the hints give, those that are to be simulated.
    least_noise_dps_rthz
        Less noise than that no recording of this device has.
    """

    paths: tuple[Path, ...]
    subjects: tuple[Subject, ...]
    rig: Rig
    hints: Hints
    tried: tuple[Candidate, ...]
    least_noise_dps_rthz: float


class SessionTask(NamedTuple):
    """One session's part for a worker of a cluster, which reads the session itself: its path has to hold there."""

    path: Path
    rig: Rig
    hints: Hints
    names: frozenset[str]
    null_runs: int
    least_noise_dps_rthz: float


def checked_recording(path: Path) -> CheckedRecording:
    """A session as a recording that went through the checks, its rates put right by the calibration that it keeps.

    Raises
    ------
    DataError
        Where it cannot be read, or has no encoder.
    """
    session, remarks = load_session(path), []
    calibration = calibration_of(session)
    if calibration is not None:
        session = with_calibration(session, calibration)
        how = f"is compared with its calibration of {calibration.date} applied, as a filter takes it"
        remarks.append(f"{session.name}: {how}")
    if waited := backlog_of(session):
        session = session.part(waited, len(session.t_device_s))
        remarks.append(f"{session.name}: its first {waited} samples had waited and came at once; they are left out")
    checked = check_recording(recording_of(session))
    return replace(checked, remarks=(*remarks, *checked.remarks))


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
    if jobs == 1:
        return _counted((_table(plan, number) for number in numbers), len(numbers), progress)
    # A forked process has the plan as it is: sessions are neither sent nor read again.
    with ProcessPoolExecutor(min(jobs, len(numbers)), get_context("fork"), _hold, (plan,)) as pool:
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
    null_runs = null_runs_of(len(plan.paths))
    tasks = [
        SessionTask(path.resolve(), plan.rig, plan.hints, names, null_runs, plan.least_noise_dps_rthz)
        for path in plan.paths
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
    recording = checked_recording(task.path).recording
    if recording is None:
        raise DataError(f"{task.path}: changed while it was being diagnosed")
    tried = [candidate for candidate in candidates(task.hints, task.rig) if candidate.name in task.names]
    return response_table(subject_of(recording, task.rig, task.least_noise_dps_rthz), tried, task.null_runs)


def _counted(tables: Iterable[ResponseTable], of: int, progress: OnProgress) -> tuple[ResponseTable, ...]:
    found = []
    progress(REPLAYED, 0, of)
    for number, table in enumerate(tables, 1):
        progress(REPLAYED, number, of)
        found.append(table)
    return tuple(found)
