"""Worker processes on this machine, for work that holds the interpreter lock."""

import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context
from signal import SIG_DFL, SIG_IGN, SIGINT, SIGTERM, signal
from typing import Any, TypeVar

from gyrodrift.system import CAN_FORK, kill_with

Item = TypeVar("Item")
Result = TypeVar("Result")


class LocalWorkers:
    """Maps a function in this process, or in forked processes, which inherit its memory."""

    def __init__(self, pool: ProcessPoolExecutor | None) -> None:
        self._pool = pool

    def map(self, work: Callable[[Item], Result], items: Sequence[Item]) -> Iterable[Result]:
        """Results in the order of the items."""
        return map(work, items) if self._pool is None else self._pool.map(work, items)


@contextmanager
def workers(jobs: int) -> Iterator[LocalWorkers]:
    """Up to `jobs` worker processes; for one job, this process does the work."""
    if usable_jobs(jobs) == 1:
        yield LocalWorkers(None)
        return
    pool = fork_pool(jobs, _leave_signals_to_the_parent)
    try:
        yield LocalWorkers(pool)
    finally:
        pool.shutdown(cancel_futures=True)


def usable_jobs(jobs: int) -> int:
    """Number of processes: `jobs`, or 1 on a system without fork, such as Windows."""
    return jobs if CAN_FORK else 1


def fork_pool(jobs: int, begin: Callable[..., None], *arguments: Any) -> ProcessPoolExecutor:
    """Forked processes; they call `begin` with these arguments first, and end with this process."""
    return ProcessPoolExecutor(jobs, get_context("fork"), _begin, (os.getpid(), begin, arguments))


def _begin(parent: int, begin: Callable[..., None], arguments: tuple[Any, ...]) -> None:
    kill_with(parent)
    begin(*arguments)


def _leave_signals_to_the_parent() -> None:
    """Ignore Ctrl-C, which reaches every process of a terminal: a worker that dies with a lock blocks the others."""
    signal(SIGINT, SIG_IGN)
    signal(SIGTERM, SIG_DFL)
