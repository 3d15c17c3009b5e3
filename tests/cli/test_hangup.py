"""A terminal that goes away, as that of a broken ssh connection does: what was begun is ended well, or goes on."""

import os
import pty
import select
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from io import RawIOBase
from pathlib import Path

import pytest
from mcap.reader import make_reader
from support import PATIENCE_S, are_recorded, never, speaking_on

from firmware_sim.pty import PtyDevice
from firmware_sim.wire.csv import csv_line

ON_A_TERMINAL = """
import fcntl, os, signal, sys, termios
os.setsid()
fcntl.ioctl(0, termios.TIOCSCTTY, 0)
signal.signal(signal.SIGHUP, getattr(signal, sys.argv[1]))
os.execv(sys.executable, [sys.executable, "-m", "gyrodrift", *sys.argv[2:]])
"""


@contextmanager
def on_a_terminal(hangup: str, *arguments: str | Path) -> Iterator[tuple["subprocess.Popen[bytes]", RawIOBase]]:
    """The command on a terminal of its own, which goes away when it is closed."""
    ours, theirs = pty.openpty()
    command = [sys.executable, "-c", ON_A_TERMINAL, hangup, *map(str, arguments)]
    process = subprocess.Popen(command, stdin=theirs, stdout=theirs, stderr=theirs)
    os.close(theirs)
    with os.fdopen(ours, "rb", buffering=0) as terminal:
        try:
            yield process, terminal
        finally:
            process.kill()
            process.wait()


def send_samples(device: PtyDevice, folder: Path, terminal: RawIOBase) -> None:
    """A hundred; back when nearly all have been written. What is written to a terminal has to be read meanwhile."""
    device.wait_for_reader(never)
    device.send_all(b"".join(csv_line(10_000 * i, 0.25, None, None) for i in range(100)), never)
    until_s = time.monotonic() + PATIENCE_S
    while not are_recorded(90, folder):
        assert time.monotonic() < until_s
        if select.select([terminal], [], [], 0.05)[0]:
            terminal.read(1 << 16)


@pytest.mark.parametrize("command", ["record", "serve"])
def test_without_its_terminal_it_ends_with_a_closed_file(command: str, tmp_path: Path) -> None:
    """Status 0, as with any other signal to stop."""
    out = tmp_path / "out"
    option = "--out" if command == "record" else "--record"
    with (
        speaking_on(tmp_path / "gyro") as device,
        on_a_terminal("SIG_DFL", command, "--port", tmp_path / "gyro", option, out) as (process, terminal),
    ):
        send_samples(device, out, terminal)
        terminal.close()
        assert process.wait(PATIENCE_S) == 0
    with next(out.glob("*.mcap")).open("rb") as file:
        assert sum(1 for _ in make_reader(file, validate_crcs=True).iter_messages(["/gyro"])) >= 99


def test_under_nohup_it_goes_on(tmp_path: Path) -> None:
    out = tmp_path / "out"
    with (
        speaking_on(tmp_path / "gyro") as device,
        on_a_terminal("SIG_IGN", "record", "--port", tmp_path / "gyro", "--out", out, "--log-level", "error") as (
            process,
            terminal,
        ),
    ):
        send_samples(device, out, terminal)
        process.send_signal(signal.SIGHUP)
        with pytest.raises(subprocess.TimeoutExpired):
            process.wait(0.5)
        process.terminate()
        assert process.wait(PATIENCE_S) == 0
