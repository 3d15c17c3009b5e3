"""Whole sets of candidates, simulated in all sessions at once by processes of this machine."""

from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from types import TracebackType
from typing import NamedTuple, Self

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.simulate.candidate import Candidate
from gyrodrift.diagnose.simulate.response_table import ResponseTable, key
from gyrodrift.diagnose.simulate.twin import Subject
from gyrodrift.diagnose.simulate.whole_set import Sized, change_in, change_of


class _Held(NamedTuple):
    """What a process was forked for; candidates hold functions, which cannot be sent, and go by their keys."""

    subjects: Sequence[Subject]
    tables: Sequence[ResponseTable]
    candidates: dict[str, Candidate]


_held: list[_Held] = []


class ForkedSets:
    """Simulates sets; `with` it, its processes end where it does."""

    def __init__(
        self, subjects: Sequence[Subject], tables: Sequence[ResponseTable], tried: Sequence[Candidate], jobs: int
    ) -> None:
        self._own = _Held(subjects, tables, {key(candidate): candidate for candidate in tried})
        jobs = min(jobs, len(subjects))
        self._pool = None if jobs == 1 else ProcessPoolExecutor(jobs, get_context("fork"), _hold, (self._own,))

    def __enter__(self) -> Self:
        """As it is."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, raised: BaseException | None, at: TracebackType | None
    ) -> None:
        """End the processes."""
        if self._pool is not None:
            self._pool.shutdown()

    def change_of(self, effects: Sequence[Sized]) -> Floats:
        """(sessions, F) what a whole set of candidates does to the features."""
        if self._pool is None:
            return change_of(effects, self._own.subjects, self._own.tables)
        numbers = range(len(self._own.subjects))
        sent = [(key(one.candidate), one.size, one.phases_deg) for one in effects]
        return np.array(list(self._pool.map(_change_of_sent, [sent] * len(numbers), numbers)))


def _hold(held: _Held) -> None:
    _held.append(held)


def _change_of_sent(sent: Sequence[tuple[str, float, Floats | None]], number: int) -> Floats:
    held = _held[0]
    effects = [Sized(held.candidates[name], size, phases_deg) for name, size, phases_deg in sent]
    return change_in(effects, number, held.subjects[number], held.tables[number])
