"""Processes of this machine for work that holds the interpreter, so that threads would not do: methods, simulations."""

import os
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context
from signal import SIG_DFL, SIG_IGN, SIGINT, SIGKILL, SIGTERM, signal
from typing import Any, TypeVar

Given = TypeVar("Given")
Found = TypeVar("Found")


PR_SET_PDEATHSIG = 1
"""Linux, prctl(2): asks for a signal when the parent ends."""


class LocalWorkers:
    """Maps in this process or in others; what they were made after is known to them too."""

    def __init__(self, pool: ProcessPoolExecutor | None) -> None:
        self._pool = pool

    def map(self, work: Callable[[Given], Found], given: Sequence[Given]) -> Iterable[Found]:
        """The results in their order."""
        return map(work, given) if self._pool is None else self._pool.map(work, given)


@contextmanager
def workers(jobs: int) -> Iterator[LocalWorkers]:
    """So many processes; with one the work is done here."""
    if jobs == 1:
        yield LocalWorkers(None)
        return
    pool = fork_pool(jobs, _leave_signals_to_the_parent)
    try:
        yield LocalWorkers(pool)
    finally:
        pool.shutdown(cancel_futures=True)


def fork_pool(jobs: int, begin: Callable[..., None], *given: Any) -> ProcessPoolExecutor:
    """Forked processes that call `begin` first, and that end when this process does, however it ends."""
    return ProcessPoolExecutor(jobs, get_context("fork"), _begin, (os.getpid(), begin, given))


def _begin(parent: int, begin: Callable[..., None], given: tuple[Any, ...]) -> None:
    end_with_parent(parent)
    begin(*given)


def end_with_parent(parent: int) -> None:
    """End this worker at once when the process of this number ends, which forked it."""
    if not sys.platform.startswith("linux"):
        return
    import ctypes  # noqa: PLC0415 - who forks no workers does without

    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, int(SIGKILL), 0, 0, 0)
    if os.getppid() != parent:  # it ended before this was asked for
        os._exit(1)


def _leave_signals_to_the_parent() -> None:
    """Ctrl-C reaches every process of a terminal; one that died holding the queue would hang the others."""
    signal(SIGINT, SIG_IGN)
    signal(SIGTERM, SIG_DFL)
