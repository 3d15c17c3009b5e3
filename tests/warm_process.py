"""Commands of ours as processes that need not load their packages: forked from a process that has loaded them.

A start of Python with our packages takes a quarter of a second of processor time, and the suite starts a thousand
commands. Tests of the start itself (installation, imports, terminals) start Python.
"""

import atexit
import gc
import json
import os
import runpy
import select
import signal
import socket
import subprocess
import sys
import threading
from contextlib import suppress
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import BinaryIO

LOADED = (
    "firmware_sim.command",
    "gyrodrift.cli.record",
    "gyrodrift.cli.replay",
    "gyrodrift.cli.serve",
    "gyrodrift.cli.serving",
    "gyrodrift.config.outputs",
    "gyrodrift.config.reading",
    "gyrodrift.config.watch",
    "gyrodrift.filters.restlevel_filter",
    "gyrodrift.io.log",
    "gyrodrift.link.link",
    "gyrodrift.link.protocols.detect",
    "gyrodrift.recording.live_line",
    "gyrodrift.recording.recorder",
    "gyrodrift.recording.resilient",
    "gyrodrift.service.loop",
    "gyrodrift.service.memory_keeper",
    "gyrodrift.service.output_feed",
    "gyrodrift.service.pipeline",
    "gyrodrift.service.reporting",
    "gyrodrift.session.files",
    "numpy.ma",
    "urllib.request",
)
"""Packages of the commands that tests start most."""

LONGEST_REQUEST = 1 << 17
"""Bytes; an environment and the words of a command are shorter."""


class WarmProcess:
    """A command as `subprocess.Popen` gives it: stdin is empty, stderr a pipe, and stdout a pipe if it is no file."""

    def __init__(self, module: str, words: list[str], out: BinaryIO | None = None) -> None:
        self.returncode: int | None = None
        err, err_end = os.pipe()
        self._ended, ended_end = os.pipe()
        self.stderr: BinaryIO = os.fdopen(err, "rb")
        self.stdout: BinaryIO | None = None
        ends = [err_end, ended_end]
        if out is None:
            read_end, out_end = os.pipe()
            self.stdout = os.fdopen(read_end, "rb")
            ends.append(out_end)
        request = json.dumps([module, words, dict(os.environ), str(Path.cwd())]).encode()
        socket.send_fds(forks(), [request], [ends[-1] if out is None else out.fileno(), err_end, ended_end])
        for end in ends:
            os.close(end)
        self.pid = int(forks().recv(16))

    def poll(self) -> int | None:
        """Exit status, the negative number of a signal, or none while it runs."""
        return self._status(0.0)

    def wait(self, timeout: float | None = None) -> int:
        """Exit status at its end."""
        status = self._status(timeout)
        if status is None:
            raise subprocess.TimeoutExpired(str(self.pid), timeout or 0.0)
        return status

    def send_signal(self, number: int) -> None:
        if self.poll() is None:
            with suppress(ProcessLookupError):
                os.kill(self.pid, number)

    def kill(self) -> None:
        self.send_signal(signal.SIGKILL)

    def _status(self, timeout_s: float | None) -> int | None:
        if self.returncode is None and select.select([self._ended], [], [], timeout_s)[0]:
            self.returncode = os.waitstatus_to_exitcode(int(os.read(self._ended, 16)))
            os.close(self._ended)
        return self.returncode


@cache
def forks() -> socket.socket:
    """Connection to the process that forks; it ends with this one."""
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    with theirs:
        process = subprocess.Popen(
            [sys.executable, __file__, str(theirs.fileno())], stdin=subprocess.DEVNULL, pass_fds=[theirs.fileno()]
        )
    atexit.register(_end, ours, process)
    return ours


def _end(connection: socket.socket, process: "subprocess.Popen[bytes]") -> None:
    connection.close()
    process.wait()


def _request_of_a_fork(requests: socket.socket) -> tuple[str, list[str]]:
    """Fork for each request, and tell how the forks end. Returns in a fork, with its module and words."""
    wake, woken = os.pipe2(os.O_NONBLOCK | os.O_CLOEXEC)
    signal.set_wakeup_fd(woken, warn_on_full_buffer=False)
    signal.signal(signal.SIGCHLD, lambda *_: None)
    running: dict[int, int] = {}
    while True:
        ready = select.select([requests.fileno(), wake], [], [])[0]
        if wake in ready:
            os.read(wake, 4096)
            _tell_ends(running)
        if requests.fileno() not in ready:
            continue
        message, passed, _, _ = socket.recv_fds(requests, LONGEST_REQUEST, 3)
        if not message:
            sys.exit()
        out, err, ended = passed
        pid = os.fork()
        if pid == 0:
            signal.set_wakeup_fd(-1)
            signal.signal(signal.SIGCHLD, signal.SIG_DFL)
            requests.close()
            os.dup2(out, 1)
            os.dup2(err, 2)
            for number in (*passed, *running.values(), wake, woken):
                os.close(number)
            return _begun(*json.loads(message))
        running[pid] = ended
        os.close(out)
        os.close(err)
        requests.send(str(pid).encode())


def _tell_ends(running: dict[int, int]) -> None:
    while running:
        pid, status = os.waitpid(-1, os.WNOHANG)
        if pid == 0:
            return
        ended = running.pop(pid)
        with suppress(BrokenPipeError):
            os.write(ended, str(status).encode())
        os.close(ended)


def _begun(module: str, words: list[str], environment: dict[str, str], folder: str) -> tuple[str, list[str]]:
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(environment)
    return module, words


def _run_to_the_end(module: str) -> None:
    """Run a module as a program, and end without freeing what is loaded: that takes longer than most commands."""
    status = 0
    try:
        runpy.run_module(module, run_name="__main__", alter_sys=True)
    except SystemExit as end:
        status = int(end.code or 0)
    threading._shutdown()  # type: ignore[attr-defined]  # what an interpreter does at its end, in its order
    atexit._run_exitfuncs()
    try:
        if not sys.stdout.closed:
            sys.stdout.flush()
    except OSError:
        status = 120  # as an interpreter
    os._exit(status)


if __name__ == "__main__":
    sys.path[0] = str(Path(__file__).parent.parent)
    gc.disable()
    for name in LOADED:
        import_module(name)
    gc.freeze()  # a collection in a fork would walk, and so copy, all that is loaded
    gc.enable()
    with socket.socket(fileno=int(sys.argv[1])) as connection:
        name, arguments = _request_of_a_fork(connection)
    sys.argv[1:] = arguments
    _run_to_the_end(name)
