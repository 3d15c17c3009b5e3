"""One output that was asked for: it is opened, tried again where that fails, and closed when nobody wants it any more.

Opening and closing are never broken off half way, since what they had begun would stay behind. So an output that is not
wanted any more may take a while to go; who needs its port waits for it.
"""

import asyncio
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from gyrodrift.logger import FilteringBoundLogger
from gyrodrift.outputs.options import OutputSpec
from gyrodrift.outputs.output import ControlAccess, Output, OutputError, OutputHost
from gyrodrift.outputs.registry import OUTPUTS
from gyrodrift.outputs.status import MOST_CLIENTS, OutputStatus, ServiceStatus

RETRY_FIRST_S = 1.0
RETRY_LONGEST_S = 30.0
STEADY_S = 30.0
"""An output that was open for so long begins again with the first pause."""

OPEN_S = 30.0
CLOSE_S = 5.0
"""The last resort: outputs bound both themselves."""


class RunningOutput:
    """An output, from when it is first wanted until it is closed.

    is_wanted
        Whether it is to be open; `poke` lets it act on a change.
    claims
        What it takes for itself, as `Output.claims` has it.

    Parameters
    ----------
    is_blocked
        Whether another output, which is about to go, still has what this one claims.
    """

    def __init__(
        self,
        spec: OutputSpec,
        log: FilteringBoundLogger,
        status: ServiceStatus,
        is_blocked: "Callable[[RunningOutput], bool]",
        access: ControlAccess | None = None,
    ) -> None:
        self.spec = spec
        self.is_wanted = True
        self.claims = OUTPUTS[spec.name].output.claims(spec.options)
        self.problem = "is being opened"
        self._log = log.bind(output=spec.name)
        self._host = OutputHost(self._log, status, access)
        self._is_blocked = is_blocked
        self._open: Output[Any] | None = None
        self._has_failed = False
        self._news = asyncio.Event()
        self.task = asyncio.create_task(self._run())

    def poke(self) -> None:
        """Something has changed: what is wanted, or what others have."""
        self._news.set()

    def call(self, what: Callable[[Output[Any]], None]) -> None:
        """Do something with the output where it is open; what it raises closes it until it is tried again."""
        if self._open is None:
            return
        try:
            what(self._open)
        except OutputError as error:
            self._fail(str(error))
        except Exception as error:  # noqa: BLE001 - whatever is wrong with one output is not for the others
            self._fail(f"{type(error).__name__}: {error}")

    def note(self, status: ServiceStatus) -> None:
        """The service's state, kept for an output that opens later."""
        self._host.status = status
        self.call(lambda output: output.note(status))

    def status(self) -> OutputStatus:
        """How it is."""
        if self._open is None:
            return OutputStatus(str(self.spec), problem=self.problem)
        try:
            clients, counts = self._open.clients(), self._open.counts()
        except Exception as error:  # noqa: BLE001 - likewise
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
        """Until it is not wanted any more, and closed."""
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
        """Open it, and close it when it fails or is not wanted any more; how long it was open, 0 for never."""
        self._has_failed, open_s, loop = False, 0.0, asyncio.get_running_loop()
        try:
            output = OUTPUTS[self.spec.name].output(self.spec.options, self._host)
        except Exception as error:  # noqa: BLE001 - likewise
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
        """Wait until something is so, and `most_s` at most."""
        with suppress(TimeoutError):
            async with asyncio.timeout(most_s):
                while not is_so():
                    self._news.clear()
                    await self._news.wait()


async def _opened(output: Output[Any]) -> str:
    """Open it; why that did not go, empty where it did."""
    try:
        async with asyncio.timeout(OPEN_S):
            await output.open()
    except TimeoutError:
        return f"took longer than {OPEN_S:g} s to open"
    except OutputError as error:
        return str(error)
    except Exception as error:  # noqa: BLE001 - likewise
        return f"{type(error).__name__}: {error}"
    return ""


async def _closed(output: Output[Any], log: FilteringBoundLogger) -> None:
    try:
        async with asyncio.timeout(CLOSE_S):
            await output.close()
    except Exception as error:  # noqa: BLE001 - likewise
        log.warning("output_close_failed", reason=f"{type(error).__name__}: {error}")
