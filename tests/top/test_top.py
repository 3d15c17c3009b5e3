"""`gyrodrift top` on a running service, in a terminal of the test."""

import os
import pty
import re
import select
import subprocess
import sys
import time
from pathlib import Path

import pytest
from outputs_support import address_of, connected, csv_at_100_hz, serving
from rich.console import Console
from support import PATIENCE_S, Command, never

from gyrodrift.outputs.status import ClientStatus, FilterStatus, LinkStatus, OutputStatus, ServiceStatus
from gyrodrift.top.view import draw, sparkline

ESCAPES = re.compile(r"\x1b\[[0-9;?]*[A-Za-z]")


class Terminal:
    """What a program writes on a pty, without colours and cursor moves, and what is typed there."""

    def __init__(self, *words: str | Path) -> None:
        self._fd, theirs = pty.openpty()
        command = [sys.executable, "-m", "gyrodrift", *map(str, words)]
        environ = os.environ | {"TERM": "xterm", "COLUMNS": "100", "LINES": "40"}
        self.process = subprocess.Popen(command, stdin=theirs, stdout=theirs, stderr=theirs, env=environ)
        os.close(theirs)
        self.shown = ""

    def type(self, keys: str) -> None:
        self.shown = ""
        os.write(self._fd, keys.encode())

    def until(self, pattern: str) -> str:
        """Read until something is shown; it."""
        until_s = time.monotonic() + PATIENCE_S
        while not (found := re.search(pattern, self.shown)):
            assert time.monotonic() < until_s, f"no {pattern!r} in:\n{self.shown}"
            if select.select([self._fd], [], [], 0.1)[0]:
                self.shown += ESCAPES.sub("", os.read(self._fd, 1 << 16).decode(errors="replace"))
        return found[0]

    def hang_up(self) -> int:
        """Close the terminal, as a window is closed; the status, as soon as it has ended by itself."""
        os.close(self._fd)
        return self.process.wait(PATIENCE_S)

    def end(self) -> int:
        status = self.process.wait(PATIENCE_S)
        os.close(self._fd)
        return status


def test_a_service_is_watched_zeroed_and_waited_for(port: Path, tmp_path: Path) -> None:
    """All that a person looks for, and each key."""
    path = tmp_path / "control"
    with serving(port, "--filter", "hdr", "--control", path, "--output", "tcp:port=0") as (serve, device):
        with connected(address_of(serve, "tcp")):
            device.send_all(csv_at_100_hz(201), never)
            serve.take_lines(201)
            top = Terminal("top", path)
            top.until(r"Yaw +\+20\.00 deg")
            for label in ("Drift estimate", "At rest", "Temperature +25.0 °C", "Sample rate", "Jitter", "Gaps +0"):
                top.until(label)
            top.until("127.0.0.1:")
            top.type("z")
            top.until(r"Yaw +\+0\.00 deg")
            top.until("yaw is 0")
            top.type("p")
            top.until("paused")
            top.type("p")
        assert serve.stop() == 0
        top.until("waiting")
        top.type("q")
        assert top.end() == 0


def test_it_ends_with_its_terminal(port: Path, tmp_path: Path) -> None:
    """Where nobody tells it by a signal, it notices; and leaves the service alone."""
    path = tmp_path / "control"
    with serving(port, "--control", path) as (serve, _):
        top = Terminal("top", path)
        top.until("Yaw")
        assert top.hang_up() == 0
        assert serve.stop() == 0


def test_without_a_terminal_the_state_is_printed_once(port: Path, tmp_path: Path) -> None:
    """For a script."""
    path = tmp_path / "control"
    with serving(port, "--filter", "hdr", "--control", path) as (serve, device):
        device.send_all(csv_at_100_hz(101), never)
        serve.take_lines(101)
        with Command("top", path) as top:
            assert top.end() == 0
        assert "+10.00 deg" in top.out
        assert serve.stop() == 0
    with Command("top", path) as top:
        assert top.end() == 2
    assert "there is no such socket; is serve running with --control?" in top.log


def test_clients_and_what_is_wrong_are_shown() -> None:
    """In the words of the page."""
    clients = tuple(ClientStatus(f"127.0.0.1:{50_000 + n}", 100, n) for n in range(10))
    status = ServiceStatus(
        link=LinkStatus(port="/dev/gyro", is_open=True, samples=10, damaged=3, gaps=1, missing=7),
        filter=FilterStatus(yaw_deg=1.0, yaw_sigma_deg=0.5, bias_dps=-0.25, bias_sigma_dps=0.01, rest_probability=0.97),
        outputs=(OutputStatus("tcp", "127.0.0.1:7117", "", clients, 10, 1000, 45),),
    )
    console = Console(width=100, file=open(os.devnull, "w"), record=True)  # noqa: PTH123, SIM115 - closed below
    console.print(draw(status, [0.0, 1.0]))
    console.file.close()
    shown = console.export_text()
    for said in ("+1.00 ± 0.50 deg", "-0.2500 ± 0.0100 deg/s", "97%", "1 (7 samples)", "127.0.0.1:50007", "and 2 more"):
        assert said in shown
    assert "3 frames arrived damaged (23.1%); look at cable, ground and baud." in shown


@pytest.mark.parametrize(
    ("values", "expected"),
    [([], ""), ([1.0], "▁"), ([0.0, 7.0], "▁█"), ([0.0, 0.01], "▁▁"), (list(range(8)), "▁▂▃▄▅▆▇█")],
)
def test_a_sparkline_goes_from_the_least_to_the_most(values: list[float], expected: str) -> None:
    """And noise is flat."""
    assert sparkline(values) == expected
