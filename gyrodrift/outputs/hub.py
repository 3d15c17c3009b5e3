"""The loop of the outputs' process: takes what the service hands over, and runs each output until it is not wanted.

An output that cannot be opened, or breaks, is tried again with growing pauses; the others know nothing of it. Which
outputs there are follows from what is wanted last: `Hub._reconcile` is the only place that begins or ends one.
"""

import asyncio
import contextlib
import json
import socket
from collections.abc import Callable
from dataclasses import asdict
from functools import partial
from typing import Any

from gyrodrift.logger import FilteringBoundLogger
from gyrodrift.outputs import wire
from gyrodrift.outputs.net.periodic import Periodic
from gyrodrift.outputs.net.refusals import BoundedEvent
from gyrodrift.outputs.options import OutputSpec, options_from
from gyrodrift.outputs.output import ControlAccess, Output
from gyrodrift.outputs.registry import OUTPUTS
from gyrodrift.outputs.running import RunningOutput
from gyrodrift.outputs.status import ServiceStatus
from gyrodrift.sample import Corrected

REPORT_S = 0.5
END_S = 3.0
"""That all outputs together have to close in the end; what takes longer goes with the process."""

MOST_MESSAGES = 64
"""Taken at a time, before the clients get their turn."""


class Hub:
    """All outputs, and the socket to the service."""

    def __init__(self, service: socket.socket, log: FilteringBoundLogger) -> None:
        self._service = service
        self._log = log
        self._status = ServiceStatus()
        self._access: ControlAccess | None = None
        self._running: dict[OutputSpec, RunningOutput] = {}
        self._samples: list[Corrected] = []
        self._wanted: list[OutputSpec] = []
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
            await self._end()
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
            case wire.ACCESS:
                self._access = ControlAccess(**content)
            case wire.DROPPED:
                self._each(lambda output: output.hear("samples_dropped", {"count": content}))

    def _each(self, what: Callable[[Output[Any]], None]) -> None:
        for running in self._running.values():
            running.call(what)

    def _want(self, wanted: list[OutputSpec]) -> None:
        """These from now on; what stays notices nothing."""
        self._wanted = wanted
        self._reconcile()

    def _reconcile(self) -> None:
        """Compare what is wanted with what is there; each output then goes its way by itself."""
        for spec, running in self._running.items():
            running.is_wanted = spec in self._wanted
        for spec in self._wanted:
            if spec not in self._running:
                running = self._running[spec] = RunningOutput(
                    spec, self._log, self._status, self._is_blocked, self._access
                )
                running.task.add_done_callback(partial(self._ended, spec))
        for running in self._running.values():
            running.poke()

    def _is_blocked(self, blocked: RunningOutput) -> bool:
        """Whether an output that is not wanted any more still has what this one claims."""
        others = (each for each in self._running.values() if each is not blocked and not each.is_wanted)
        return any(each.claims & blocked.claims for each in others)

    def _ended(self, spec: OutputSpec, task: asyncio.Task[None]) -> None:
        """An output is closed; it may be wanted again meanwhile."""
        del self._running[spec]
        if not task.cancelled() and task.exception() is not None:
            self._log.error("output_broke", output=spec.name, reason=repr(task.exception()))
        self._reconcile()

    async def _end(self) -> None:
        self._want([])
        tasks = [running.task for running in self._running.values()]
        if tasks:
            _, late = await asyncio.wait(tasks, timeout=END_S)
            for task in late:
                task.cancel()
            await asyncio.gather(*late, return_exceptions=True)

    def _report(self) -> None:
        wanted = [self._running[spec] for spec in self._wanted if spec in self._running]
        statuses = [asdict(running.status()) for running in wanted]
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
