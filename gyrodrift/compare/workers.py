"""Processes that run methods over sessions: the peers' packages hold the interpreter, so threads would not do."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context
from typing import TypeVar

Given = TypeVar("Given")
Found = TypeVar("Found")


class Workers:
    """Maps in this process or in others; what they were made after is known to them too."""

    def __init__(self, pool: ProcessPoolExecutor | None) -> None:
        self._pool = pool

    def map(self, work: Callable[[Given], Found], given: Sequence[Given]) -> Iterable[Found]:
        """The results in their order."""
        return map(work, given) if self._pool is None else self._pool.map(work, given)


@contextmanager
def workers(jobs: int) -> Iterator[Workers]:
    """So many processes; with one the work is done here."""
    if jobs == 1:
        yield Workers(None)
        return
    pool = ProcessPoolExecutor(jobs, get_context("fork"))
    try:
        yield Workers(pool)
    finally:
        pool.shutdown(cancel_futures=True)
