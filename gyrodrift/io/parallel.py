"""Work in parallel: processes on this machine, for work that holds the interpreter lock, and workers of a Dask cluster.

Scheduler, workers and this process need the same version of gyrodrift. If a worker of a cluster dies, Dask repeats its
tasks on another worker. A task uses one thread, so a worker with n threads uses n processors. Waiting for results
has a time limit.
"""

import asyncio
import logging
import os
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent import futures
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager, suppress
from functools import partial
from multiprocessing import get_context
from signal import SIG_DFL, SIG_IGN, SIGINT, SIGTERM, signal
from typing import Any, Generic, TypeVar

from gyrodrift.io.installation import extra_command
from gyrodrift.io.system import CAN_FORK, kill_with
from gyrodrift.values.errors import GyrodriftError, UsageError

Item = TypeVar("Item")
Result = TypeVar("Result")
Inherited = TypeVar("Inherited")

_inherited: list[Any] = []
"""Value for which this process was forked."""

CONNECT_S = 5.0
FIRST_WORKER_S = 10.0
"""Longest wait for the first answer of the scheduler, and for its first worker, s: chosen."""

POLL_S = 1.0
ANSWER_S = 30.0
NO_WORKER_S = 60.0
"""Interval of the checks of the cluster, longest wait for an answer of the scheduler, and longest time without a
worker, s: chosen. The nanny of Dask starts a new worker within seconds."""

TASKS_AT_A_TIME = 250
"""Tasks in one message: some megabytes with the paths of their sessions; Dask warns above 10 MB."""

CANCELLATIONS = (asyncio.CancelledError, futures.CancelledError)
"""Dask raises both types."""


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


def _with_inherited(work: Callable[[Any, Item], Result], item: Item) -> Result:
    return work(_inherited[-1], item)


def _begin(parent: int, inherited: Any) -> None:
    """Ignore Ctrl-C, which reaches every process of a terminal: a worker that dies with a lock blocks the others."""
    kill_with(parent)
    signal(SIGINT, SIG_IGN)
    signal(SIGTERM, SIG_DFL)
    _inherited.append(inherited)


class ClusterWorkers:
    """Workers of a Dask scheduler; every wait for them has a time limit.

    Parameters
    ----------
    address
        Address of the scheduler, such as `tcp://host:8786`.
    purpose
        Purpose for the message about a missing package, such as `tuning`.

    Raises
    ------
    UsageError
        If the package is missing, no scheduler answers, or the scheduler has no workers.

    `threads` is the number of threads of the workers at the beginning.
    """

    def __init__(self, address: str, purpose: str) -> None:
        self._dask = _library(purpose)
        self._address = address
        self._last_worker_s = time.monotonic()
        self._client = self._connected()
        try:
            self.threads = self._first_threads()
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """Leave the cluster; the workers drop the data of this process."""
        with suppress(TimeoutError, OSError):
            self._client.close(timeout=CONNECT_S)

    def _connected(self) -> Any:
        try:
            asyncio.run(asyncio.wait_for(_greet(self._dask, self._address), CONNECT_S))
            return self._dask.Client(self._address, timeout=CONNECT_S, set_as_default=False)
        except (OSError, ValueError, ImportError) as error:
            why = f" ({error})" if str(error) else ""
            raise UsageError(
                f"{self._address}: no Dask scheduler answers there{why}; start one with `dask scheduler`"
            ) from error

    def submit(self, work: Callable[..., object], *columns: Sequence[Any]) -> list[Any]:
        """Submit a task for each row of the columns and return their futures; columns may hold futures."""
        if self._client.status != "running" or any(_is_canceled(value) for column in columns for value in column):
            raise self._lost()
        return list(self._client.map(work, *columns, pure=False, batch_size=TASKS_AT_A_TIME))

    def results(self, tasks: Sequence[Any]) -> list[Any]:
        """Results of the tasks, in their order.

        Raises
        ------
        GyrodriftError
            The error of the first failed task, or the loss of the cluster.
        """
        self._last_worker_s = time.monotonic()
        gathering = asyncio.run_coroutine_threadsafe(
            self._client.gather(list(tasks), errors="skip", asynchronous=True), self._client.loop.asyncio_loop
        )
        try:
            while True:
                try:
                    values = list(gathering.result(POLL_S))
                except TimeoutError:
                    self._raise_first(tasks)
                    self._check_workers()
                else:
                    self._raise_first(tasks)
                    return values
        except (OSError, *CANCELLATIONS):
            raise self._lost() from None
        finally:
            gathering.cancel()

    def _raise_first(self, tasks: Sequence[Any]) -> None:
        """Raise the error of the first failed task, once all tasks before it are done."""
        for task in tasks:
            if task.status in {"pending", "lost"}:
                return
            if _is_canceled(task):
                raise self._lost()
            if task.status == "error":
                raise self._error_of(task.exception())

    def _error_of(self, error: BaseException) -> BaseException:
        if isinstance(error, GyrodriftError):
            return error
        if isinstance(error, self._dask.KilledWorker):
            return GyrodriftError(f"{self._address}: several workers died on the same task; check their memory")
        return GyrodriftError(f"{self._address}: a task failed: {type(error).__name__}: {error}")

    def _check_workers(self) -> None:
        """Raise an error if no worker is left to wait for."""
        try:
            threads = self._running_threads()
        except (OSError, TimeoutError):
            raise self._lost() from None
        if threads:
            self._last_worker_s = time.monotonic()
        elif time.monotonic() - self._last_worker_s > NO_WORKER_S:
            raise GyrodriftError(
                f"{self._address}: no worker for {NO_WORKER_S:.0f} s; all workers stopped, or paused for lack of memory"
            )

    def _first_threads(self) -> int:
        until_s = time.monotonic() + FIRST_WORKER_S
        while not (threads := self._running_threads()):
            if time.monotonic() > until_s:
                raise UsageError(
                    f"{self._address}: this scheduler has no workers; start some with `dask worker {self._address}`"
                )
            time.sleep(0.1)
        return threads

    def _running_threads(self) -> int:
        if self._client.status != "running":
            raise self._lost()
        running = self._client.sync(self._client.scheduler.ncores_running, callback_timeout=ANSWER_S)
        return sum(running.values())

    def _lost(self) -> GyrodriftError:
        return GyrodriftError(f"{self._address}: the Dask scheduler is gone, with all unfinished work")


def _library(purpose: str) -> Any:
    """The package `distributed`; only its errors are logged, since this process raises the rest."""
    try:
        import distributed  # noqa: PLC0415 - takes a second to import
    except ImportError as error:
        raise UsageError(
            f"{purpose} on a cluster needs the package {error.name}: {extra_command('cluster')}"
        ) from error
    for name in ("distributed", "distributed.client"):
        logging.getLogger(name).setLevel(logging.ERROR)
    return distributed


async def _greet(dask: Any, address: str) -> None:
    """Check for a scheduler before a client is made: a client without a scheduler leaves a thread behind."""
    async with dask.rpc(address) as server:
        kind = (await server.identity())["type"]
    if kind != "Scheduler":
        raise ValueError(f"it is a {kind}")


def _is_canceled(value: Any) -> bool:
    """Whether this is a future that Dask has canceled, as after the end of the scheduler."""
    return getattr(value, "status", "") == "cancelled"
