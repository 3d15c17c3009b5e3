"""The loop of the process of the outputs: it takes messages of the service and runs the wanted outputs.

An output that fails is retried with growing pauses; this does not affect the others. `Hub._reconcile` alone begins and
ends outputs, so that they always follow the last list of wanted outputs.
"""

import asyncio
import contextlib
import json
import socket
from collections.abc import Callable
from dataclasses import asdict
from functools import partial
from typing import Any

from gyrodrift.io.logger import FilteringBoundLogger
from gyrodrift.outputs import wire
from gyrodrift.outputs.net.servers import BoundedEvent, Periodic
from gyrodrift.outputs.options import OutputSpec, options_from
from gyrodrift.outputs.output import ControlAccess, Output
from gyrodrift.outputs.registry import OUTPUTS
from gyrodrift.outputs.running import RunningOutput
from gyrodrift.outputs.status import ServiceStatus
from gyrodrift.values.sample import Corrected

REPORT_S = 0.5
END_S = 3.0
"""Time for all outputs to close at the end, s; the process then ends."""

MOST_MESSAGES = 64
"""Messages that are read in a row, before the clients get their turn."""


class Hub:
    """All outputs, and the socket to the service."""

    def __init__(self, service: socket.socket, log: FilteringBoundLogger, source: str = "") -> None:
        self._service = service
        self._source = source
        self._log = log
        self._status = ServiceStatus()
        self._access: ControlAccess | None = None
        self._running: dict[OutputSpec, RunningOutput] = {}
        self._samples: list[Corrected] = []
        self._wanted: list[OutputSpec] = []
        self._is_over = asyncio.Event()
        self._broke = BoundedEvent(log.error, "output_broke", "outputs_broke")

    async def run(self) -> None:
        """Run until the service closes its end."""
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
            if message[:1] in wire.SAMPLE_KINDS:
                self._samples += wire.unpack_samples(message)
                if len(self._samples) >= wire.MOST_RECORDS:
                    self._hand_on()
            else:
                self._hand_on()
                self._take(message[:1], wire.unpack_json(message))
        self._hand_on()

    def _hand_on(self) -> None:
        """Hand samples to the outputs in batches."""
        samples, self._samples = self._samples, []
        if samples:
            self._call_all(lambda output: output.take(samples))

    def _take(self, kind: bytes, content: Any) -> None:
        match kind:
            case wire.EVENT:
                self._call_all(lambda output: output.hear(content["event"], content["fields"]))
            case wire.STATUS:
                self._status = ServiceStatus.from_dict(content)
                for running in self._running.values():
                    running.note(self._status)
            case wire.OUTPUTS:
                self._want([_spec_of(entry) for entry in content])
            case wire.ACCESS:
                self._access = ControlAccess(**content)
            case wire.DROPPED:
                self._call_all(lambda output: output.hear("samples_dropped", {"count": content}))

    def _call_all(self, function: Callable[[Output[Any]], None]) -> None:
        for running in self._running.values():
            running.call(function)

    def _want(self, specs: list[OutputSpec]) -> None:
        """Set the wanted outputs; outputs that stay are not interrupted."""
        self._wanted = specs
        self._reconcile()

    def _reconcile(self) -> None:
        """Compare wanted with running outputs; each output then opens or closes by itself."""
        for spec, running in self._running.items():
            running.is_wanted = spec in self._wanted
        for spec in self._wanted:
            if spec not in self._running:
                running = self._running[spec] = RunningOutput(
                    spec, self._log, self._status, self._is_blocked, self._access, self._source
                )
                running.task.add_done_callback(partial(self._ended, spec))
        for running in self._running.values():
            running.poke()

    def _is_blocked(self, blocked: RunningOutput) -> bool:
        """Whether a closing output still has a resource that this output needs."""
        closing = (running for running in self._running.values() if running is not blocked and not running.is_wanted)
        return any(running.exclusive_resources & blocked.exclusive_resources for running in closing)

    def _ended(self, spec: OutputSpec, task: asyncio.Task[None]) -> None:
        """Remove a closed output; it may be wanted again."""
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
        outputs = [self._running[spec] for spec in self._wanted if spec in self._running]
        statuses = [asdict(running.status()) for running in outputs]
        with contextlib.suppress(OSError):  # the service reads later, or has ended
            self._service.send(json.dumps(statuses).encode())

    def _say(self, _loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
        """Log an error of asyncio, in place of its traceback."""
        reason = f"{context.get('exception')!r}: {context['message']}"
        if self._is_over.is_set():  # the timer of `_broke` would not run any more
            self._log.error("output_broke", reason=reason)
        else:
            self._broke.happened(reason=reason)


def _spec_of(given: dict[str, Any]) -> OutputSpec:
    return OutputSpec(given["name"], options_from(OUTPUTS[given["name"]].output.options_type, given["options"]))
