"""`gyrodrift demo`: a simulated device, a real service, and the yaw error against the encoder."""

import io
import os
import re
import signal
import subprocess
import time
from pathlib import Path
from typing import Any

import pytest
from rich.console import Console
from support import Command, Terminal, ended_here, ours

from gyrodrift.demo import show
from gyrodrift.demo.show import run_demo, save_svg
from gyrodrift.demo.view import Size, YawError, draw

SIZES = [(60, 15), (61, 16), (80, 24), (100, 30), (133, 41), (250, 80)]


def test_without_a_terminal_it_prints_the_summary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Corrected yaw is nearer to the encoder than the integrated rate, on the shipped rig and config."""
    start = show._process

    def patient(words: list[str], *streams: Any) -> Any:
        return start(["tests.patient_device" if word == "firmware_sim" else word for word in words], *streams)

    monkeypatch.setattr(show, "_process", patient)  # a device that waits for its reader
    demo = ended_here("demo", "--duration", "20", "--speed", "10", "--svg", tmp_path / "demo.svg")
    assert demo.status == 0, demo.log
    errors = [float(text) for text in re.findall(r"mean \|error\| +([0-9.]+) deg", demo.out)]
    assert len(errors) == 2
    raw_deg, corrected_deg = errors
    assert 1.0 < raw_deg < 10.0
    assert corrected_deg < 0.5 * raw_deg
    picture = (tmp_path / "demo.svg").read_text()
    assert "<svg" in picture
    assert picture.count("table&#160;(encoder)") == 1, "one view"
    assert len(picture) < 100_000


def test_the_picture_is_the_same_whatever_the_terminal_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pictures = []
    for number, environment in enumerate([{}, {"TERM": "dumb"}, {"NO_COLOR": "1", "COLUMNS": "30"}, {"TERM": "xterm"}]):
        for name, value in environment.items():
            monkeypatch.setenv(name, value)
        error = YawError()
        error.add({"t_s": 0.0, "rate_dps": 90.0, "bias_dps": 0.35, "yaw_deg": 9.0, "encoder_deg": 8.9})
        save_svg(tmp_path / f"{number}.svg", error, 60.0)
        pictures.append((tmp_path / f"{number}.svg").read_text())
    assert set(pictures) == {pictures[0]}
    assert "table&#160;(encoder)" in pictures[0]


def test_the_integrated_rate_of_a_constant_acceleration_has_no_error() -> None:
    error = YawError()
    for index in range(100):
        t_s = index / 100.0
        line = {"t_s": t_s, "rate_dps": 200.0 * t_s, "bias_dps": 0.0, "yaw_deg": 0.0, "encoder_deg": 100.0 * t_s**2}
        error.add(line)
    assert abs(error.raw_error_deg) < 1e-9


@pytest.mark.parametrize(("columns", "rows"), SIZES)
def test_the_view_fills_a_terminal_of_any_size(columns: int, rows: int) -> None:
    error = YawError()
    for index in range(500):
        error.add(
            {"t_s": index / 10, "rate_dps": 90.0, "bias_dps": 0.35, "yaw_deg": index * 9.0, "encoder_deg": index * 8.9}
        )
    console = Console(width=columns, height=rows, file=io.StringIO(), force_terminal=True, color_system=None)
    with console.capture() as shown:
        console.print(draw(error, 60.0, "gyro", Size(columns, rows)))
    lines = shown.get().splitlines()
    assert [len(line) for line in lines] == [columns] * rows
    text = "\n".join(lines)
    for word in (
        "500 samples",
        "bias +0.350 deg/s",
        "table (encoder)",
        "+49.900°",
        "╌╌ raw integration   ── gyrodrift",
    ):
        assert word in text
    assert "…" not in text.replace("+180° … -180°", "")


def test_on_a_terminal_it_is_live_fits_and_follows_its_size() -> None:
    with Terminal(*ours("demo", "--duration", "30", "--speed", "5"), columns=60, rows=15) as terminal:
        terminal.until(lambda shown: frame_of(shown) == (60, 15), "view of 60×15")
        terminal.until(lambda shown: re.search(r"[1-9]\d* samples", shown.text) is not None, "sample")
        terminal.resize(120, 40)
        terminal.until(lambda shown: frame_of(shown) == (120, 40), "view of 120×40")
        terminal.resize(40, 10)
        terminal.until(lambda shown: "the view needs 60×15" in shown.text, "word on what it wants")
        terminal.resize(80, 24)
        assert terminal.end() == 0
        lines = [line.rstrip() for line in terminal.screen.display]
    assert any(line.startswith("╭─") for line in lines)
    assert any("mean |error|" in line and "gyrodrift" in line for line in lines)


def frame_of(terminal: Terminal) -> tuple[int, int]:
    """Columns and rows from the first corner to the last."""
    lines = terminal.screen.display
    if not (lines[0].startswith("╭") and lines[-1].startswith("╰")):
        return 0, 0
    return (len(lines[0]) if lines[0][-1] == "╮" and lines[-1][-1] == "╯" else 0), len(lines)


def test_an_interrupt_gives_the_terminal_back() -> None:
    """The screen of before is there again."""
    with Terminal(*ours("demo")) as terminal:
        terminal.until(lambda shown: frame_of(shown) == (80, 24), "view")
        terminal.process.send_signal(signal.SIGINT)
        assert terminal.end() == 130
        assert b"\x1b[?1049l" in terminal.sent
        assert b"\x1b[?25h" in terminal.sent


@pytest.mark.parametrize("ending", [signal.SIGTERM, signal.SIGHUP], ids=lambda item: item.name)
def test_a_terminal_that_is_closed_leaves_no_process_behind(ending: signal.Signals) -> None:
    with Terminal(*ours("demo")) as terminal:
        terminal.until(lambda shown: frame_of(shown) == (80, 24), "view")
        terminal.until(lambda _: len(children_of(terminal.process.pid)) == 2, "device and service")
        begun = children_of(terminal.process.pid)
        terminal.process.send_signal(ending)
        assert terminal.end() == 130
    assert not any(Path(f"/proc/{pid}").exists() for pid in begun)


@pytest.mark.parametrize("nth", [0, 1], ids=["device", "service"])
def test_an_end_while_a_process_begins_leaves_none_behind(nth: int, monkeypatch: pytest.MonkeyPatch) -> None:
    begun: list[subprocess.Popen[bytes]] = []
    popen = subprocess.Popen

    def interrupted(*given: Any, **named: Any) -> "subprocess.Popen[bytes]":
        begun.append(popen(*given, **named))
        if len(begun) == nth + 1:
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(0.0)  # here Python sees to its signals
        return begun[-1]

    monkeypatch.setattr(subprocess, "Popen", interrupted)
    with pytest.raises(KeyboardInterrupt):
        run_demo(60.0, None, None, "turntable", 1.0, 1, None, is_quiet=True)
    assert len(begun) == nth + 1
    assert all(process.returncode is not None for process in begun)


def children_of(pid: int) -> list[str]:
    """Processes that a process has begun."""
    return Path(f"/proc/{pid}/task/{pid}/children").read_text().split()


def test_without_colours_it_is_plain() -> None:
    """NO_COLOR takes red and green out of the view."""
    with Terminal(*ours("demo"), environment={"NO_COLOR": "1"}) as terminal:
        terminal.until(lambda shown: frame_of(shown) == (80, 24), "view")
        terminal.process.send_signal(signal.SIGINT)
        assert terminal.end() == 130
    assert not re.search(rb"\x1b\[(?:\d+;)*3[0-7]m", terminal.sent)


def test_a_bad_profile_is_told_before_anything_begins() -> None:
    with Command("demo", "--profile", "nowhere") as demo:
        assert demo.end() == 2
    assert "--profile nowhere: there is no such profile or file; there are " in demo.log
    assert "Traceback" not in demo.log


def test_a_bad_rig_is_told_on_a_terminal_too(tmp_path: Path) -> None:
    (tmp_path / "rig.yaml").write_text("base: {bias: 1}\n")
    with Terminal(*ours("demo", "--rig", tmp_path / "rig.yaml"), columns=200) as terminal:
        assert terminal.end() == 3
        assert "bias" in terminal.text
        assert "the simulated device did not start" in terminal.text
