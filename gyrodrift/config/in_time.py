"""Reading a config within a limit of processor time."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType

from gyrodrift.config.model import Config, load_config
from gyrodrift.values.errors import ConfigError

MOST_CPU_S = 1.0
"""Processor time; a config of 128 KiB takes up to 0.7 s on a desktop, an ordinary one 0.01 s."""

TOO_LONG = "takes too long to read"


class _TimeIsUpError(BaseException):
    """The time limit. It is a BaseException, so that no handler inside the reading catches it."""


def load_in_time(path: Path, source: str = "") -> Config:
    """Read and check a config, or its block of a source, as `load_config` does, in the main thread of this process.

    Raises
    ------
    ConfigError
        With every mistake, or because it takes more than MOST_CPU_S.
    """
    try:
        with _processor_time(MOST_CPU_S):
            return load_config(path, source) if source else load_config(path)
    except _TimeIsUpError:
        problem = f"{path}: {TOO_LONG}: more than {MOST_CPU_S:g} s of processor time; make it simpler or shorter"
        raise ConfigError([problem]) from None


@contextmanager
def _processor_time(most_s: float) -> Iterator[None]:
    """Raise _TimeIsUpError if the body takes longer. Without a timer of processor time it takes as long as it takes."""
    if not hasattr(signal, "setitimer"):  # Windows
        yield
        return
    before = signal.signal(signal.SIGPROF, _end)
    try:
        signal.setitimer(signal.ITIMER_PROF, most_s)
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


def _end(_number: int, _frame: FrameType | None) -> None:
    raise _TimeIsUpError
