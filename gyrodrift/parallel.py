"""Processes of this machine, for work that holds the interpreter lock."""

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
    """Maps a function in this process or in forked ones, which inherit the memory of this process."""

    def __init__(self, pool: ProcessPoolExecutor | None) -> None:
        self._pool = pool

    def map(self, work: Callable[[Item], Result], given: Sequence[Item]) -> Iterable[Result]:
        """Results in the order of the items."""
        return map(work, given) if self._pool is None else self._pool.map(work, given)


@contextmanager
def workers(jobs: int) -> Iterator[LocalWorkers]:
    """Up to `jobs` processes; with one process the work is done in this one."""
    if usable_jobs(jobs) == 1:
        yield LocalWorkers(None)
        return
    pool = fork_pool(jobs, _leave_signals_to_the_parent)
    try:
        yield LocalWorkers(pool)
    finally:
        pool.shutdown(cancel_futures=True)


def usable_jobs(jobs: int) -> int:
    """Number of processes: `jobs`, or 1 if the system cannot fork, as Windows."""
    return jobs if CAN_FORK else 1


def fork_pool(jobs: int, begin: Callable[..., None], *given: Any) -> ProcessPoolExecutor:
    """Forked processes that call `begin` first, and that end whenever this process ends."""
    return ProcessPoolExecutor(jobs, get_context("fork"), _begin, (os.getpid(), begin, given))


def _begin(parent: int, begin: Callable[..., None], given: tuple[Any, ...]) -> None:
    kill_with(parent)
    begin(*given)


def _leave_signals_to_the_parent() -> None:
    """Ignore Ctrl-C, which reaches every process of a terminal: a worker that dies with the queue hangs the rest."""
    signal(SIGINT, SIG_IGN)
    signal(SIGTERM, SIG_DFL)
