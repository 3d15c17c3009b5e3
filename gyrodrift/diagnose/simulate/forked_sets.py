"""Whole sets of candidates, simulated in all sessions at once by processes of this machine."""

from collections.abc import Sequence
from types import TracebackType
from typing import NamedTuple, Self

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.simulate.candidate import Candidate
from gyrodrift.diagnose.simulate.response_table import ResponseTable, SimulatedSet, Sized, key
from gyrodrift.diagnose.simulate.responses import change_in, change_of, together
from gyrodrift.diagnose.simulate.twin import Subject
from gyrodrift.parallel import fork_pool, usable_jobs


class _Held(NamedTuple):
    """What a process was forked for; candidates hold functions, which cannot be sent, and go by their keys."""

    subjects: Sequence[Subject]
    tables: Sequence[ResponseTable]
    candidates: dict[str, Candidate]


Sent = tuple[tuple[str, float, tuple[float, ...] | None], ...]
"""Key, size and phases of each candidate of a set."""

_held: list[_Held] = []


class ForkedSets:
    """Simulates sets; `with` it, its processes end where it does."""

    def __init__(
        self, subjects: Sequence[Subject], tables: Sequence[ResponseTable], tried: Sequence[Candidate], jobs: int
    ) -> None:
        self._known: dict[Sent, SimulatedSet] = {}
        self._own = _Held(subjects, tables, {key(candidate): candidate for candidate in tried})
        jobs = min(usable_jobs(jobs), len(subjects))
        self._pool = None if jobs == 1 else fork_pool(jobs, _hold, self._own)

    def __enter__(self) -> Self:
        """As it is."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, raised: BaseException | None, at: TracebackType | None
    ) -> None:
        """End the processes."""
        if self._pool is not None:
            self._pool.shutdown()

    def change_of(self, effects: Sequence[Sized]) -> SimulatedSet:
        """What a whole set of candidates does in all sessions; the same set is simulated once."""
        sent = tuple((key(one.candidate), one.size, _as_tuple(one.phases_deg)) for one in effects)
        if sent not in self._known:
            self._known[sent] = self._simulated(effects, sent)
        return self._known[sent]

    def _simulated(self, effects: Sequence[Sized], sent: Sent) -> SimulatedSet:
        if self._pool is None:
            return change_of(effects, self._own.subjects, self._own.tables)
        numbers = range(len(self._own.subjects))
        return together(list(self._pool.map(_change_of_sent, [sent] * len(numbers), numbers)))


def _hold(held: _Held) -> None:
    _held.append(held)


def _as_tuple(phases_deg: Floats | None) -> tuple[float, ...] | None:
    return None if phases_deg is None else tuple(phases_deg.tolist())


def _change_of_sent(sent: Sent, number: int) -> SimulatedSet:
    held = _held[0]
    effects = [
        Sized(held.candidates[name], size, None if phases_deg is None else np.array(phases_deg))
        for name, size, phases_deg in sent
    ]
    return change_in(effects, number, held.subjects[number], held.tables[number])
