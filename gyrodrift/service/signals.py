"""SIGINT and SIGTERM as something a loop can wait on, so that nothing is interrupted half way."""

import os
import signal
from types import TracebackType
from typing import Self


class StopSignal:
    """From entering to leaving, the two signals only set `is_set` and make `fd` readable."""

    NUMBERS = (signal.SIGINT, signal.SIGTERM)

    def __init__(self) -> None:
        self.is_set = False
        self.fd = -1

    def __enter__(self) -> Self:
        self.fd, self._write_fd = os.pipe2(os.O_NONBLOCK | os.O_CLOEXEC)
        self._old_fd = signal.set_wakeup_fd(self._write_fd, warn_on_full_buffer=False)
        self._old_handlers = [signal.signal(number, self._set) for number in self.NUMBERS]
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for number, handler in zip(self.NUMBERS, self._old_handlers, strict=True):
            signal.signal(number, handler)
        signal.set_wakeup_fd(self._old_fd)
        os.close(self.fd)
        os.close(self._write_fd)

    def _set(self, _number: int, _frame: object) -> None:
        self.is_set = True
