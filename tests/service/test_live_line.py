"""`serve` on a terminal: one line that is updated in place, log lines above it, and a sentence at the end."""

import os
import pty
import re
import select
import signal
import termios
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pyte
import pytest
from outputs_support import corrected, csv_at_100_hz, tilted
from support import Terminal, free_port, never, ours, speaking_on

from firmware_sim.pty import PtyDevice
from gyrodrift.service.live_line import ServiceLine


@contextmanager
def on_terminal(port: Path, *options: str | Path, columns: int = 120) -> Iterator[tuple[Terminal, PtyDevice]]:
    """`serve` on a terminal, reading a device that the test speaks for."""
    with (
        speaking_on(port) as device,
        Terminal(*ours("serve", "--port", port, *options), columns=columns, rows=24) as terminal,
    ):
        device.wait_for_reader(never)
        yield terminal, device


@pytest.mark.promise("Samples")
def test_a_terminal_shows_one_line_below_the_log_and_ends_with_a_sentence(port: Path) -> None:
    """On a terminal, `serve` shows one line below the log, and ends with a sentence."""
    with on_terminal(port) as (terminal, device):
        device.send_all(csv_at_100_hz(300), never)
        terminal.until(lambda it: "yaw +" in it.text, "yaw")
        lines = terminal.text.rstrip().split("\n")
        assert " deg   bias " in lines[-1]
        assert "rest " in lines[-1]
        assert lines[-1].rstrip().endswith("link ok")
        assert "  Filter restlevel, at its defaults." in terminal.text
        assert terminal.text.count("yaw +") == 1
        assert "{" not in terminal.text
        terminal.process.send_signal(signal.SIGTERM)
        assert terminal.end() == 0
        last = terminal.text.rstrip().split("\n")[-1]
        assert "300 samples in " in last
        assert " s, 0 lost, yaw +" in last
        assert last.rstrip().endswith(" deg at the end.")


@pytest.mark.parametrize("columns", [80, 200])
def test_each_fact_is_a_line_in_words_and_the_live_line_stays_at_the_bottom(port: Path, columns: int) -> None:
    """The process of the outputs writes above the line too, and no line is cut within a word."""
    page = free_port()
    with on_terminal(port, "--output", f"web:port={page}", columns=columns) as (terminal, device):
        device.send_all(csv_at_100_hz(300), never)
        terminal.until(lambda it: f"Open http://127.0.0.1:{page}" in it.text, "page")
        device.send_all(csv_at_100_hz(100, first=300), never)
        terminal.until(lambda it: "link ok" in it.text.rstrip().rpartition("\n")[2], "line")
        *facts, line = terminal.text.rstrip().split("\n")
        assert line.startswith("yaw +")
        assert all(re.match(r"\d\d:\d\d:\d\d  [A-Z]|          \S", fact) for fact in facts)
        assert "=" not in terminal.text
        assert f"  Open http://127.0.0.1:{page}" in [fact.rstrip()[8:] for fact in facts]


def test_a_lost_sample_and_silence_are_on_the_line(port: Path) -> None:
    """The counters of the link stand in place of `link ok`."""
    with on_terminal(port) as (terminal, device):
        device.send_all(csv_at_100_hz(100) + csv_at_100_hz(100, first=103), never)
        terminal.until(lambda it: "silent for " in it.text, "silence")
        assert "yaw +" in terminal.text


@pytest.mark.parametrize("columns", [40, 80])
def test_the_line_never_wraps(port: Path, columns: int) -> None:
    """A narrow terminal shows the beginning of it."""
    with on_terminal(port, "--log-level", "error", columns=columns) as (terminal, device):
        device.send_all(csv_at_100_hz(300), never)
        terminal.until(lambda it: "yaw +" in it.text, "yaw")
        assert terminal.text.count("\n") == terminal.text.rstrip().count("\n") + 23


@pytest.mark.promise("Samples")
def test_json_lines_come_on_a_terminal_when_they_are_asked_for(port: Path) -> None:
    """With `--json`, `serve` prints JSON lines on a terminal, too."""
    with on_terminal(port, "--json", "--quiet") as (terminal, device):
        device.send_all(csv_at_100_hz(100), never)
        terminal.until(lambda it: '"yaw_deg":' in it.text, "JSON")
        assert "link ok" not in terminal.text


@pytest.mark.promise("Memory and the end")
@pytest.mark.parametrize("name", ["gyro\udcff", "陀螺" * 20, "a\u202eb\x1b[31m", "x" * 99], ids=ascii)
@pytest.mark.parametrize("columns", [2, 20, 60])
def test_any_name_of_a_port_fits_on_the_line(name: str, columns: int) -> None:
    """No name of a port ends the service or breaks its line on a terminal."""
    screen = pyte.Screen(columns, 2)
    master, slave = pty.openpty()
    try:
        termios.tcsetwinsize(slave, (2, columns))
        link: Any = SimpleNamespace(name=name, counters=SimpleNamespace(samples=0))
        line = ServiceLine(link, slave)
        for now_s in range(3):
            line.tick(float(now_s))
        sent = os.read(master, 1 << 16)
    finally:
        os.close(master)
        os.close(slave)
    pyte.ByteStream(screen).feed(sent)
    assert screen.cursor.y == 0
    assert screen.display[0].startswith("waiting for samples"[: columns - 1])
    assert "\u202e" not in sent.decode()


def test_a_tilted_device_has_roll_and_pitch_on_the_line() -> None:
    master, slave = pty.openpty()
    try:
        counters = SimpleNamespace(samples=1, missing=0)
        link: Any = SimpleNamespace(name="gyro", counters=counters, decoder=None, silent_s=lambda: 0.0)
        line = ServiceLine(link, slave)
        line.take([tilted(1)])
        line.tick(1.0)
        assert "roll +10.0 pitch -20.0 deg" in line.text()
        line.take([corrected(2)])
        assert "roll" not in line.text()
    finally:
        os.close(master)
        os.close(slave)


@pytest.mark.promise("Memory and the end")
def test_a_terminal_of_another_user_shows_the_whole_line(monkeypatch: pytest.MonkeyPatch) -> None:
    """After `su`, the terminal shows the whole line."""
    really_open = os.open

    def refuse(path: str, *rest: Any, **options: Any) -> int:
        if str(path).startswith("/proc/self/fd/"):
            raise PermissionError(13, "Permission denied")
        return really_open(path, *rest, **options)

    monkeypatch.setattr(os, "open", refuse)
    master, slave = pty.openpty()
    try:
        link: Any = SimpleNamespace(name="gyro", counters=SimpleNamespace(samples=0))
        ServiceLine(link, slave).tick(0.0)
        sent = b""
        while select.select([master], [], [], 0.5)[0]:  # single bytes arrive one after the other
            sent += os.read(master, 1 << 16)
        assert sent.endswith(b"waiting for samples on gyro")
    finally:
        os.close(master)
        os.close(slave)
