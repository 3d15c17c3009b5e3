"""Simulations of all sessions, in processes of this machine."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import NamedTuple

from gyrodrift.diagnose.simulate.candidate import Candidate
from gyrodrift.diagnose.simulate.repeats import is_shared, twins_of, with_shared
from gyrodrift.diagnose.simulate.response_table import ResponseTable, SimulatedSet, Sized, key
from gyrodrift.diagnose.simulate.responses import Compared, change_in, null_runs_of, points_of, response_table, together
from gyrodrift.diagnose.simulate.twin import Subject
from gyrodrift.io.parallel import workers
from gyrodrift.io.progress import OnProgress
from gyrodrift.values.arrays import Floats

REPLAYED = "sessions replayed"


class SimulationPlan(NamedTuple):
    """Calibrated recordings, and the candidates to simulate in them.

    compared
        Function that subtracts a baseline from the differences of a table; None without a baseline.
    """

    subjects: tuple[Subject, ...]
    tried: tuple[Candidate, ...]
    compared: Compared | None = None


def response_tables(plan: SimulationPlan, jobs: int, progress: OnProgress) -> tuple[ResponseTable, ...]:
    """Response tables in the order of the sessions.

    An effect has one size in all sessions. So the first session tells which sizes are simulated in all others.
    """
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
