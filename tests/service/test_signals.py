"""Signals that ask to stop: once is enough, twice in a moment is once, and again is now."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from mcap.reader import make_reader
from support import PATIENCE_S, Command, are_recorded, never, ours, speaking_on

from gyrodrift.service.signals import StopSignal
from gyrodrift.session.mcap.read import read_mcap

HANGS = """
import os, sys, time
from gyrodrift.cli import main
os.fsync = lambda fd: None if os.path.isdir(f"/proc/self/fd/{fd}") else time.sleep(1e6)
sys.exit(main(sys.argv[1:]))
"""
AGAIN_S = 1.5
"""From one signal to the next; a busy machine may deliver two of them in one moment, and then a third one counts."""

RATES = [(i % 16) / 8.0 for i in range(5000)]
LINES = [b"%d,%.3f\n" % (i * 10_000, rate_dps) for i, rate_dps in enumerate(RATES)]


@pytest.mark.promise("Memory and the end")
@pytest.mark.parametrize("command", ["record", "serve"])
def test_a_disk_that_hangs_keeps_nobody_who_asks_again(command: str, port: Path, tmp_path: Path) -> None:
    """A second signal, one second later, ends at once, even if a disk hangs."""
    out = tmp_path / "out"
    words = [command, "--port", str(port), "--record" if command == "serve" else "--out", str(out)]
    with speaking_on(port) as device:
        process = subprocess.Popen(
            [sys.executable, "-c", HANGS, *words], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        try:
            device.wait_for_reader(never)
            device.send_all(b"".join(LINES[:200]), never)
            until_s = time.monotonic() + PATIENCE_S
            while not (out.is_dir() and are_recorded(200, out)) and time.monotonic() < until_s:
                time.sleep(0.02)
            process.send_signal(signal.SIGTERM)
            with pytest.raises(subprocess.TimeoutExpired):
                process.wait(AGAIN_S)
            until_s = time.monotonic() + PATIENCE_S
            while process.poll() is None and time.monotonic() < until_s:
                process.send_signal(signal.SIGTERM)
                time.sleep(AGAIN_S)
            assert process.wait(PATIENCE_S) == -signal.SIGTERM
        finally:
            process.kill()
            process.wait()
    (path,) = out.glob("*.mcap")
    assert read_mcap(path).rate_dps.tolist() == RATES[:200]


def test_afterwards_signals_do_what_they_did_before() -> None:
    handled: list[int] = []
    before = signal.signal(signal.SIGTERM, lambda number, _: handled.append(number))
    try:
        with StopSignal() as stop:
            signal.raise_signal(signal.SIGTERM)
            assert stop.is_set
            assert os.read(stop.fd, 1) == bytes([signal.SIGTERM])
        assert not handled
        signal.raise_signal(signal.SIGTERM)
        assert handled == [signal.SIGTERM]
        with pytest.raises(OSError, match="Bad file descriptor"):
            os.fstat(stop.fd)
    finally:
        signal.signal(signal.SIGTERM, before)


def test_two_signals_in_a_moment_are_one(port: Path) -> None:
    """`timeout` and terminals send them so; the end is an orderly one."""
    with speaking_on(port) as device, Command("serve", "--port", port) as serve:
        device.wait_for_reader(never)
        device.send_all(b"".join(LINES[:200]), never)
        serve.take_lines(100)
        for number in (signal.SIGSTOP, signal.SIGTERM, signal.SIGINT):  # both wait, and arrive in the same moment
            serve.process.send_signal(number)
        assert serve.stop(signal.SIGCONT) == 0
        assert "service_end" in serve.log


@pytest.mark.promise("Memory and the end")
@pytest.mark.parametrize("takes", [0, 64])
def test_a_slow_reader_does_not_hold_up_the_end(takes: int, port: Path, tmp_path: Path) -> None:
    """SIGINT and SIGTERM close the recording first and end within 2 s, even with a slow reader of stdout."""
    read_fd, write_fd = os.pipe()
    command = ours(
        "serve", "--port", port, "--record", tmp_path / "out", "--log-format", "json", "--output", "tcp:port=0"
    )
    with speaking_on(port) as device:
        process = subprocess.Popen(command, stdout=write_fd, stderr=subprocess.PIPE)
        os.close(write_fd)
        try:
            device.wait_for_reader(never)
            device.send_all(b"".join(LINES), never)
            until_s = time.monotonic() + PATIENCE_S
            while not are_recorded(5000, tmp_path / "out") and time.monotonic() < until_s:
                time.sleep(0.02)
            process.send_signal(signal.SIGTERM)
            until_s = time.monotonic() + PATIENCE_S
            while process.poll() is None and time.monotonic() < until_s:
                time.sleep(0.3)
                if takes:
                    os.read(read_fd, takes)
            assert process.poll() == 0
            assert process.stderr is not None
            (end,) = [json.loads(line) for line in process.stderr if b'"service_end"' in line]
        finally:
            process.kill()
            process.wait()
            os.close(read_fd)
            if process.stderr is not None:
                process.stderr.close()
    assert end["lines_dropped"] > 0
    (path,) = (tmp_path / "out").glob("*.mcap")
    with path.open("rb") as file:
        assert make_reader(file, validate_crcs=True).get_summary() is not None
    assert read_mcap(path).rate_dps.tolist() == RATES
