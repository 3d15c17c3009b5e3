"""A config that is read while samples come in: in a process of its own, which the service never waits for."""

import os
import pickle
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryFile
from typing import IO

from gyrodrift import __version__
from gyrodrift.config.in_time import TOO_LONG
from gyrodrift.config.model import Config
from gyrodrift.errors import ConfigError

LONGEST_S = 20.0
"""On the clock, of which the process itself uses `in_time.MOST_CPU_S` at most: others may have the processor."""

PIECE_BYTES = 1 << 16
KILLED_S = 0.2
"""That a killed process has to be gone at the end of the service."""

AGAIN = "save it again, or ask for it with ctl reload"


class ConfigReading:
    """One reading of a file, under way from the constructor on.

    Raises
    ------
    ConfigError
        From the constructor, where no process can be started.
    """

    def __init__(self, path: Path, monotonic: Callable[[], float] = time.monotonic) -> None:
        self._path = path
        self._monotonic = monotonic
        command = [sys.executable, "-m", "gyrodrift.config", str(os.getpid()), str(path)]
        self._file = None if hasattr(os, "set_blocking") else TemporaryFile()  # noqa: SIM115 - until the answer is read; Windows before Python 3.12
        try:
            self._process = subprocess.Popen(  # noqa: S603 - this very program
                command, stdin=subprocess.DEVNULL, stdout=self._file or subprocess.PIPE, stderr=subprocess.DEVNULL
            )
        except OSError as error:
            reason = f"no process can be started that reads it: {error.strerror}; {AGAIN}"
            raise ConfigError([f"{path}: {reason}"]) from error
        said = self._file or self._process.stdout
        assert said is not None  # noqa: S101 - it is a pipe, as was asked for
        self._said: IO[bytes] = said
        if self._file is None:
            os.set_blocking(self._said.fileno(), False)
        self._answer = bytearray()
        self._until_s = monotonic() + LONGEST_S

    @property
    def is_gone(self) -> bool:
        """Whether the process has ended."""
        return self._process.poll() is not None

    def outcome(self) -> Config | None:
        """The config; None while it is being read. After that the process may still be there for a moment.

        Raises
        ------
        ConfigError
            With every mistake, because it takes too long, or because its process died.
        """
        if self._has_ended():
            self._said.close()
            return self._config()
        if self._monotonic() < self._until_s:
            return None
        self._process.kill()
        self._said.close()
        raise ConfigError([f"{self._path}: {TOO_LONG}: more than {LONGEST_S:g} s; {AGAIN}"])

    def close(self) -> None:
        """End it; what it would have told is of no use any more."""
        self._process.kill()
        self._said.close()
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(KILLED_S)

    def _has_ended(self) -> bool:
        """Take what the process has said; whether that is all and it has ended."""
        if self._file is not None:
            return self.is_gone and self._take_file(self._file)
        try:
            while piece := os.read(self._said.fileno(), PIECE_BYTES):
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
            reason = f"was read by gyrodrift {version}, this is {__version__}; start the service again"
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
