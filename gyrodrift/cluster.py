"""The workers of a Dask cluster: tasks sent to them, and a wait for the results that always ends.

Scheduler, workers and this process need the same gyrodrift. Where a worker dies, Dask repeats elsewhere what is
missing. A task uses one thread: a worker keeps as many processors busy as it has threads.
"""

import asyncio
import logging
import time
from collections.abc import Callable, Sequence
from concurrent import futures
from contextlib import suppress
from typing import Any

from gyrodrift.errors import GyrodriftError, UsageError
from gyrodrift.installation import extra_command

CONNECT_S = 5.0
FIRST_WORKER_S = 10.0
"""How long the scheduler may take to answer at first, and then to have a worker."""

LOOK_S = 1.0
ANSWER_S = 30.0
NO_WORKER_S = 60.0
"""While waiting, the cluster is looked at so often; a scheduler that does not answer for so long counts as lost, and
so do workers, of which a nanny starts a new one within seconds."""

TASKS_AT_A_TIME = 250
"""That many tasks, with the paths of their sessions, make a message of some megabytes; Dask warns beyond ten."""

CANCELLED = (asyncio.CancelledError, futures.CancelledError)
"""Of the two kinds Dask raises now one, now the other."""


class ClusterWorkers:
    """The workers of a Dask scheduler, and a wait for their results that always ends.

    Parameters
    ----------
    address
        Of the scheduler, as in `tcp://host:8786`.
    purpose
        What is to be done there, in a word, for who lacks the package: `tuning`.

    Raises
    ------
    UsageError
        Where the package is missing, nobody answers at the address, or the scheduler has no workers.

    `threads` counts those of the workers at the beginning.
    """

    def __init__(self, address: str, purpose: str) -> None:
        self._dask = _library(purpose)
        self._address = address
        self._worked_s = time.monotonic()
        self._client = self._connected()
        try:
            self.threads = self._first_threads()
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """Leave the cluster; what it held for us is dropped."""
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
        """One task for each row of the columns, which may hold futures of earlier tasks; gives their futures."""
        if self._client.status != "running" or any(_is_cancelled(value) for column in columns for value in column):
            raise self._lost()
        return list(self._client.map(work, *columns, pure=False, batch_size=TASKS_AT_A_TIME))

    def results(self, tasks: Sequence[Any]) -> list[Any]:
        """What the tasks gave, in their order.

        Raises
        ------
        GyrodriftError
            The error of the first task that failed, or that the cluster is lost.
        """
        self._worked_s = time.monotonic()
        while True:
            try:
                with self._client.as_current():
                    self._dask.wait(tasks, timeout=LOOK_S)
            except TimeoutError:
                self._raise_first(tasks)
                self._look()
            except CANCELLED:
                raise self._lost() from None
            else:
                self._raise_first(tasks)
                return self._gathered(tasks)

    def _gathered(self, tasks: Sequence[Any]) -> list[Any]:
        """Bring them here; a worker that dies meanwhile is waited for again."""
        gathering = asyncio.run_coroutine_threadsafe(
            self._client.gather(list(tasks), asynchronous=True), self._client.loop.asyncio_loop
        )
        while True:
            try:
                return list(gathering.result(LOOK_S))
            except TimeoutError:
                self._look()
            except (OSError, *CANCELLED):
                raise self._lost() from None

    def _raise_first(self, tasks: Sequence[Any]) -> None:
        """The error of the first failed task, once all before it are done."""
        for task in tasks:
            if task.status in {"pending", "lost"}:
                return
            if _is_cancelled(task):
                raise self._lost()
            if task.status == "error":
                raise self._said(task.exception())

    def _said(self, error: BaseException) -> BaseException:
        if isinstance(error, GyrodriftError):
            return error
        if isinstance(error, self._dask.KilledWorker):
            return GyrodriftError(
                f"{self._address}: workers died one after the other of the same work; see their memory"
            )
        return GyrodriftError(f"{self._address}: a task failed: {type(error).__name__}: {error}")

    def _look(self) -> None:
        """Whether there is still somebody to wait for."""
        try:
            threads = self._running_threads()
        except (OSError, TimeoutError):
            raise self._lost() from None
        if threads:
            self._worked_s = time.monotonic()
        elif time.monotonic() - self._worked_s > NO_WORKER_S:
            raise GyrodriftError(
                f"{self._address}: for {NO_WORKER_S:.0f} s no worker runs; they are gone, or paused for want of memory"
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
        return GyrodriftError(f"{self._address}: the Dask scheduler is gone, and with it what was being worked out")


def _library(purpose: str) -> Any:
    """The package `distributed`, told to keep quiet: what matters to us is raised."""
    try:
        import distributed  # noqa: PLC0415 - a second to import, for who has a cluster
    except ImportError as error:
        raise UsageError(f"{purpose} on a cluster needs a package: {extra_command('cluster')} ({error})") from error
    for name in ("distributed", "distributed.client"):
        logging.getLogger(name).setLevel(logging.ERROR)
    return distributed


async def _greet(dask: Any, address: str) -> None:
    """See whether a scheduler is there: a client that waits for one in vain leaves its thread behind."""
    async with dask.rpc(address) as somebody:
        kind = (await somebody.identity())["type"]
    if kind != "Scheduler":
        raise ValueError(f"it is a {kind}")


def _is_cancelled(value: Any) -> bool:
    """Whether it is a future that Dask has given up, as it does with all of them when the scheduler goes."""
    return getattr(value, "status", "") == "cancelled"
