"""What tests share: commands run as processes of their own, and ptys to speak on."""

import json
import os
import select
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import pytest

from firmware_sim.pty import PtyDevice
from gyrodrift.session.mcap.layout import MESSAGE

PATIENCE_S = 20.0
"""How long a test waits for what should come at once: a loaded machine is slow, a hang is for ever."""


@dataclass(frozen=True)
class Recordings:
    data: Path
    golden: Path


def beginning(path: Path, rows: int, folder: Path) -> Path:
    """The first rows of a recording, for checks that do not take all of it."""
    short = folder / path.name
    with path.open() as whole:
        short.write_text("".join(islice(whole, 1 + rows)))
    return short


class Command:
    """A command of ours as a process, its stdout and stderr read without threads and without waiting for ever."""

    def __init__(self, *arguments: str | Path, module: str = "gyrodrift") -> None:
        command = [sys.executable, "-m", module, *map(str, arguments)]
        self.process = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE
        )
        assert self.process.stdout is not None
        assert self.process.stderr is not None
        self._streams = {self.process.stdout.fileno(): bytearray(), self.process.stderr.fileno(): bytearray()}
        self._open = set(self._streams)
        self._out, self._err = self._streams
        self._taken = 0

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.process.kill()
        self.process.wait()
        for stream in (self.process.stdout, self.process.stderr):
            assert stream is not None
            stream.close()

    @property
    def out(self) -> str:
        return self._streams[self._out].decode()

    @property
    def log(self) -> str:
        return self._streams[self._err].decode()

    def until(self, is_done: Callable[[Self], bool], what: str) -> None:
        """Read both streams until `is_done`, for as long as the test has patience."""
        until_s = time.monotonic() + PATIENCE_S
        while not is_done(self):
            assert time.monotonic() < until_s, f"no {what} in {PATIENCE_S} s; log:\n{self.log}"
            assert self._open or self.process.poll() is None, f"no {what}, and it ended; log:\n{self.log}"
            self._read(0.05)

    def until_log(self, text: str) -> None:
        self.until(lambda command: text in command.log, f"log line with {text!r}")

    def take_lines(self, count: int) -> list[dict[str, Any]]:
        """The next `count` JSON lines of stdout."""
        self.until(lambda command: len(command.out.split("\n")) - 1 >= self._taken + count, f"{count} lines")
        lines = self.out.split("\n")[self._taken : self._taken + count]
        self._taken += count
        return [json.loads(line) for line in lines]

    def all_lines(self) -> list[dict[str, Any]]:
        """Every whole JSON line of stdout so far."""
        return [json.loads(line) for line in self.out.split("\n")[:-1]]

    def close_stdout(self) -> None:
        """Read no more of it, as a pipe whose other end is closed."""
        assert self.process.stdout is not None
        self._open.discard(self._out)
        self.process.stdout.close()

    def stop(self, number: int = signal.SIGTERM) -> int:
        """Send a signal and give the exit status."""
        self.process.send_signal(number)
        return self.end()

    def end(self) -> int:
        """Wait for the end and give the exit status."""
        self.until(lambda command: not command._open, "end of its output")
        return self.process.wait(PATIENCE_S)

    def _read(self, wait_s: float) -> None:
        ready, _, _ = select.select(list(self._open), [], [], wait_s)
        for fd in ready:
            chunk = os.read(fd, 1 << 16)
            self._streams[fd] += chunk
            if not chunk:
                self._open.discard(fd)


@contextmanager
def speaking_on(link: Path) -> Iterator[PtyDevice]:
    """A pty to write on, linked at `link`."""
    device = PtyDevice(link)
    try:
        yield device
    finally:
        device.close()


def never() -> bool:
    """For the pty, which asks whether it is over."""
    return False


def python_in(page: str) -> list[str]:
    """The Python that stands in a page of docs/, block by block."""
    text = (Path(__file__).parent.parent / "docs" / page).read_text()
    return [block.partition("```")[0] for block in text.split("```python\n")[1:]]


def are_recorded(samples: int, folder: Path, more_bytes: int = 0) -> bool:
    """Whether a file of the folder is long enough for so many samples, and for what else it holds."""
    return any(path.stat().st_size > samples * MESSAGE.size + more_bytes for path in folder.glob("*.mcap"))


def near(value: float, tolerance: float | None = None) -> Any:
    """`pytest.approx` where a field wants a number."""
    return pytest.approx(value, abs=tolerance)
