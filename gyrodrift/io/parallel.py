"""Worker processes on this machine, for work that holds the interpreter lock."""

import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from functools import partial
from multiprocessing import get_context
from signal import SIG_DFL, SIG_IGN, SIGINT, SIGTERM, signal
from typing import Any, Generic, TypeVar

from gyrodrift.io.system import CAN_FORK, kill_with

Item = TypeVar("Item")
Result = TypeVar("Result")
Inherited = TypeVar("Inherited")


class Workers(Generic[Inherited]):
    """Maps functions of a value that forked processes inherit, and of an item that is sent; or in this process."""

    def __init__(self, inherited: Inherited, pool: ProcessPoolExecutor | None) -> None:
        self.inherited, self._pool = inherited, pool

    def map(self, work: Callable[[Inherited, Item], Result], items: Sequence[Item]) -> Iterable[Result]:
        """Results in the order of the items."""
        if self._pool is None:
            return (work(self.inherited, item) for item in items)
        return self._pool.map(partial(_with_inherited, work), items)


@contextmanager
def workers(jobs: int, inherited: Inherited) -> Iterator[Workers[Inherited]]:
    """Up to `jobs` processes with a value that need not be picklable; for one job, this process does the work.

    The processes end with this process; work that has not begun is given up at the end.
    """
    if usable_jobs(jobs) == 1:
        yield Workers(inherited, None)
        return
    pool = ProcessPoolExecutor(jobs, get_context("fork"), _begin, (os.getpid(), inherited))
    try:
        yield Workers(inherited, pool)
    finally:
        pool.shutdown(cancel_futures=True)


def usable_jobs(jobs: int) -> int:
    """Number of processes: `jobs`, or 1 on a system without fork, such as Windows."""
    return jobs if CAN_FORK else 1


_inherited: list[Any] = []
"""Value for which this process was forked."""


def _with_inherited(work: Callable[[Any, Item], Result], item: Item) -> Result:
    return work(_inherited[-1], item)


def _begin(parent: int, inherited: Any) -> None:
    """Ignore Ctrl-C, which reaches every process of a terminal: a worker that dies with a lock blocks the others."""
    kill_with(parent)
    signal(SIGINT, SIG_IGN)
    signal(SIGTERM, SIG_DFL)
    _inherited.append(inherited)
