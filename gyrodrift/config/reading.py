"""Reading a changed config in a process of its own, for which no loop waits, within a limit of processor time."""

import os
import pickle
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryFile
from types import FrameType
from typing import IO

from gyrodrift import __version__
from gyrodrift.config.model import Config, load_config
from gyrodrift.values.errors import ConfigError

MOST_CPU_S = 1.0
"""Processor time; a config of 128 KiB takes up to 0.7 s on a desktop, an ordinary one 0.01 s."""

TOO_LONG = "takes too long to read"

LONGEST_S = 20.0
"""Elapsed time. The process uses at most MOST_CPU_S of it; other programs may have the processor."""

PIECE_BYTES = 1 << 16
KILLED_S = 0.2
"""Time for a killed process to end when the service ends, s."""

AGAIN = "save it again, or ask for it with ctl reload"


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


class ConfigReading:
    """One reading of a file, or of its block of a source; it begins with the constructor.

    Raises
    ------
    ConfigError
        From the constructor, if no process can be started.
    """

    def __init__(self, path: Path, monotonic: Callable[[], float] = time.monotonic, source: str = "") -> None:
        self._path = path
        self._monotonic = monotonic
        command = [sys.executable, "-m", "gyrodrift.config", str(os.getpid()), str(path), *filter(None, [source])]
        self._file = None if hasattr(os, "set_blocking") else TemporaryFile()  # noqa: SIM115 - until the answer is read; Windows before Python 3.12
        try:
            self._process = subprocess.Popen(  # noqa: S603 - this very program
                command, stdin=subprocess.DEVNULL, stdout=self._file or subprocess.PIPE, stderr=subprocess.DEVNULL
            )
        except OSError as error:
            reason = f"no process can be started that reads it: {error.strerror}; {AGAIN}"
            raise ConfigError([f"{path}: {reason}"]) from error
        stream = self._file or self._process.stdout
        assert stream is not None  # noqa: S101 - it is a pipe, as was asked for
        self._stream: IO[bytes] = stream
        if self._file is None:
            os.set_blocking(self._stream.fileno(), False)
        self._answer = bytearray()
        self._until_s = monotonic() + LONGEST_S

    @property
    def is_gone(self) -> bool:
        """Whether the process has ended."""
        return self._process.poll() is not None

    def outcome(self) -> Config | None:
        """The config; None while it is being read. The process may end a moment later.

        Raises
        ------
        ConfigError
            With all mistakes, if it takes too long, or if its process died.
        """
        if self._read_to_end():
            self._stream.close()
            return self._config()
        if self._monotonic() < self._until_s:
            return None
        self._process.kill()
        self._stream.close()
        raise ConfigError([f"{self._path}: {TOO_LONG}: more than {LONGEST_S:g} s; {AGAIN}"])

    def close(self) -> None:
        """Abort the reading."""
        self._process.kill()
        self._stream.close()
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(KILLED_S)

    def _read_to_end(self) -> bool:
        """Read the output of the process; whether it is complete and the process has ended."""
        if self._file is not None:
            return self.is_gone and self._take_file(self._file)
        try:
            while piece := os.read(self._stream.fileno(), PIECE_BYTES):
                self._answer += piece
        except BlockingIOError:
            return False
        return self.is_gone

    def _take_file(self, file: IO[bytes]) -> bool:
        file.seek(0)
        self._answer += file.read()
        return True

    def _config(self) -> Config:
        status = self._process.returncode
        if status:
            how = f"by signal {-status}" if status < 0 else f"with status {status}"
            raise ConfigError([f"{self._path}: the process that reads it ended {how}; {AGAIN}"])
        version, config, problems = self._unpacked()
        if version != __version__:
            reason = f"was read by gyrodrift {version}, this is {__version__}; restart the service"
            raise ConfigError([f"{self._path}: {reason}"])
        if config is None:
            raise ConfigError(problems)
        return config

    def _unpacked(self) -> tuple[str, Config | None, tuple[str, ...]]:
        try:
            version, config, problems = pickle.loads(self._answer)  # noqa: S301 - this very program said it
        except Exception as error:  # noqa: BLE001 - another version of it, whose classes may be others
            return type(error).__name__, None, ()
        return version, config, problems
