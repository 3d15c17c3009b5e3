"""The loop of the outputs' process: takes what the service hands over, and runs each output until it is not wanted.

An output that cannot be opened, or breaks, is tried again with growing pauses; the others know nothing of it.
"""

import asyncio
import contextlib
import json
import socket
from collections.abc import Callable
from dataclasses import asdict
from typing import Any

from gyrodrift.logger import FilteringBoundLogger
from gyrodrift.outputs import wire
from gyrodrift.outputs.net.periodic import Periodic
from gyrodrift.outputs.net.refusals import BoundedEvent
from gyrodrift.outputs.options import OutputSpec, options_from
from gyrodrift.outputs.output import Output, OutputError, OutputHost
from gyrodrift.outputs.registry import OUTPUTS
from gyrodrift.outputs.status import MOST_CLIENTS, OutputStatus, ServiceStatus
from gyrodrift.sample import Corrected

REPORT_S = 0.5
RETRY_FIRST_S = 1.0
RETRY_LONGEST_S = 30.0
STEADY_S = 30.0
"""An output that was open for so long begins again with the first pause."""
OPEN_S = 30.0
CLOSE_S = 3.0
MOST_MESSAGES = 64
"""Taken at a time, before the clients get their turn."""


class RunningOutput:
    """One that was asked for, open or waiting to be tried again."""

    def __init__(self, spec: OutputSpec, log: FilteringBoundLogger, status: ServiceStatus) -> None:
        self.spec = spec
        self.problem = "is being opened"
        self._log = log.bind(output=spec.name)
        self._host = OutputHost(self._log, status)
        self._open: Output[Any] | None = None
        self._has_failed = asyncio.Event()
        self._task = asyncio.create_task(self._run())

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
        except Exception as error:  # noqa: BLE001 - whatever is wrong with one output is not for the others
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

    async def close(self) -> None:
        """Not wanted any more."""
        self._task.cancel()
        await asyncio.wait([self._task])

    def _fail(self, why: str) -> None:
        self.problem = why
        self._has_failed.set()

    async def _run(self) -> None:
        pause_s = RETRY_FIRST_S
        is_told = False
        while True:
            output = OUTPUTS[self.spec.name].output(self.spec.options, self._host)
            self._has_failed.clear()
            try:
                self.problem = await _opened(output)
                if not self.problem:
                    self._log.info("output_open", address=output.address)
                    self._open, is_told = output, False
                    opened_s = asyncio.get_running_loop().time()
                    await self._has_failed.wait()
                    if asyncio.get_running_loop().time() - opened_s > STEADY_S:
                        pause_s = RETRY_FIRST_S
            finally:
                self._open = None
                await _closed(output, self._log)
            (self._log.debug if is_told else self._log.error)("output_failed", reason=self.problem, retry_s=pause_s)
            is_told = True
            await asyncio.sleep(pause_s)
            pause_s = min(2.0 * pause_s, RETRY_LONGEST_S)


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


class Hub:
    """All outputs, and the socket to the service."""

    def __init__(self, service: socket.socket, log: FilteringBoundLogger) -> None:
        self._service = service
        self._log = log
        self._status = ServiceStatus()
        self._running: dict[OutputSpec, RunningOutput] = {}
        self._samples: list[Corrected] = []
        self._wanted: list[OutputSpec] = []
        self._settling = asyncio.Lock()
        self._changes: set[asyncio.Task[None]] = set()
        self._is_over = asyncio.Event()
        self._broke = BoundedEvent(log.error, "output_broke", "outputs_broke")

    async def run(self) -> None:
        """Until the service closes its end."""
        loop = asyncio.get_running_loop()
        loop.set_exception_handler(self._say)
        self._service.setblocking(False)
        loop.add_reader(self._service, self._read)
        reports = Periodic(REPORT_S, self._report)
        try:
            await self._is_over.wait()
        finally:
            loop.remove_reader(self._service)
            await reports.close()
            self._wanted = []
            await self._settle()
            self._broke.close()

    def _read(self) -> None:
        for _ in range(MOST_MESSAGES):
            try:
                message = self._service.recv(wire.LONGEST_BYTES)
            except BlockingIOError:
                break
            except ConnectionError:
                message = b""
            if not message:
                self._is_over.set()
                break
            if message[:1] == wire.SAMPLES:
                self._samples += wire.unpack_samples(message)
                if len(self._samples) >= wire.MOST_RECORDS:
                    self._hand_on()
            else:
                self._hand_on()
                self._take(message[:1], wire.unpack_json(message))
        self._hand_on()

    def _hand_on(self) -> None:
        """Samples that have come, in handfuls: what is written for them at once is what a slow client costs."""
        samples, self._samples = self._samples, []
        if samples:
            self._each(lambda output: output.take(samples))

    def _take(self, kind: bytes, content: Any) -> None:
        match kind:
            case wire.EVENT:
                self._each(lambda output: output.hear(content["event"], content["fields"]))
            case wire.STATUS:
                self._status = ServiceStatus.from_dict(content)
                for running in self._running.values():
                    running.note(self._status)
            case wire.OUTPUTS:
                self._want([_spec_of(each) for each in content])
            case wire.DROPPED:
                self._each(lambda output: output.hear("samples_dropped", {"count": content}))

    def _each(self, what: Callable[[Output[Any]], None]) -> None:
        for running in self._running.values():
            running.call(what)

    async def _settle(self) -> None:
        """Close what is not wanted any more, then open what is new; what stays notices nothing."""
        async with self._settling:
            gone = [self._running.pop(spec) for spec in list(self._running) if spec not in self._wanted]
            await asyncio.gather(*(running.close() for running in gone))
            for spec in self._wanted:
                if spec not in self._running:
                    self._running[spec] = RunningOutput(spec, self._log, self._status)

    def _want(self, wanted: list[OutputSpec]) -> None:
        self._wanted = wanted
        task = asyncio.create_task(self._settle())
        self._changes.add(task)
        task.add_done_callback(self._changes.discard)

    def _report(self) -> None:
        statuses = [asdict(running.status()) for running in self._running.values()]
        with contextlib.suppress(OSError):  # the service reads it a little later, or has gone
            self._service.send(json.dumps(statuses).encode())

    def _say(self, _loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
        """What asyncio would write as a traceback."""
        reason = f"{context.get('exception')!r}: {context['message']}"
        if self._is_over.is_set():  # the loop may have ended, and this be its last words
            self._log.error("output_broke", reason=reason)
        else:
            self._broke.happened(reason=reason)


def _spec_of(given: dict[str, Any]) -> OutputSpec:
    return OutputSpec(given["name"], options_from(OUTPUTS[given["name"]].output.options_type, given["options"]))
