"""The tables of all sessions: worked out here, in processes of this machine, or by the workers of a cluster."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import NamedTuple

from firmware_sim.rig import Rig
from gyrodrift.cluster import ClusterWorkers
from gyrodrift.diagnose.recording.checks import CheckedRecording, check_recording
from gyrodrift.diagnose.recording.recording import recording_of
from gyrodrift.diagnose.simulate.candidates import Hints, candidates
from gyrodrift.diagnose.simulate.responses import ResponseTable, table_of
from gyrodrift.diagnose.simulate.twin import subject_of
from gyrodrift.errors import DataError
from gyrodrift.session.files import load_session

Progress = Callable[[str, int, int], None]


class SessionTask(NamedTuple):
    """One session's part, small enough to be sent anywhere: its path has to hold there."""

    path: Path
    rig: Rig
    hints: Hints
    names: frozenset[str]


def passed(path: Path) -> CheckedRecording:
    """A session after the recording checks.

    Raises
    ------
    DataError
        Where it cannot be read, or has no encoder.
    """
    return check_recording(recording_of(load_session(path)))


def work_out(work: SessionTask) -> ResponseTable:
    """Read a session and simulate all that is to be known of it."""
    recording = passed(work.path).recording
    if recording is None:
        raise DataError(f"{work.path}: changed while it was being diagnosed")
    tried = [candidate for candidate in candidates(work.hints) if candidate.name in work.names]
    return table_of(recording, subject_of(recording, work.rig), tried)


def gathered(works: Sequence[SessionTask], jobs: int, cluster: str | None, progress: Progress) -> list[ResponseTable]:
    """The tables in the order of the sessions.

    Raises
    ------
    UsageError
        Where the cluster cannot be reached.
    GyrodriftError
        Where it is lost.
    """
    if cluster is not None:
        return _on_cluster(works, cluster, progress)
    if jobs == 1:
        return _counted(map(work_out, works), len(works), progress)
    with ProcessPoolExecutor(min(jobs, len(works)), get_context("fork")) as pool:
        return _counted(pool.map(work_out, works), len(works), progress)


def _on_cluster(works: Sequence[SessionTask], address: str, progress: Progress) -> list[ResponseTable]:
    workers = ClusterWorkers(address, "a diagnosis")
    try:
        progress("sessions replayed by the cluster", 0, len(works))
        found: list[ResponseTable] = workers.results(workers.submit(work_out, works))
        progress("sessions replayed by the cluster", len(works), len(works))
    finally:
        workers.close()
    return found


def _counted(tables: Iterable[ResponseTable], of: int, progress: Progress) -> list[ResponseTable]:
    return list(_telling(iter(tables), of, progress))


def _telling(tables: Iterator[ResponseTable], of: int, progress: Progress) -> Iterator[ResponseTable]:
    for number, table in enumerate(tables, 1):
        progress("sessions replayed", number, of)
        yield table
