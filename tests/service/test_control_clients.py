"""Clients of the control socket that behave badly: the service goes on, and gives them little of its time."""

import json
import os
import signal
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
import structlog
from outputs_support import csv_at_100_hz, serving
from support import Command, never

from gyrodrift.service import control
from gyrodrift.service.control import Control, ControlCommand


@dataclass
class Served:
    """A control socket in this process, on a clock that the test moves."""

    path: Path
    now_s: float = 0.0
    took_s: float = 0.0
    run: list[str] = field(default_factory=list)
    stack: ExitStack = field(default_factory=ExitStack)
    control: Control = field(init=False)

    def __post_init__(self) -> None:
        commands = {"status": self._status, "fail": self._fail, "long": lambda _: {"text": "x" * (1 << 20)}}
        named = {name: ControlCommand(name, call) for name, call in commands.items()}
        self.control = Control(self.path, named, structlog.get_logger(), lambda: self.now_s)
        self.stack.callback(self.control.close)

    def client(self) -> socket.socket:
        """One that has connected and need not have been taken in."""
        client = self.stack.enter_context(socket.socket(socket.AF_UNIX))
        client.setblocking(False)
        client.connect(str(self.path))
        return client

    def turns(self, count: int = 1) -> None:
        """Let the loop come round with everything ready."""
        for _ in range(count):
            self.now_s += 2 * control.PAUSE_S
            self.control.serve(set(self.control.wakes()))

    def waited_for(self) -> int:
        """Descriptors that the loop waits for behind a pause, the one that listens among them."""
        self.now_s += control.LONGEST_PAUSE_S
        return len(self.control.wakes())

    def _status(self, _words: list[str]) -> dict[str, Any]:
        self.run.append("status")
        self.now_s += self.took_s
        return {"samples": len(self.run)}

    def _fail(self, _words: list[str]) -> dict[str, Any]:
        raise OSError(5, "Input/output error")


@pytest.fixture
def served(tmp_path: Path) -> Iterator[Served]:
    served = Served(tmp_path / "control")
    with served.stack:
        yield served


def answers(client: socket.socket) -> list[dict[str, Any]]:
    statement = b""
    with suppress(BlockingIOError, ConnectionResetError):
        while chunk := client.recv(1 << 20):
            statement += chunk
    return [json.loads(line) for line in statement.splitlines()]


@pytest.mark.promise("Memory and the end")
def test_a_ninth_client_that_leaves_at_once_is_no_matter(served: Served) -> None:
    """A ninth control client that leaves at once has no effect."""
    for _ in range(8):
        served.client()
    served.turns(8)
    refused = [{"ok": False, "error": "there are 8 clients already"}]
    first = served.client()
    served.turns()
    assert answers(first) == refused
    for statement in (b"", b"status\n", b"status\n" * 2000):
        for _ in range(5):
            with served.client() as gone, suppress(BlockingIOError):
                gone.sendall(statement)
            served.turns()
    ninth = served.client()
    served.turns()
    assert answers(ninth) == refused


def test_a_client_that_leaves_in_the_middle_of_an_answer_is_forgotten(served: Served) -> None:
    """An answer longer than the kernel keeps."""
    with served.client() as gone:
        gone.sendall(b"long\n")
        served.turns(3)
    served.turns(3)
    assert served.waited_for() == 1


def test_a_client_that_has_ended_its_side_gets_every_answer(served: Served) -> None:
    client = served.client()
    client.sendall(b"status\n" * 3)
    client.shutdown(socket.SHUT_WR)
    served.turns(10)
    assert [answer["samples"] for answer in answers(client)] == [1, 2, 3]
    assert client.recv(1) == b""


def test_a_client_that_never_reads_is_asked_nothing_more(served: Served) -> None:
    deaf, second = served.client(), served.client()
    deaf.sendall(b"long\nstatus\nstatus\n")
    served.turns(5)
    second.sendall(b"status\n")
    served.turns(3)
    assert [answer["samples"] for answer in answers(second)] == [1]
    assert len(served.run) == 1


def test_megabytes_without_an_end_of_line_are_refused(served: Served) -> None:
    client = served.client()
    with suppress(BlockingIOError):
        while True:
            client.send(b"x" * 65_536)
    served.turns(3)
    assert answers(client)[0]["error"] == "a command has no more than 256 bytes"
    assert served.waited_for() == 1


def test_a_client_that_says_nothing_gives_way_when_all_places_are_taken(served: Served) -> None:
    """The one that has been silent for longest, and only after ten seconds: a stopped `top` locks nobody out."""
    silent = [served.client() for _ in range(8)]
    served.turns(8)
    served.now_s += control.IDLE_S
    silent[0].sendall(b"status\n")
    served.turns()
    newcomer = served.client()
    newcomer.sendall(b"status\n")
    served.turns(3)
    assert [answer["ok"] for answer in answers(newcomer)] == [True]
    assert silent[1].recv(1) == b""
    assert [answer["ok"] for answer in answers(silent[0])] == [True]


@pytest.mark.promise("Memory and the end")
def test_a_command_that_fails_in_a_way_nobody_foresaw_is_answered(served: Served) -> None:
    """A command that fails unexpectedly is answered."""
    client = served.client()
    client.sendall(b"fail\nstatus\n")
    with structlog.testing.capture_logs() as logged:
        served.turns(4)
    failed, status = answers(client)
    assert failed == {"ok": False, "error": "fail failed: OSError: [Errno 5] Input/output error"}
    assert status == {"ok": True, "samples": 1}
    assert [item["event"] for item in logged] == ["control_failed"]


@pytest.mark.promise("Samples")
@pytest.mark.parametrize("took_s", [0.0, 0.001, 0.02])
def test_a_flood_of_commands_gets_a_tenth_of_the_time(served: Served, took_s: float) -> None:
    """A flood of control commands gets at most a tenth of the loop's time."""
    served.took_s = took_s
    clients = [served.client() for _ in range(8)]
    served.turns(8)
    begun_s, turns = served.now_s, 0
    while served.now_s - begun_s < 10.0:
        for client in clients:
            with suppress(BlockingIOError):
                client.sendall(b"status\n" * 100)
        before = len(served.run)
        served.control.serve(set(served.control.wakes()))
        assert len(served.run) - before <= 1
        served.now_s += max(min(served.control.wake_s(), 0.25), 1e-6)
        turns += 1
    assert turns <= 2000
    assert len(served.run) * took_s <= 1.0 + took_s  # a tenth of 10 s
    counts = [len(answers(client)) for client in clients]
    assert max(counts) - min(counts) <= 1
    assert min(counts) >= 1


def test_without_a_free_descriptor_nobody_is_let_in_and_nothing_ends(
    served: Served, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nor does the loop turn without a pause."""
    monkeypatch.setattr(served.control, "_listening", NoDescriptor(served.control))
    served.client()
    served.turns()
    assert served.control.wake_s() == pytest.approx(control.PAUSE_S)
    assert len(served.control.wakes()) == 0


class NoDescriptor:
    """A listening socket that cannot accept."""

    def __init__(self, of: Control) -> None:
        self._real: socket.socket = of._listening
        self.fileno: Callable[[], int] = self._real.fileno
        self.close: Callable[[], None] = self._real.close

    def accept(self) -> None:
        raise OSError(24, "Too many open files")


STOPPED = """
import os, signal, socket, sys
ends = [socket.socket(socket.AF_UNIX) for _ in range(8)]
for end in ends:
    end.connect(sys.argv[1])
    end.sendall(b"status\\n" * 500)
print("here", flush=True)
os.kill(os.getpid(), signal.SIGSTOP)
"""


@pytest.mark.promise("Memory and the end")
def test_the_service_goes_on_beside_every_kind_of_client(port: Path, tmp_path: Path) -> None:
    """No control client ends the service: it leaves, does not read, sends too much, or is stopped."""
    path = tmp_path / "control"
    with serving(port, "--control", path) as (serve, device):
        serve.until(lambda _: path.exists(), "socket")
        with subprocess.Popen([sys.executable, "-c", STOPPED, str(path)], stdout=subprocess.PIPE) as stopped:
            assert stopped.stdout is not None
            assert stopped.stdout.readline() == b"here\n"
            for number in range(300):
                _come_and_leave(path, number)
            device.send_all(csv_at_100_hz(500), never)
            assert [line["seq"] for line in serve.take_lines(500)] == list(range(500))
            os.kill(stopped.pid, signal.SIGKILL)
        assert serve.stop() == 0
        assert '"service_end"' in serve.log


def _come_and_leave(path: Path, number: int) -> None:
    """Without a word, with half a command, with a command, or with one side closed."""
    with socket.socket(socket.AF_UNIX) as client:
        client.setblocking(False)
        with suppress(OSError):  # the queue of those who wait is full
            client.connect(str(path))
            client.send((b"", b"stat", b"status\n", b"zero\n" * 100)[number % 4])
            if number % 3 == 0:
                client.shutdown(socket.SHUT_WR)


@pytest.mark.promise("Memory and the end")
def test_a_broken_pipe_of_the_service_itself_is_a_failure(tmp_path: Path) -> None:
    """An unexpected end has a status other than 0; only a broken pipe of stdout is normal."""
    broken = "import sys\nfrom gyrodrift.cli import main, serve\n"
    broken += "def run(_):\n    raise BrokenPipeError(32, 'Broken pipe')\n"
    broken += "serve.run = run\nsys.exit(main(['serve', '--port', 'nowhere']))\n"
    ended = subprocess.run([sys.executable, "-c", broken], capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stderr) == (2, "gyrodrift: output: Broken pipe\n")


@pytest.mark.promise("Memory and the end")
def test_a_recording_that_fails_says_so_though_nobody_reads_its_paths(port: Path, tmp_path: Path) -> None:
    """A failed recording has a status other than 0, even if nobody reads its paths."""
    with Command("record", "--port", port, "--out", tmp_path, "--timeout", "0.2") as record:
        record.close_stdout()
        assert record.end() != 0
