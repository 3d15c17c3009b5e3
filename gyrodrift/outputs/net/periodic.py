"""Periodic calls, such as a heartbeat."""

import asyncio
from collections.abc import Callable


class Periodic:
    """Calls a function at a fixed interval on the loop; late calls are skipped.

    An exception ends the calls; `close` raises it. With `waits` only calls after `wake` are made: without one the loop
    sleeps.
    """

    def __init__(self, every_s: float, call: Callable[[], object], *, waits: bool = False) -> None:
        self._every_s = every_s
        self._call = call
        self._waits = waits
        self._has_work = asyncio.Event()
        self._task = asyncio.get_running_loop().create_task(self._run())

    def wake(self) -> None:
        """Let the next call be made."""
        self._has_work.set()

    async def close(self) -> None:
        """End the calls."""
        self._task.cancel()
        await asyncio.wait([self._task])
        if not self._task.cancelled():
            self._task.result()

    async def _run(self) -> None:
        loop = asyncio.get_running_loop()
        due_s = loop.time()
        while True:
            if self._waits:
                await self._has_work.wait()
                self._has_work.clear()
            self._call()
            now_s = loop.time()
            due_s = max(due_s + self._every_s, now_s)
            await asyncio.sleep(due_s - now_s)
