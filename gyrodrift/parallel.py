"""Processes of this machine for work that holds the interpreter, so that threads would not do: methods, simulations."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context
from signal import SIG_DFL, SIG_IGN, SIGINT, SIGTERM, signal
from typing import TypeVar

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
    """So many processes; with one the work is done here."""
    if jobs == 1:
        yield LocalWorkers(None)
        return
    pool = ProcessPoolExecutor(jobs, get_context("fork"), _leave_signals_to_the_parent)
    try:
        yield LocalWorkers(pool)
    finally:
        pool.shutdown(cancel_futures=True)


def _leave_signals_to_the_parent() -> None:
    """Ctrl-C reaches every process of a terminal; one that died holding the queue would hang the others."""
    signal(SIGINT, SIG_IGN)
    signal(SIGTERM, SIG_DFL)
