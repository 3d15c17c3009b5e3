"""A wanted output: it is opened, retried after a failure, and closed when it is not wanted any more.

Opening and closing are never canceled, so that no resource leaks. A closing output may take a while; an output that
needs its port waits.
"""

import asyncio
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from gyrodrift.io.logger import FilteringBoundLogger
from gyrodrift.outputs.options import OutputSpec
from gyrodrift.outputs.output import ControlAccess, Output, OutputError, OutputHost
from gyrodrift.outputs.registry import OUTPUTS
from gyrodrift.outputs.status import MOST_CLIENTS, OutputStatus, ServiceStatus

RETRY_FIRST_S = 1.0
RETRY_LONGEST_S = 30.0
STEADY_S = 30.0
"""Time after which an open output is steady and its next pause is the first again, s."""

OPEN_S = 30.0
CLOSE_S = 5.0
"""Upper limits for opening and closing, s; outputs have limits of their own."""


class RunningOutput:
    """An output, from when it is first wanted until it is closed.

    is_wanted
        Whether it should be open; call `poke` after a change.
    exclusive_resources
        Exclusive resources, as `Output.exclusive_resources`.

    Parameters
    ----------
    is_blocked
        Whether a closing output still has a resource that this output needs.
    """

    def __init__(
        self,
        spec: OutputSpec,
        log: FilteringBoundLogger,
        status: ServiceStatus,
        is_blocked: "Callable[[RunningOutput], bool]",
        access: ControlAccess | None = None,
        source: str = "",
    ) -> None:
        self.spec = spec
        self.is_wanted = True
        self.exclusive_resources = OUTPUTS[spec.name].output.exclusive_resources(spec.options)
        self.problem = "is being opened"
        self._log = log.bind(output=spec.name)
        self._host = OutputHost(self._log, status, access, source)
        self._is_blocked = is_blocked
        self._open: Output[Any] | None = None
        self._has_failed = False
        self._news = asyncio.Event()
        self.task = asyncio.create_task(self._run())

    def poke(self) -> None:
        """Notify of a change in the wanted or in the other outputs."""
        self._news.set()

    def call(self, function: Callable[[Output[Any]], None]) -> None:
        """Call a function with the open output; an error closes it until the next try."""
        if self._open is None:
            return
        try:
            function(self._open)
        except OutputError as error:
            self._fail(str(error))
        except Exception as error:  # noqa: BLE001 - a bug of one output must not affect the others
            self._fail(f"{type(error).__name__}: {error}")

    def note(self, status: ServiceStatus) -> None:
        """Take the state of the service, and keep it for a later opening."""
        self._host.status = status
        self.call(lambda output: output.note(status))

    def status(self) -> OutputStatus:
        """Status of the output."""
        if self._open is None:
            return OutputStatus(str(self.spec), problem=self.problem)
        try:
            clients, counts = self._open.clients(), self._open.counts()
        except Exception as error:  # noqa: BLE001 - a bug of one output must not affect the others
            self._fail(f"{type(error).__name__}: {error}")
            return OutputStatus(str(self.spec), problem=self.problem)
        return OutputStatus(
            str(self.spec),
            self._open.address,
            "",
            tuple(clients[:MOST_CLIENTS]),
            len(clients),
            *counts,
            self._open.warning,
        )

    def _fail(self, why: str) -> None:
        self.problem, self._has_failed = why, True
        self.poke()

    async def _run(self) -> None:
        """Run until it is not wanted any more, and closed."""
        pause_s, is_told = RETRY_FIRST_S, False
        while self.is_wanted:
            await self._until(lambda: not (self.is_wanted and self._is_blocked(self)))
            open_s = await self._open_for_s() if self.is_wanted else 0.0
            is_told = is_told and not open_s
            pause_s = RETRY_FIRST_S if open_s > STEADY_S else pause_s
            if self.is_wanted and self._has_failed:
                (self._log.debug if is_told else self._log.error)("output_failed", reason=self.problem, retry_s=pause_s)
                is_told = True
                await self._until(lambda: not self.is_wanted, pause_s)
                pause_s = min(2.0 * pause_s, RETRY_LONGEST_S)

    async def _open_for_s(self) -> float:
        """Open it, and close it when it fails or is not wanted; the time it was open, s, or 0."""
        self._has_failed, open_s, loop = False, 0.0, asyncio.get_running_loop()
        try:
            output = OUTPUTS[self.spec.name].output(self.spec.options, self._host)
        except Exception as error:  # noqa: BLE001 - a bug of one output must not affect the others
            self._fail(f"{type(error).__name__}: {error}")
            return open_s
        problem = await _opened(output)
        if problem:
            self._fail(problem)
        elif self.is_wanted:
            self._open, opened_s = output, loop.time()
            self._log.info("output_open", address=output.address)
            await self._until(lambda: self._has_failed or not self.is_wanted)
            self._open, open_s = None, loop.time() - opened_s
        await _closed(output, self._log)
        return open_s

    async def _until(self, is_so: Callable[[], bool], most_s: float | None = None) -> None:
        """Wait for a condition, at most `most_s`."""
        with suppress(TimeoutError):
            async with asyncio.timeout(most_s):
                while not is_so():
                    self._news.clear()
                    await self._news.wait()


async def _opened(output: Output[Any]) -> str:
    """Open it; the problem, or an empty text."""
    try:
        async with asyncio.timeout(OPEN_S):
            await output.open()
    except TimeoutError:
        return f"took longer than {OPEN_S:g} s to open"
    except OutputError as error:
        return str(error)
    except Exception as error:  # noqa: BLE001 - a bug of one output must not affect the others
        return f"{type(error).__name__}: {error}"
    return ""


async def _closed(output: Output[Any], log: FilteringBoundLogger) -> None:
    try:
        async with asyncio.timeout(CLOSE_S):
            await output.close()
    except Exception as error:  # noqa: BLE001 - a bug of one output must not affect the others
        log.warning("output_close_failed", reason=f"{type(error).__name__}: {error}")
