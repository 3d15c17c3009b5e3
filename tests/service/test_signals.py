"""Signals that ask to stop: once is enough, twice in a moment is once, and again is now."""

import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from support import PATIENCE_S, Command, are_recorded, never, speaking_on

from gyrodrift.session.mcap.read import read_mcap

HANGS = """
import os, sys, time
from gyrodrift.cli import main
os.fsync = lambda fd: None if os.path.isdir(f"/proc/self/fd/{fd}") else time.sleep(1e6)
sys.exit(main(sys.argv[1:]))
"""
LINES = b"".join(b"%d,%d\n" % (i * 10_000, i) for i in range(200))


@pytest.mark.parametrize("command", ["record", "serve"])
def test_a_disk_that_hangs_keeps_nobody_who_asks_again(command: str, port: Path, tmp_path: Path) -> None:
    """The first signal waits for it; the second ends the process, and what was written stays readable."""
    out = tmp_path / "out"
    words = [command, "--port", str(port), "--record" if command == "serve" else "--out", str(out)]
    with speaking_on(port) as device:
        process = subprocess.Popen(
            [sys.executable, "-c", HANGS, *words], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        try:
            device.wait_for_reader(never)
            device.send_all(LINES, never)
            until_s = time.monotonic() + PATIENCE_S
            while not (out.is_dir() and are_recorded(200, out)) and time.monotonic() < until_s:
                time.sleep(0.02)
            process.send_signal(signal.SIGTERM)
            with pytest.raises(subprocess.TimeoutExpired):
                process.wait(1.5)
            process.send_signal(signal.SIGTERM)
            assert process.wait(PATIENCE_S) == -signal.SIGTERM
        finally:
            process.kill()
            process.wait()
    (path,) = out.glob("*.mcap")
    assert read_mcap(path).rate_dps.tolist() == [float(i) for i in range(200)]


def test_two_signals_in_a_moment_are_one(port: Path) -> None:
    """`timeout` and terminals send them so; the end is an orderly one."""
    with speaking_on(port) as device, Command("serve", "--port", port) as serve:
        device.wait_for_reader(never)
        device.send_all(LINES, never)
        serve.take_lines(100)
        serve.process.send_signal(signal.SIGTERM)
        assert serve.stop(signal.SIGINT) == 0
        assert "service_end" in serve.log
