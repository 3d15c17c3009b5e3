"""SIGINT, SIGTERM and SIGHUP as a descriptor that a loop can wait for, so that no work is interrupted."""

import os
import signal
import time
from collections.abc import Iterator
from contextlib import contextmanager
from types import TracebackType
from typing import Self

from gyrodrift.io.system import WakePipe

OUTPUTS = (1, 2)
SIGHUP: signal.Signals | None = getattr(signal, "SIGHUP", None)
"""None on Windows."""

REPEAT_S = 1.0
"""Terminals, shells and `timeout` may send a signal twice within this time, s."""


class StoppedError(BaseException):
    """A signal has come within `StopSignal.at_once`; no handler of errors takes it."""


class StopSignal:
    """Inside the context the signals only set `is_set` and make `fd` readable.

    A second signal after REPEAT_S ends the process at once, for a disk that hangs or a reader that takes nothing. After
    SIGHUP the terminal is closed, and output to it is discarded. An ignored SIGHUP, as under nohup, stays ignored.
    Within `at_once` a signal ends the context itself, because nothing there looks at `is_set`.
    """

    def __init__(self) -> None:
        self.is_set = False
        self.fd = -1
        self._first_s: float | None = None
        self._is_at_once = False

    @contextmanager
    def at_once(self) -> Iterator[None]:
        """Let a signal interrupt the block, such as the first connection to a host that does not answer."""
        self._is_at_once = True
        try:
            if self.is_set:
                raise StoppedError
            yield
        finally:
            self._is_at_once = False

    def __enter__(self) -> Self:
        self._wake = WakePipe()
        self.fd = self._wake.fd
        self._terminals = [fd for fd in OUTPUTS if os.isatty(fd)]
        self._old_fd = signal.set_wakeup_fd(self._wake.write_fd, warn_on_full_buffer=False)
        numbers = [signal.SIGINT, signal.SIGTERM]
        if SIGHUP is not None and signal.getsignal(SIGHUP) is not signal.SIG_IGN:
            numbers.append(SIGHUP)
        self._old_handlers = {number: signal.signal(number, self._set) for number in numbers}
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> bool:
        for number, handler in self._old_handlers.items():
            signal.signal(number, handler)
        signal.set_wakeup_fd(self._old_fd)
        self._wake.close()
        return isinstance(error, StoppedError)

    def _set(self, number: int, _frame: object) -> None:
        if number == SIGHUP:
            nowhere = os.open(os.devnull, os.O_WRONLY)
            for fd in self._terminals:
                os.dup2(nowhere, fd)
            os.close(nowhere)
        self.is_set = True
        now_s = time.monotonic()
        self._first_s = self._first_s or now_s
        if now_s - self._first_s >= REPEAT_S:
            signal.signal(number, signal.SIG_DFL)
            os.kill(os.getpid(), number)
        if self._is_at_once:
            self._is_at_once = False
            raise StoppedError
