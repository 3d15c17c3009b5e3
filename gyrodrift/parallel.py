"""Processes of this machine for work that holds the interpreter, so that threads would not do: methods, simulations."""

import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context
from signal import SIG_DFL, SIG_IGN, SIGINT, SIGTERM, signal
from typing import Any, TypeVar

from gyrodrift.system import CAN_FORK, kill_with

Given = TypeVar("Given")
Found = TypeVar("Found")


class LocalWorkers:
    """Maps in this process or in others; what they were made after is known to them too."""

    def __init__(self, pool: ProcessPoolExecutor | None) -> None:
        self._pool = pool

    def map(self, work: Callable[[Given], Found], given: Sequence[Given]) -> Iterable[Found]:
        """The results in their order."""
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
    """The number of processes that `jobs` gives here: 1 where the system cannot fork, as on Windows."""
    return jobs if CAN_FORK else 1


def fork_pool(jobs: int, begin: Callable[..., None], *given: Any) -> ProcessPoolExecutor:
    """Forked processes that call `begin` first, and that end when this process does, however it ends."""
    return ProcessPoolExecutor(jobs, get_context("fork"), _begin, (os.getpid(), begin, given))


def _begin(parent: int, begin: Callable[..., None], given: tuple[Any, ...]) -> None:
    kill_with(parent)
    begin(*given)


def _leave_signals_to_the_parent() -> None:
    """Ctrl-C reaches every process of a terminal; one that died holding the queue would hang the others."""
    signal(SIGINT, SIG_IGN)
    signal(SIGTERM, SIG_DFL)
