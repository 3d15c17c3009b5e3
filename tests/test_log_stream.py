"""Standard error that nobody reads: nothing waits for it, and what was dropped is told."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import pytest
from support import PATIENCE_S, are_recorded, never, speaking_on

from gyrodrift.io.log import LONGEST_KEPT, UnwaitingStream

LINE = "timestamp=now level=info event=something number=1\n"


@pytest.fixture
def pipe() -> Iterator[tuple[int, int]]:
    """Both ends."""
    ends = os.pipe()
    yield ends
    for end in ends:
        try:
            os.close(end)
        except OSError:
            continue  # the test closed it


def all_of(fd: int) -> bytes:
    os.set_blocking(fd, False)
    result = b""
    while True:
        try:
            piece = os.read(fd, 1 << 16)
        except BlockingIOError:
            return result
        if not piece:
            return result
        result += piece


def fill(fd: int) -> None:
    os.set_blocking(fd, False)
    with suppress(BlockingIOError):
        while True:
            os.write(fd, b"x" * 4096)
    os.set_blocking(fd, True)


def test_what_is_read_arrives_at_once(pipe: tuple[int, int]) -> None:
    with os.fdopen(pipe[1], "w") as end:
        stream = UnwaitingStream(end, str)
        for number in range(3):
            stream.write(f"{number}\n")
        assert all_of(pipe[0]) == b"0\n1\n2\n"


def test_a_pipe_that_nobody_empties_stops_nothing(pipe: tuple[int, int]) -> None:
    """Whole lines are dropped, and their number comes with what is read later."""
    with os.fdopen(pipe[1], "w") as end:
        stream = UnwaitingStream(end, lambda lines: f"dropped {lines}\n")
        written = 20_000
        for _ in range(written):
            stream.write(LINE)
        result = all_of(pipe[0])
        while result[-1:] != b"\n" or b"dropped" not in result:
            stream.flush()
            result += all_of(pipe[0])
    lines = result.decode().splitlines(keepends=True)
    report = [int(line.split()[1]) for line in lines if line.startswith("dropped")]
    assert len(report) == 1
    assert lines.count(LINE) + report[0] == written
    assert set(lines) == {LINE, f"dropped {report[0]}\n"}
    assert len(lines.count(LINE) * LINE) >= LONGEST_KEPT - len(LINE)


def test_a_reader_that_is_gone_is_no_error(pipe: tuple[int, int]) -> None:
    os.close(pipe[0])
    with os.fdopen(pipe[1], "w") as end:
        assert UnwaitingStream(end, str).write(LINE) == len(LINE)


def test_a_stopped_terminal_stops_nothing() -> None:
    """Ctrl-S, by the terminal's own switch; after Ctrl-Q the rest comes."""
    import termios  # noqa: PLC0415

    controller, terminal = os.openpty()
    with os.fdopen(terminal, "w") as end:
        stream = UnwaitingStream(end, str)
        termios.tcflow(terminal, termios.TCOOFF)
        for _ in range(5000):
            stream.write(LINE)
        termios.tcflow(terminal, termios.TCOON)
        stream.flush()
        assert LINE.strip() in all_of(controller).decode()
    os.close(controller)


TWO_LOGS = """
import sys
from gyrodrift.io.log import open_log
log = open_log(style="json")
for number in range(5000):
    log.info("something", of=sys.argv[1], number=number)
"""


def test_lines_of_two_processes_stay_whole(pipe: tuple[int, int]) -> None:
    logs = [subprocess.Popen([sys.executable, "-c", TWO_LOGS, name], stderr=pipe[1]) for name in ("a", "b")]
    os.close(pipe[1])
    with os.fdopen(pipe[0]) as end:
        read = [json.loads(line) for line in end]
    assert [log.wait() for log in logs] == [0, 0]
    for name in ("a", "b"):
        numbers = [item["number"] for item in read if item.get("of") == name]
        assert numbers == sorted(set(numbers))
        assert numbers


REFUSED = """
import os, sys
from gyrodrift.io.log import UnwaitingStream
os.setuid(65534)  # of a pipe of root, as in a container with a user of its own
try:
    os.open("/proc/self/fd/2", os.O_WRONLY)
except PermissionError:
    stream = UnwaitingStream(sys.stderr, "dropped {}\\n".format)
    for number in range(5000):
        stream.write(f"line {number:4} with the usual length of something that is logged\\n")
    print("done", flush=True)
"""


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can become somebody who may not")
def test_a_log_that_may_not_be_opened_anew_is_written_all_the_same() -> None:
    done = subprocess.run([sys.executable, "-c", REFUSED], capture_output=True, text=True, check=True)
    lines = done.stderr.splitlines()
    assert done.stdout == "done\n"
    assert lines[:100] == [f"line {i:4} with the usual length of something that is logged" for i in range(100)]


@pytest.mark.promise("Samples")
@pytest.mark.parametrize("command", ["record", "serve"])
def test_a_log_that_nobody_reads_costs_no_sample(command: str, tmp_path: Path, pipe: tuple[int, int]) -> None:
    """An unread log, or a stopped terminal, costs no sample."""
    fill(pipe[1])
    port, out = tmp_path / "gyro", tmp_path / "out"
    words = ["--port", str(port), *(["--out", str(out)] if command == "record" else ["--record", str(out)])]
    with speaking_on(port) as device:
        process = subprocess.Popen(
            [sys.executable, "-m", "gyrodrift", command, *words, "--log-level", "debug"],
            stderr=pipe[1],
            stdout=subprocess.DEVNULL,
        )
        try:
            deadline_s, first = time.monotonic() + PATIENCE_S, 0
            while not (out.is_dir() and are_recorded(1000, out)) and time.monotonic() < deadline_s:
                device.send_all(b"".join(b"%d,0.5\n" % (i * 10_000) for i in range(first, first + 100)), never)
                first += 100
                time.sleep(0.1)
            assert are_recorded(1000, out)
            process.send_signal(signal.SIGTERM)
            assert process.wait(PATIENCE_S) == 0
        finally:
            process.kill()
            process.wait()
