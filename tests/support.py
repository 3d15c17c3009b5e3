"""Helpers for tests: commands as processes, and ptys."""

import json
import os
import pty
import re
import select
import signal
import socket
import subprocess
import sys
import termios
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext, redirect_stderr, redirect_stdout
from io import StringIO
from itertools import islice
from pathlib import Path
from types import TracebackType
from typing import Any, BinaryIO, NamedTuple, Self, TypeVar

import pyte
import pytest
from warm_process import WarmProcess

from firmware_sim.pty import PtyDevice
from gyrodrift.cli import main
from gyrodrift.session.mcap.layout import MESSAGE

PATIENCE_S = 240.0
"""How long a test waits for what should come at once: a loaded machine is slow, a hang is for ever."""


TERMINAL_PATIENCE_S = 480.0
"""Patience with commands that load packages of the workstation first."""


Value = TypeVar("Value")


def awaited(measure: Callable[[], Value | None], is_so: Callable[[Value], object] = bool) -> Value:
    """A value, measured again until it is so, for as long as a test has patience."""
    until_s = time.monotonic() + PATIENCE_S
    while (value := measure()) is None or not is_so(value):
        assert time.monotonic() < until_s, value
        time.sleep(0.01)
    return value


def beginning(path: Path, rows: int, folder: Path) -> Path:
    """The first rows of a recording, for checks that do not take all of it."""
    short = folder / path.name
    with path.open() as whole:
        short.write_text("".join(islice(whole, 1 + rows)))
    return short


class Ended(NamedTuple):
    """Exit status, stdout and stderr of a command."""

    status: int
    out: str
    log: str


def ended_here(*arguments: str | Path) -> Ended:
    """A command of ours that ends by itself, in this process."""
    with redirect_stdout(StringIO()) as out, redirect_stderr(StringIO()) as log:
        status = main([str(word) for word in arguments])
    return Ended(status, out.getvalue(), log.getvalue())


Process = WarmProcess | subprocess.Popen[bytes]


def _fresh_process(module: str, words: list[str], out: BinaryIO | None) -> "subprocess.Popen[bytes]":
    command = [sys.executable, "-m", module, *words]
    stdout = subprocess.PIPE if out is None else out
    return subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=stdout, stderr=subprocess.PIPE)


class Command:
    """A command of ours as a process, its stdout and stderr read without threads and without waiting for ever.

    With `out_file` stdout goes to that file instead, which takes any number of lines however slow the test is. A fresh
    one is a Python of its own, whose command line other users see.
    """

    def __init__(
        self, *arguments: str | Path, module: str = "gyrodrift", out_file: Path | None = None, is_fresh: bool = False
    ) -> None:
        words = [str(word) for word in arguments]
        with nullcontext() if out_file is None else out_file.open("wb") as out:
            start = _fresh_process if is_fresh else WarmProcess
            self.process: Process = start(module, words, out)
        streams = [stream.fileno() for stream in (self.process.stdout, self.process.stderr) if stream]
        self._streams = {fd: bytearray() for fd in streams}
        self._open = set(self._streams)
        self._out, self._err = streams[0], streams[-1]
        self._taken = 0

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.process.kill()
        self.process.wait()
        for stream in (self.process.stdout, self.process.stderr):
            if stream is not None:
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

    def glance(self) -> None:
        """Read what is there of both streams, without waiting."""
        if self._open:
            self._read(0.0)

    def until_log(self, text: str) -> None:
        self.until(lambda command: text in command.log, f"log line with {text!r}")

    def take_lines(self, count: int) -> list[dict[str, Any]]:
        """The next `count` JSON lines of stdout."""
        written = self._streams[self._out]
        self.until(lambda _: written.count(b"\n") >= self._taken + count, f"{count} lines")
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


class Terminal:
    """A command of ours on a terminal of some size: a screen that shows what a person would see.

    `keys` types; `resize` does what a window manager does. Of `streams` the others are pipes, stdin is the terminal.
    """

    def __init__(
        self,
        *words: str | Path,
        columns: int = 80,
        rows: int = 24,
        streams: Sequence[str] = ("stdout", "stderr"),
        environment: Mapping[str, str] | None = None,
    ) -> None:
        self.screen = pyte.Screen(columns, rows)
        self.sent = b""
        self._stream = pyte.ByteStream(self.screen)
        self._master, slave = pty.openpty()
        termios.tcsetwinsize(self._master, (rows, columns))
        rest = dict.fromkeys(("stdout", "stderr"), subprocess.DEVNULL)
        given: dict[str, Any] = rest | dict.fromkeys(streams, slave)
        self.process = subprocess.Popen(
            [str(word) for word in words],
            stdin=slave,
            env=os.environ | {"TERM": "xterm-256color"} | dict(environment or {}),
            start_new_session=True,
            **given,
        )
        os.close(slave)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.process.kill()
        self.process.wait()
        if self._master >= 0:
            os.close(self._master)

    @property
    def text(self) -> str:
        return "\n".join(self.screen.display)

    def keys(self, text: str) -> None:
        os.write(self._master, text.encode())

    def resize(self, columns: int, rows: int) -> None:
        self.screen.resize(rows, columns)
        termios.tcsetwinsize(self._master, (rows, columns))
        self.process.send_signal(signal.SIGWINCH)

    def until(self, is_so: Callable[[Self], bool], what: str) -> None:
        """Watch the screen until `is_so`, for as long as the test has patience."""
        until_s = time.monotonic() + TERMINAL_PATIENCE_S
        while not is_so(self):
            assert time.monotonic() < until_s, f"no {what} in {TERMINAL_PATIENCE_S} s on\n{self.text}"
            assert self._read(), f"no {what}, and it ended with\n{self.text}"

    def end(self) -> int:
        """Watch until the end and give the exit status."""
        until_s = time.monotonic() + TERMINAL_PATIENCE_S
        while self._read():
            assert time.monotonic() < until_s, f"no end on\n{self.text}"
        return self.process.wait(PATIENCE_S)

    def hang_up(self) -> int:
        """Close the terminal, as a window is closed; the exit status, once it has ended by itself."""
        os.close(self._master)
        self._master = -1
        return self.process.wait(PATIENCE_S)

    def _read(self) -> bool:
        """Take what is there within a moment; whether there may be more."""
        if not select.select([self._master], [], [], 0.05)[0]:
            return True
        try:
            chunk = os.read(self._master, 1 << 16)
        except OSError:
            return False
        self.sent += chunk
        self._stream.feed(chunk)
        return True


def free_port() -> int:
    """A port that nobody has."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return int(free.getsockname()[1])


def ours(*words: str | Path) -> list[str]:
    """A command line of ours, for whoever starts it."""
    return [sys.executable, "-m", "gyrodrift", *map(str, words)]


Recording = Callable[..., AbstractContextManager[tuple[PtyDevice, Command]]]
"""Fixture that starts `record` with options; it gives the device and the command."""


@contextmanager
def speaking_on(link: Path) -> Iterator[PtyDevice]:
    """A pty to write on, linked at `link`."""
    device = PtyDevice(link)
    try:
        yield device
    finally:
        device.close()


def quick(cases: Iterable[Any], *kept: Any) -> list[Any]:
    """Cases of a parametrized test: those kept always run, and the others, which resemble them, in `make evaluate`.

    A tuple has the values of several arguments.
    """
    return [case if case in kept else pytest.param(*_row(case), marks=pytest.mark.evaluation) for case in cases]


def _row(case: Any) -> tuple[Any, ...]:
    return case if isinstance(case, tuple) else (case,)


def never() -> bool:
    """For the pty, which asks whether it is over."""
    return False


def python_in(page: str) -> list[str]:
    """Python of a page of docs/, in its order: blocks in the text, and files of docs/examples that it links to."""
    docs = Path(__file__).parent.parent / "docs"
    parts = re.findall(r"```python\n(.*?)```|\]\((examples/[\w/-]+\.py)\)", (docs / page).read_text(), re.DOTALL)
    return [block or (docs / example).read_text() for block, example in parts]


def are_recorded(samples: int, folder: Path, more_bytes: int = 0) -> bool:
    """Whether a file of the folder is long enough for so many samples, and for what else it holds."""
    return any(path.stat().st_size > samples * MESSAGE.size + more_bytes for path in folder.glob("*.mcap"))


def near(value: float, tolerance: float | None = None) -> Any:
    """`pytest.approx` where a field wants a number."""
    return pytest.approx(value, abs=tolerance)
