"""`gyrodrift doctor --turn` with the real command over a real pty: the boards turn when they are asked to."""

import json
import math
import time
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from support import Command, speaking_on

from firmware_sim.pty import PtyDevice
from gyrodrift.cli import main
from gyrodrift.doctor.turn.listen import DONE, STILL, TURN
from gyrodrift.session.files import write_session
from gyrodrift.session.session import Session
from gyrodrift.values.arrays import Floats

RATE_HZ, LASTS_S = 40.0, 2.5
Line = Callable[[float, float, float, int], str]
"""Text by time s, rate deg/s, angle deg and number of the line."""


@dataclass
class TurnedDevice:
    """A board that prints, and the command that listens to it; `turn_s` is when it turns, None before the prompt."""

    device: PtyDevice
    command: Command
    line: Line
    turned_deg: float = 90.0
    turn_s: float | None = None
    awaited: str = TURN
    reaction_s: float = 0.5

    @property
    def is_over(self) -> bool:
        """Whether the command has ended."""
        return self.command.process.poll() is not None

    def print_line(self, now_s: float, row: int) -> None:
        """One line, in motion once the prompt was seen."""
        self.command.glance()
        if self.turn_s is None and self.awaited in self.command.log:
            self.turn_s = now_s + self.reaction_s
        phase = 0.0 if self.turn_s is None else min(max((now_s - self.turn_s) / LASTS_S, 0.0), 1.0)
        rate_dps = self.turned_deg / LASTS_S * (1.0 - math.cos(2.0 * math.pi * phase))
        angle_deg = self.turned_deg * (phase - math.sin(2.0 * math.pi * phase) / (2.0 * math.pi))
        self.device.send(self.line(now_s, rate_dps, angle_deg, row).encode())


def ripple(row: int) -> float:
    """Noise that is the same in each run."""
    return ((row * 7919) % 101 - 50) / 50.0


FORMS: dict[str, tuple[Line, str]] = {
    "csv of our own form, in rad/s": (
        lambda t_s, dps, _, row: f"{int(1e6 * t_s)},{math.radians(dps + 0.4 + 0.05 * ripple(row)):.5f}\n",
        "t_us, rate:rads",
    ),
    "raw numbers with the sensor upside down": (
        lambda t_s, dps, _, k: (
            f"{20 * ripple(k):.0f} {16384 + 30 * ripple(k + 5):.0f} {-1000 * dps + 40 + 70 * ripple(k + 13):.0f}\n"
        ),
        "_, _, rate:mdps:-",
    ),
    "labelled, in deg/s": (
        lambda t_s, dps, _, row: f"ms: {int(1e3 * t_s)}\ta: 1.0{row % 7}\tb: {dps + 0.05 * ripple(row):.2f}\n",
        "ms=t_ms, b=rate:dps",
    ),
    "an angle alone, clockwise, over its jump": (
        lambda t_s, _, deg, row: f"{(20.0 - deg + 0.02 * ripple(row)) % 360.0:.2f},{0.1 * ripple(row):.2f}\n",
        "yaw:deg:-",
    ),
    "a device that does not turn": (lambda t_s, dps, _, row: f"gz={0.1 * ripple(row):.2f}\n", ""),
}


def play(boards: list[TurnedDevice], until_said: str = "\0") -> None:
    """Print lines in real time until all commands have ended, or have said something on stderr."""
    begun_s = time.monotonic()
    for row in range(100_000):
        running = [board for board in boards if not board.is_over and until_said not in board.command.log]
        if not running:
            return
        for board in running:
            board.print_line(time.monotonic() - begun_s, row)
        time.sleep(1.0 / RATE_HZ)
    pytest.fail("the commands did not end")


def listening(closing: ExitStack, port: Path, line: Line, *words: str, name: str = "doctor") -> TurnedDevice:
    """A board at a port, and the command of that name."""
    device = closing.enter_context(speaking_on(port))
    command = closing.enter_context(Command(name, "--port", port, "--turn", *words))
    return TurnedDevice(device, command, line)


@pytest.mark.promise("Text and units")
def test_a_turn_tells_the_columns(tmp_path: Path) -> None:
    """`doctor --turn` tests its columns on the received lines before it prints them.

    A turn that comes too early, before it was asked for, is taken as well.
    """
    with ExitStack() as closing:
        boards = {
            form: listening(closing, tmp_path / f"port{row}", line, "--json")
            for row, (form, (line, _)) in enumerate(FORMS.items())
        }
        still = FORMS["a device that does not turn"][0]
        calibrating = listening(closing, tmp_path / "calibrated", still, "--yes", name="calibrate")
        early = listening(closing, tmp_path / "early", FORMS["labelled, in deg/s"][0], "--json")
        early.awaited, early.reaction_s = STILL, 1.9
        play([*boards.values(), calibrating, early])
        assert early.command.end() == 0
        assert json.loads(early.command.out)["columns"] == "ms=t_ms, b=rate:dps"
        assert calibrating.command.end() == 3
        assert "no column moved" in calibrating.command.log
        for form, board in boards.items():
            status, expected = board.command.end(), FORMS[form][1]
            about = json.loads(board.command.out)
            assert (about["columns"] or "", status) == (expected, 0 if expected else 3), about
            report = [board.command.log.index(sentence) for sentence in (STILL, TURN, DONE)]
            assert report == sorted(report)
            if expected:
                assert about["turn"]["read_back_deg"] == pytest.approx(90.0, abs=9.0)
            else:
                assert "no column moved" in about["turn"]["question"]


def test_a_person_gets_a_line_to_paste_and_one_for_the_config(tmp_path: Path) -> None:
    with ExitStack() as closing:
        board = listening(closing, tmp_path / "port", FORMS["labelled, in deg/s"][0])
        play([board])
        assert board.command.end() == 0
        assert "--columns 'ms=t_ms, b=rate:dps'" in board.command.out
        assert 'columns: "ms=t_ms, b=rate:dps"' in board.command.out


def test_a_calibration_goes_on_with_the_columns_that_the_turn_told(tmp_path: Path) -> None:
    with ExitStack() as closing:
        line = FORMS["labelled, in deg/s"][0]
        board = listening(closing, tmp_path / "port", line, "--yes", name="calibrate")
        play([board], until_said="Do not touch it")
        assert "--columns 'ms=t_ms, b=rate:dps'" in board.command.log


def test_a_device_that_falls_silent_is_told(tmp_path: Path) -> None:
    with ExitStack() as closing:
        board = listening(closing, tmp_path / "port", FORMS["labelled, in deg/s"][0])
        play([board], until_said=TURN)
        assert board.command.end() == 3
        assert "stopped sending" in board.command.log


REFUSED = {
    "columns that are given": (("--turn", "--columns", "rate"), "use one of them"),
    "a file without the place": (("--turn", "{file}"), "--turn-at S"),
    "a place without a file": (("--turn-at", "3"), "is for a file"),
    "a place beyond the end": (("--turn-at", "300", "{file}"), "the file lasts"),
    "a file without a clock": (("--turn-at", "3", "{clockless}"), "it has no clock column"),
}


@pytest.fixture
def files(tmp_path: Path) -> dict[str, Path]:
    lines = []
    for row in range(900):
        t_s = 0.01 * row
        phase = min(max((t_s - 4.0) / LASTS_S, 0.0), 1.0)
        rate_dps = 88.0 / LASTS_S * (1.0 - math.cos(2.0 * math.pi * phase))
        lines.append((f"{int(1e3 * t_s)}", f"{math.radians(-rate_dps) + 0.001 * ripple(row):.4f}"))
    kept = {"file": tmp_path / "putty.log", "clockless": tmp_path / "bare.txt"}
    kept["file"].write_text("".join(f"{t_ms} {rate}\n" for t_ms, rate in lines))
    kept["clockless"].write_text("".join(f"{rate} {0.01 * ripple(row):.3f}\n" for row, (_, rate) in enumerate(lines)))
    return kept


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_done_is_refused(case: str, files: dict[str, Path], capsys: pytest.CaptureFixture[str]) -> None:
    words, expected = REFUSED[case]
    assert main(["doctor", *(word.format(**files) for word in words)]) in {2, 4}
    assert expected in capsys.readouterr().err


def test_a_turn_in_a_file_tells_the_columns(files: dict[str, Path], capsys: pytest.CaptureFixture[str]) -> None:
    """A text has its times from the clock among its columns."""
    assert main(["doctor", str(files["file"]), "--turn", "--turn-at", "3.8", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["columns"] == "t_ms, rate:rads:-"


@pytest.mark.parametrize(("sign", "status"), [(1, 0), (-1, 3)])
def test_a_recorded_rate_is_checked_by_its_turn(
    sign: int, status: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    t_s: Floats = np.arange(900.0) * 0.01
    phase = np.clip((t_s - 4.0) / LASTS_S, 0.0, 1.0)
    rate_dps = sign * 90.0 / LASTS_S * (1.0 - np.cos(2.0 * np.pi * phase)) + [0.05 * ripple(row) for row in range(900)]
    path = tmp_path / "session.mcap"
    write_session(path, [Session("session", t_s, rate_dps)])
    assert main(["doctor", str(path), "--turn-at", "3.8"]) == status
    assert ("right sign" in capsys.readouterr().out) == (status == 0)
